// A plot over time: linked with the others of its page, thinned by the server, refined as one zooms in.
import uPlot from "uplot";
import { copyText, css, h, icon, quietly, replace, saveAs } from "../dom";
import { t } from "../i18n";
import { axesOf, limitsOf, seriesOf } from "./chart";
import { fileName, rowsOf, savePng, saveSvg } from "./exports";
import { handle } from "./gestures";
import { lineChoice } from "./linechoice";
import { Linked } from "./linked";
import { usualLimits } from "./scales";
import type { Data, PlotSettings } from "./settings";

export type { Along, Data, Line, PlotSettings } from "./settings";

const visible = new IntersectionObserver(
  (entries) => {
    for (const e of entries) (e.target as unknown as { plot?: TimePlot }).plot?.seen(e.isIntersecting);
  },
  { rootMargin: "100px" },
);
const sizes = new ResizeObserver((entries) => {
  for (const e of entries) (e.target as unknown as { plot?: TimePlot }).plot?.resized();
});

const near = 16;

/** Whether the lines that the cursor is not near fade: only under the mouse, not where another plot or the time moves the cursor. */
function fading(u: uPlot, on: boolean): void {
  (u as unknown as { focus: { prox: number } }).focus.prox = on ? near : -1;
}

let number = 0;

export class TimePlot {
  readonly element: HTMLElement;
  readonly place = h("div", { class: "plot-canvas" });
  private readonly note = h("span", { class: "plot-note" });
  private readonly lines: HTMLElement = h("div", { class: "plot-lines", hidden: true });
  private chart: uPlot | null = null;
  private data: Data = { x: [], y: [] };
  private loaded: [number, number] | null = null;
  private request: AbortController | null = null;
  private inSight = false;
  private wide = 0; // px
  private stale = true;
  /** Limits that a box has chosen, of y and of the axis at the right. */
  private box: Record<string, [number, number]> = {};
  /** The last attempt to load its numbers failed. */
  failed = false;
  private readonly hidden = new Set<number>();
  private readonly refine = quietly(60, () => void this.fetch());

  constructor(
    readonly settings: PlotSettings,
    readonly linked: Linked,
  ) {
    const id = `plot-${++number}`;
    this.element = h(
      "figure",
      { class: "plot", tabIndex: 0, "aria-labelledby": id, "aria-describedby": "plot-keys" },
      h("figcaption", { id }, h("span", { class: "plot-title" }, settings.title), this.note, this.toolbar()),
      this.lines,
      this.place,
    );
    (this.element as unknown as { plot: TimePlot }).plot = this;
    visible.observe(this.element);
    sizes.observe(this.element);
    linked.onRange(Linked.perFrame(() => this.follow()));
    handle(this);
  }

  get shown(): uPlot | null {
    return this.chart;
  }

  private button(icon: string | Node, name: string, action: () => void): HTMLElement {
    return h(
      "button",
      { type: "button", class: "icon", title: name, "aria-label": `${name}: ${this.settings.title}`, onClick: action },
      icon,
    );
  }

  private toolbar(): HTMLElement {
    return h(
      "span",
      { class: "plot-tools" },
      this.button("↺", t("plot.reset"), () => this.reset()),
      this.button(icon("lines"), t("plot.lines"), () => this.toggleLines()),
      this.button(icon("copy"), t("plot.copy"), () => void rowsOf(this.settings, this.linked).then((text) => copyText(text, this.settings.title))),
      this.button("PNG", t("plot.png"), () => this.chart && savePng(this.chart, this.settings, this.hidden)),
      this.button("SVG", t("plot.svg"), () => this.chart && saveSvg(this.chart, this.settings, this.hidden, this.linked)),
      this.button(
        "CSV",
        t("plot.csv"),
        () =>
          void rowsOf(this.settings, this.linked).then((text) =>
            saveAs(new Blob([text], { type: "text/csv" }), fileName(this.settings.title, "csv")),
          ),
      ),
      this.button(
        icon("full"),
        t("plot.full"),
        () => void (document.fullscreenElement ? document.exitFullscreen() : this.element.requestFullscreen()),
      ),
    );
  }

  /** The number of the first line among the series of the chart. */
  private get first(): number {
    return this.settings.band ? 3 : 1;
  }

  private get height(): number {
    if (document.fullscreenElement === this.element) return Math.max(200, window.innerHeight - 110);
    return ((this.settings.height ?? 190) - (this.settings.bare ? 34 : 0)) * (window.innerWidth >= 2200 ? 1.7 : 1);
  }

  private get width(): number {
    return Math.max(200, this.wide || this.place.clientWidth);
  }

  /** Where the browser has just laid out the page: asked between changes, it would do so for every plot. */
  private measure(): void {
    this.wide = this.place.clientWidth;
  }

  seen(inSight: boolean): void {
    this.inSight = inSight;
    this.measure();
    if (inSight && this.stale) {
      this.stale = false;
      if (this.chart) this.follow();
      else void this.fetch();
    }
  }

  resized(): void {
    this.measure();
    this.chart?.setSize({ width: this.width, height: this.height });
  }

  /** Colours and texts may have changed. */
  redraw(): void {
    if (this.chart) this.draw();
  }

  private follow(): void {
    if (!this.inSight) {
      this.stale = true;
      return;
    }
    this.chart?.setScale("x", { min: this.linked.from, max: this.linked.to });
    this.refine();
  }

  private async fetch(): Promise<void> {
    const { from, to, start, stop } = this.linked;
    const span = to - from;
    const whole = span >= (stop - start) * 0.999;
    // wide enough and fine enough already
    if (this.loaded && this.chart) {
      const [a, b] = this.loaded;
      if (whole ? a === start && b === stop : from >= a && to <= b && b - a <= 2.6 * span) return;
    }
    const range: [number, number] = whole ? [start, stop] : [from - span * 0.75, to + span * 0.75];
    this.request?.abort();
    const request = (this.request = new AbortController());
    try {
      const points = Math.min(20000, Math.round(this.width * (whole ? 1 : 2.5)));
      const data = await this.settings.load(whole ? undefined : range[0], whole ? undefined : range[1], points, request.signal);
      if (request.signal.aborted) return;
      this.loaded = range;
      this.data = data;
      this.failed = false;
      if (this.settings.optional && whole && !data.y.some((y) => y.some((v) => v !== null))) {
        this.element.hidden = true;
        return;
      }
      this.note.textContent = data.x.length === 0 ? t("plot.empty") : data.thinned ? `⚠ ${t("plot.thinned")}` : "";
      this.show();
    } catch (e) {
      if (request.signal.aborted) return;
      this.failed = true;
      this.note.textContent = String((e as Error).message);
    }
  }

  private table(): uPlot.AlignedData {
    // the band first: lines are drawn over it
    const lines = this.settings.lines.length;
    return [this.data.x, ...this.data.y.slice(lines), ...this.data.y.slice(0, lines)] as unknown as uPlot.AlignedData;
  }

  private show(): void {
    if (!this.chart) return this.draw();
    this.chart.setData(this.table(), false);
    this.chart.setScale("x", { min: this.linked.from, max: this.linked.to });
  }

  private shade(u: uPlot): void {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.fillStyle = css("--outage");
    for (const s of this.linked.spans) {
      const a = Math.max(bbox.left, u.valToPos(s.from, "x", true));
      const b = Math.min(bbox.left + bbox.width, u.valToPos(s.to, "x", true));
      if (b > a) ctx.fillRect(a, bbox.top, b - a, bbox.height);
    }
    // what happened, as short strokes at the upper edge: a path of each colour
    const marks = this.settings.along ? [] : this.linked.marks.filter((m) => m.at >= this.linked.from && m.at <= this.linked.to);
    ctx.lineWidth = 1.5 * devicePixelRatio;
    for (const paint of new Set(marks.map((m) => m.paint))) {
      ctx.strokeStyle = css(paint);
      ctx.beginPath();
      for (const m of marks) {
        if (m.paint !== paint) continue;
        const x = u.valToPos(m.at, "x", true);
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + 9 * devicePixelRatio);
      }
      ctx.stroke();
    }
    ctx.restore();
  }

  private draw(): void {
    const s = this.settings;
    const options: uPlot.Options = {
      width: this.width,
      height: this.height,
      scales: {
        x: { time: false, auto: false, min: this.linked.from, max: this.linked.to, ...(s.along?.log ? { distr: 3 as const } : {}) },
        y: {
          ...(s.logY ? { distr: 3 as const } : {}),
          // names are read from the top
          ...(s.names ? { dir: -1 as const } : {}),
          range: (_, min, max) => this.box.y ?? limitsOf(s, min, max, (a, b) => this.usual(a, b)),
        },
        ...(s.lines.some((l) => l.right) ? { y2: { range: (_: uPlot, min: number, max: number) => this.box.y2 ?? limitsOf({ ...s, logY: false }, min, max, (a, b) => [a, b]) } } : {}),
      },
      axes: axesOf(s),
      ...seriesOf(s, this.hidden),
      padding: [8, 12, 0, 0],
      cursor: { drag: { x: true, y: true, uni: 40, setScale: false }, focus: { prox: near }, points: { size: 7 } },
      focus: { alpha: 0.45 },
      legend: { live: true },
      hooks: {
        drawClear: [(u) => this.shade(u)],
        setSelect: [(u) => this.selected(u)],
        setCursor: [
          (u) => {
            if (u.cursor.left === undefined || !this.pointing) return;
            this.linked.point(u.cursor.left < 0 ? null : u.posToVal(u.cursor.left, "x"));
          },
        ],
        setSeries: [
          (u, i) => {
            const line = (i ?? 0) - this.first;
            if (line < 0) return;
            if (u.series[i!]!.show) this.hidden.delete(line);
            else this.hidden.add(line);
          },
        ],
      },
    };
    this.chart?.destroy();
    this.place.replaceChildren();
    this.chart = new uPlot(options, this.table(), this.place);
    this.place.querySelector(".u-over")?.addEventListener("dblclick", () => this.reset());
  }

  private usual(min: number, max: number): [number, number] {
    const { limits, outside } = usualLimits(this.data, this.settings.lines.length, this.linked, min, max);
    this.note.textContent = outside > 0 ? t("plot.outside", { n: outside }) : "";
    return limits;
  }

  private pointing = false;

  /** The cursor is somewhere else on the page. */
  pointed(): void {
    const u = this.chart;
    if (!u || this.pointing || !this.inSight) return;
    const time = this.linked.cursor;
    fading(u, false);
    const left = time === null || time < this.linked.from || time > this.linked.to ? -10 : u.valToPos(time, "x");
    u.setCursor({ left, top: left < 0 ? -10 : 5 }, false);
  }

  hover(on: boolean): void {
    this.pointing = on;
    if (this.chart) fading(this.chart, on);
    if (!on) this.linked.point(null);
  }

  private selected(u: uPlot): void {
    const { left, top, width, height } = u.select;
    if (width < 4 && height < 4) return;
    const a = u.posToVal(left, "x"),
      b = u.posToVal(left + width, "x");
    const limits = (scale: string): [number, number] => [u.posToVal(top + height, scale), u.posToVal(top, scale)];
    // both axes: a box holds what lies in it, whichever axis that is drawn on
    const chosen = Object.fromEntries(["y", "y2"].filter((scale) => u.scales[scale]).map((scale) => [scale, limits(scale)]));
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    const boxed = height > 0 && height < u.over.clientHeight - 1;
    if (width > 4 && width < u.over.clientWidth) this.linked.set(a, b);
    if (boxed) this.lock(chosen);
  }

  private lock(limits: Record<string, [number, number]>): void {
    this.box = limits;
    for (const [scale, [min, max]] of Object.entries(limits)) this.chart?.setScale(scale, { min, max });
  }

  reset(): void {
    this.box = {};
    this.linked.reset();
    if (this.chart) this.draw();
  }

  private toggleLines(): void {
    this.lines.hidden = !this.lines.hidden;
    replace(
      this.lines,
      lineChoice(
        this.settings.lines,
        this.hidden,
        (i, show) => this.chart?.setSeries(i + this.first, { show }),
        () => this.draw(),
      ),
    );
  }
}

/** Their elements, those of a stack in one card. */
export function stacked(plots: TimePlot[]): HTMLElement[] {
  const out: HTMLElement[] = [];
  let card: HTMLElement | null = null;
  plots.forEach((plot, i) => {
    const name = plot.settings.stack;
    const follows = name !== undefined && plots[i - 1]?.settings.stack === name;
    const goesOn = name !== undefined && plots[i + 1]?.settings.stack === name;
    if (!follows) card = goesOn ? h("section", { class: "stack" }) : null;
    if (goesOn) plot.settings.bare = true;
    if (!card) return void out.push(plot.element);
    if (!follows) out.push(card);
    card.append(plot.element);
  });
  return out;
}

/** Links the cursors of plots: whichever the mouse is over leads. */
export function linkCursors(plots: TimePlot[], linked: Linked): void {
  for (const plot of plots) {
    plot.element.addEventListener("pointerenter", () => plot.hover(true));
    plot.element.addEventListener("pointerleave", () => plot.hover(false));
  }
  linked.onCursor(Linked.perFrame(() => plots.forEach((p) => p.pointed())));
}
