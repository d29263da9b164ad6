#include "schuler/report/detail/page_assets.h"

namespace schuler::report::detail {

std::string_view page_style() {
    return R"css(
:root{color-scheme:light dark;--bg:#f6f7f8;--card:#fff;--text:#1b1f24;--muted:#5a6470;--line:#d9dee3;--grid:#e6eaee;
--zero:#9aa4af;
--accent:#005a8d;--blue:#0072b2;--vermillion:#d55e00;--green:#009e73;--purple:#cc79a7;--orange:#e69f00;--sky:#56b4e9;
--band:.26;--warn:#fff4e0;--hatch:#b8860b}
@media (prefers-color-scheme:dark){:root{--bg:#101418;--card:#181d23;--text:#e4e8ec;--muted:#9aa6b2;--line:#2e363f;--grid:#262d35;
--zero:#66717d;--accent:#7cc7f2;--blue:#4aa8e8;--vermillion:#f5864a;--green:#2fc99b;--purple:#e29bc4;--orange:#f2b632;
--sky:#7cc7f2;
--band:.22;--warn:#33290f;--hatch:#d8b04a}}
*{box-sizing:border-box}
html{scroll-padding-top:56px;-webkit-text-size-adjust:100%}
body{margin:0;background:var(--bg);color:var(--text);font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",
"DejaVu Sans",Arial,sans-serif;font-variant-numeric:tabular-nums}
.page{max-width:1360px;margin:0 auto;padding:0 32px 48px}
header{padding:28px 0 4px}
h1{font-size:27px;line-height:1.2;margin:0;letter-spacing:-.01em;overflow-wrap:anywhere}
.subtitle{color:var(--muted);margin:4px 0 0}
h2{font-size:20px;margin:44px 0 4px;padding-top:14px;border-top:2px solid var(--line)}
h3{font-size:16px;margin:24px 0 8px}
h4{font-size:14px;font-weight:600;margin:0}
p{max-width:90ch;margin:4px 0 12px}
a{color:var(--accent)}
nav{position:sticky;top:0;z-index:5;background:var(--bg);border-bottom:1px solid var(--line);margin:18px -8px 0}
nav ul{display:flex;flex-wrap:wrap;gap:2px;list-style:none;margin:0;padding:7px 0}
nav a{display:block;padding:4px 9px;border-radius:6px;text-decoration:none;font-size:14px}
nav a:hover,nav a:focus-visible{background:var(--card);text-decoration:underline}
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(152px,1fr));gap:10px;margin:20px 0 0;padding:0}
.cards div{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:9px 13px 10px}
.cards dt{color:var(--muted);font-size:13px}
.cards dd{margin:0;font-size:19px;font-weight:600;line-height:1.35;overflow-wrap:anywhere}
.cards dd.note{font-size:12.5px;font-weight:400;color:var(--muted)}
.hint{color:var(--muted);font-size:13px;margin:10px 0 0;max-width:none}
kbd{border:1px solid var(--line);border-bottom-width:2px;border-radius:4px;padding:0 4px;font:12px ui-monospace,monospace}
.panels{display:grid;grid-template-columns:minmax(0,1fr);gap:12px}
figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:8px;padding:9px 12px 6px;min-width:0}
figcaption{display:flex;flex-wrap:wrap;align-items:baseline;justify-content:space-between;gap:2px 18px;padding:0 4px 3px}
.legend{display:flex;flex-wrap:wrap;gap:0 4px}
.legend button{display:inline-flex;align-items:center;gap:6px;font:inherit;font-size:13px;color:var(--text);background:none;
border:0;
border-radius:5px;padding:1px 7px;cursor:default}
.js .legend button{cursor:pointer}
.js .legend button:hover{background:var(--bg)}
.legend button[aria-pressed=false]{opacity:.4;text-decoration:line-through}
.sw{width:22px;height:12px;flex:none}
.plot{overflow-x:auto}
.plot svg{display:block;width:100%;min-width:700px;height:auto;outline-offset:2px}
.js .plot svg[data-box]{cursor:crosshair;touch-action:pan-x pan-y;-webkit-user-select:none;user-select:none}
svg text{font-size:11.5px;fill:var(--muted)}
svg .tx{text-anchor:middle}
svg .ty{text-anchor:end}
svg .lab{fill:var(--text);font-size:12px}
svg .out{font-size:11px;fill:var(--text)}
.box{fill:none;stroke:var(--line)}
.grid{stroke:var(--grid);fill:none}
.zero{stroke:var(--zero)}
.ln,.dot,.sq,.hole{fill:none;vector-effect:non-scaling-stroke;stroke-linejoin:round;stroke-linecap:round}
.dash{stroke-dasharray:7 4;stroke-linecap:butt}
.dot{stroke-width:3.4px}
.sq{stroke-width:8px;stroke-linecap:square}
.hole{stroke-width:4px;stroke-linecap:square;stroke:var(--card)}
.bd{fill-opacity:var(--band);stroke-opacity:.65;stroke-width:.8px;vector-effect:non-scaling-stroke;stroke-linejoin:round}
.i-blue{stroke:var(--blue)}.i-vermillion{stroke:var(--vermillion)}.i-green{stroke:var(--green)}.i-purple{stroke:var(--purple)}
.i-orange{stroke:var(--orange)}.i-sky{stroke:var(--sky)}.i-text{stroke:var(--text)}.i-muted{stroke:var(--zero)}
.f-blue{fill:var(--blue);stroke:var(--blue)}.f-vermillion{fill:var(--vermillion);stroke:var(--vermillion)}
.f-green{fill:var(--green);stroke:var(--green)}.f-purple{fill:var(--purple);stroke:var(--purple)}
.f-orange{fill:var(--orange);stroke:var(--orange)}.f-sky{fill:var(--sky);stroke:var(--sky)}
.f-text{fill:var(--text);stroke:var(--text)}.f-muted{fill:var(--zero);stroke:var(--zero)}
.hatch{fill:url(#hatch);stroke:var(--hatch);stroke-opacity:.55;stroke-width:.8px}
#hatch path{stroke:var(--hatch);stroke-opacity:.5;stroke-width:1.4px}
.shade{fill:var(--zero);fill-opacity:.16}
.scale rect{fill:var(--card);fill-opacity:.85}
.scale path{fill:none;stroke:var(--text);stroke-width:1.5px}
.scale text{fill:var(--text)}
.cursor{stroke:var(--text);stroke-opacity:.6;fill:none;pointer-events:none}
circle.cursor{stroke-width:2px;stroke-opacity:1;fill:var(--card)}
.zoom{fill:var(--accent);fill-opacity:.12;stroke:var(--accent);pointer-events:none}
.hidden{display:none}
.tip{position:fixed;z-index:9;pointer-events:none;background:var(--card);color:var(--text);border:1px solid var(--line);
border-radius:6px;
box-shadow:0 3px 14px rgba(0,0,0,.22);padding:5px 9px;font-size:12.5px;line-height:1.45;white-space:nowrap}
.tip div{display:flex;gap:7px;align-items:center}
.tip b{margin-left:auto;padding-left:12px;font-weight:600}
.tables{display:flex;flex-wrap:wrap;gap:14px 20px;margin:14px 0 0;align-items:flex-start}
.table{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:8px;padding:8px 14px 10px;max-width:100%}
table{border-collapse:collapse;font-size:14px}
caption{text-align:left;font-weight:600;padding:0 0 5px;white-space:nowrap}
th,td{text-align:left;padding:3px 18px 3px 0;border-top:1px solid var(--grid);font-weight:400;vertical-align:top}
thead th{color:var(--muted);font-size:13px;border-top:0;border-bottom:1px solid var(--line)}
th.n,td.n{text-align:right;white-space:nowrap}
th:last-child,td:last-child{padding-right:0}
.warnings{background:var(--warn);border:1px solid var(--orange);border-left-width:5px;border-radius:8px;
padding:8px 14px 8px 30px;margin:8px 0}
.warnings li{margin:2px 0;overflow-wrap:anywhere}
pre{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:12px 16px;font:13px/1.45 ui-monospace,
"DejaVu Sans Mono",
Menlo,Consolas,monospace;overflow:auto;max-height:560px;tab-size:4}
footer{color:var(--muted);font-size:13px;margin-top:40px;border-top:1px solid var(--line);padding-top:10px}
@media (max-width:700px){.page{padding:0 14px 32px}nav{position:static}html{scroll-padding-top:8px}}
@media (min-width:1640px){
.page{max-width:1640px;display:grid;grid-template-columns:210px minmax(0,1fr);column-gap:34px}
header,main,footer{grid-column:2}
nav{grid-column:1;grid-row:1/span 3;align-self:start;border:0;margin:26px 0 0;top:16px}
nav ul{display:block}
html{scroll-padding-top:12px}}
@media (min-width:2500px){.page{max-width:2500px}.panels{grid-template-columns:repeat(2,minmax(0,1fr))}.map{grid-column:1/-1}}
@media print{
:root{color-scheme:light;--bg:#fff;--card:#fff;--text:#000;--muted:#444;--line:#bbb;--grid:#e2e2e2;--zero:#888;
--accent:#005a8d;--blue:#0072b2;
--vermillion:#d55e00;--green:#009e73;--purple:#cc79a7;--orange:#e69f00;--sky:#56b4e9;--band:.26;--warn:#fff;--hatch:#b8860b}
@page{margin:14mm}
*{-webkit-print-color-adjust:exact;print-color-adjust:exact}
body{font-size:11pt}
.page{display:block;max-width:none;padding:0}
nav,.hint,.tip{display:none}
.plot,.table{overflow:visible}
.plot svg{min-width:0}
svg text,svg .lab,svg .out{font-size:15px}
figure,.table,.cards div{break-inside:avoid}
.panels{display:block}
figure{margin:0 0 8px;padding:6px 4px 2px}
h2,h3{break-after:avoid}
pre{max-height:none;white-space:pre-wrap;font-size:9pt}}
)css";
}

}  // namespace schuler::report::detail
