// The figures of a run as cards and tables.
import { api, type RunDetails, type Spread, type Summary } from "../api";
import { append, copyText, h, icon } from "../dom";
import { maybe, number, t } from "../i18n";
import { said } from "../reasons";

type Cells = (string | HTMLElement)[];

export function table(head: string[], rows: Cells[], caption: string): HTMLElement {
  const text = () =>
    [head, ...rows.map((r) => r.map((c) => (typeof c === "string" ? c : c.textContent)))].map((r) => r.join("\t")).join("\n");
  return h(
    "div",
    { class: "table-block" },
    h(
      "h3",
      null,
      caption,
      h(
        "button",
        {
          type: "button",
          class: "icon",
          title: t("table.copy"),
          "aria-label": `${t("table.copy")}: ${caption}`,
          onClick: () => void copyText(text(), caption),
        },
        icon("copy"),
      ),
    ),
    h(
      "div",
      { class: "scroll", tabIndex: 0 },
      h(
        "table",
        null,
        h("thead", null, h("tr", null, ...head.map((x, i) => h("th", { scope: "col", class: i > 0 ? "figure" : "" }, x)))),
        h(
          "tbody",
          null,
          ...rows.map((r) =>
            h("tr", null, ...r.map((c, i) => h(i === 0 ? "th" : "td", i === 0 ? { scope: "row" } : { class: "figure" }, c))),
          ),
        ),
      ),
    ),
  );
}

const units: Record<string, string> = { position_m: "m", velocity_m_s: "m/s", attitude_deg: "°" };
const isSpread = (x: unknown): x is Spread => typeof x === "object" && x !== null && "rms" in x;

export function errorRows(summary: Summary): { key: string; name: string; spread: Spread }[] {
  const out: { key: string; name: string; spread: Spread }[] = [];
  for (const [group, u] of Object.entries(units))
    for (const [axis, spread] of Object.entries(summary.errors?.[group] ?? {}))
      if (isSpread(spread) && spread.rms !== null)
        out.push({ key: `${group}.${axis}`, name: `${t(`view.${group.split("_")[0]!}`)} ${t(axis)}, ${u}`, spread });
  return out;
}

/** The figures that matter first. */
export function statCards(run: RunDetails): HTMLElement | null {
  const s = run.summary;
  if (!s) return null;
  const card = (name: string, value: string, note = "") =>
    h(
      "div",
      { class: "stat" },
      h("span", { class: "stat-name" }, name),
      h("strong", null, value),
      h("span", { class: "muted" }, note),
    );
  const cards = h("div", { class: "stats" });
  const shown = ["position_m.horizontal", "position_m.up", "attitude_deg.heading"];
  for (const { key, name, spread } of errorRows(s).sort((a, b) => shown.indexOf(a.key) - shown.indexOf(b.key)))
    if (shown.includes(key)) append(cards, card(name, number(spread.rms, 3), `rms · ${t("table.max")} ${number(spread.max, 3)}`));
  if (s.duration_s) append(cards, card(t("run.duration"), `${number(s.duration_s)} s`, [s.scheme, s.scheme === "gnss" ? null : s.mechanization].filter(Boolean).join(", ")));
  if (s.imu && s.imu.epochs > 0) append(cards, card(t("overview.imu_card"), `${number(s.imu.rate_hz)} Hz`, t("overview.imu_note", { n: s.imu.epochs, gaps: s.imu.gaps })));
  if (s.gnss) append(cards, card(t("overview.gnss_card"), String(s.gnss.epochs), t("overview.gnss_note", { accepted: s.gnss.accepted, rejected: s.gnss.rejected })));
  if (s.carrier) append(cards, card(t("carrier.card"), t("carrier.fixed", { n: s.carrier.fixed }), t("carrier.note", { float: s.carrier.float, single: s.carrier.single })));
  const inside = s.outages?.filter((o) => o.inside_3sigma !== null) ?? [];
  if (inside.length > 0)
    append(
      cards,
      card(t("table.outages"), `${inside.filter((o) => o.inside_3sigma).length} / ${inside.length}`, t("table.inside")),
    );
  return cards;
}

export function overview(run: RunDetails): HTMLElement {
  const s = run.summary;
  const box = h("div", { class: "overview" });
  if (!s) return append(box, h("p", { class: "muted" }, t("plot.empty"))), box;
  if (typeof s.settled_after_s === "number") append(box, h("p", { class: "muted" }, t("table.settled", { s: number(s.settled_after_s) })));
  if ((s.warnings?.length ?? 0) > 0)
    append(
      box,
      h("h3", null, t("table.warnings")),
      h("ul", { class: "problems" }, ...s.warnings.map((w) => h("li", { class: "warning" }, `⚠ ${said(w)}`))),
    );
  const rows = errorRows(s);
  if (rows.length > 0)
    append(
      box,
      table(
        [t("table.quantity"), t("table.rms"), t("table.p95"), t("table.max")],
        rows.map(({ name, spread }) => [name, number(spread.rms), number(spread.p95), number(spread.max)]),
        t("table.errors"),
      ),
    );
  if (s.outages && s.outages.length > 0)
    append(
      box,
      table(
        ["at", "length", "end", "max_h", "end_v", "max_3d", "inside"].map((x) => t(`table.${x}`)),
        s.outages.map((o) => [
          number(o.start_s, 6),
          number(o.duration_s),
          number(o.end_horizontal_m),
          number(o.max_horizontal_m),
          number(o.end_vertical_m),
          number(o.max_3d_m),
          o.inside_3sigma === null ? "–" : t(o.inside_3sigma ? "yes" : "no"),
        ]),
        t("table.outages"),
      ),
    );
  const broad = ["broad_deg", "broad_raw_deg"].flatMap((set) =>
    ["total", "heading", "inclination"].flatMap((part) => {
      const v = (s.errors?.[set] as Record<string, { rms?: number } | number> | null | undefined)?.[part];
      return typeof v === "object" && typeof v?.rms === "number" ? [[`${t(`attitude.${set}`)}: ${maybe(part, t(`attitude.${part}`))}`, number(v.rms)]] : [];
    }),
  );
  if (broad.length > 0) append(box, table([t("table.quantity"), `${t("table.rms")}, °`], broad, t("attitude.errors")));
  const c = s.consistency ?? {};
  const consistency: Cells[] = [];
  for (const [name, value] of Object.entries(c)) {
    const v = value as Record<string, number | null> | null;
    if (v && "mean" in v && v["mean"] !== null)
      consistency.push([
        name.replaceAll("_", " "),
        number(v["mean"]),
        number(v["expected"] ?? null),
        number(v["low95"] ?? null),
        number(v["high95"] ?? null),
      ]);
  }
  for (const [name, value] of Object.entries((c["nis"] ?? {}) as Record<string, Record<string, number | null> | null>))
    if (value && value["mean"] !== null && value["mean"] !== undefined)
      consistency.push([`NIS ${t(`aid.${name}`)}`, number(value["mean"]), number(value["dof"] ?? null), "–", "–"]);
  if (consistency.length > 0)
    append(
      box,
      table(
        [t("table.quantity"), t("table.mean"), t("table.expected"), t("table.low"), t("table.high")],
        consistency,
        t("table.consistency"),
      ),
    );
  append(
    box,
    h("h3", null, t("run.files")),
    h("ul", { class: "files" }, ...run.files.map((f) => h("li", null, h("a", { href: api.fileUrl(run.id, f, true) }, f)))),
  );
  return box;
}
