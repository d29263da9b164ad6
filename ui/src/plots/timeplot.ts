// A plot over time: linked with the others of its page, thinned by the server, refined as one zooms in.
import uPlot from "uplot";
import { copyText, css, h, icon, quietly, saveAs } from "../dom";
import { t } from "../i18n";
import { chooseColour, colour, faded, hex } from "./colours";
import { Linked } from "./linked";
import { powers, usualLimits } from "./scales";
import { pictureOf, svgOf } from "./svg";

export interface Line {
  label: string;
  ink?: number;
  dash?: number[];
  width?: number;
  /** Only points, no line: measurements. */
  dots?: boolean;
}

export interface Data {
  x: number[];
  /** One for each line, in order; then, for a band, its half width. */
  y: (number | null)[][];
}

export interface PlotSettings {
  title: string;
  unit: string;
  lines: Line[];
  /** Name of the band; the loader then gives lower and upper edge after the lines. */
  band?: string;
  height?: number;
  logY?: boolean;
  /** The range of y is that of nearly all values, not of the few largest ones; the plot says how many lie outside. */
  robust?: boolean;
  /** Always inside the range of y. */
  include?: number[];
  load: (from: number | undefined, to: number | undefined, points: number, signal: AbortSignal) => Promise<Data>;
}

const visible = new IntersectionObserver(
  (entries) => {
    for (const e of entries) (e.target as unknown as { plot?: TimePlot }).plot?.seen(e.isIntersecting);
  },
  { rootMargin: "100px" },
);
const sizes = new ResizeObserver((entries) => {
  for (const e of entries) (e.target as unknown as { plot?: TimePlot }).plot?.resized();
});

let number = 0;

export class TimePlot {
  readonly element: HTMLElement;
  private readonly place = h("div", { class: "plot-canvas" });
  private readonly note = h("span", { class: "plot-note" });
  private readonly lines: HTMLElement = h("div", { class: "plot-lines", hidden: true });
  private chart: uPlot | null = null;
  private data: Data = { x: [], y: [] };
  private loaded: [number, number] | null = null;
  private request: AbortController | null = null;
  private inSight = false;
  private stale = true;
  private dragging: { x: number; from: number; to: number } | null = null;
  private readonly hidden = new Set<number>();
  private readonly refine = quietly(60, () => void this.fetch());

  constructor(
    private readonly settings: PlotSettings,
    private readonly linked: Linked,
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
    this.element.addEventListener("keydown", (e) => this.key(e));
    this.place.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    this.place.addEventListener("pointerdown", (e) => this.grab(e), { capture: true });
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
      this.button(icon("copy"), t("plot.copy"), () => void this.rows().then((text) => copyText(text, this.settings.title))),
      this.button("PNG", t("plot.png"), () => this.png()),
      this.button("SVG", t("plot.svg"), () => this.svg()),
      this.button(
        "CSV",
        t("plot.csv"),
        () => void this.rows().then((text) => saveAs(new Blob([text], { type: "text/csv" }), this.name("csv"))),
      ),
      this.button(
        icon("full"),
        t("plot.full"),
        () => void (document.fullscreenElement ? document.exitFullscreen() : this.element.requestFullscreen()),
      ),
    );
  }

  private name(ending: string): string {
    return `${this.settings.title.replace(/[^\p{L}\p{N}]+/gu, "_")}.${ending}`;
  }

  /** The number of the first line among the series of the chart. */
  private get first(): number {
    return this.settings.band ? 3 : 1;
  }

  private get height(): number {
    if (document.fullscreenElement === this.element) return Math.max(200, window.innerHeight - 110);
    return (this.settings.height ?? 190) * (window.innerWidth >= 2200 ? 1.7 : 1);
  }

  private get width(): number {
    return Math.max(200, this.place.clientWidth);
  }

  seen(inSight: boolean): void {
    this.inSight = inSight;
    if (inSight && this.stale) {
      this.stale = false;
      if (this.chart) this.follow();
      else void this.fetch();
    }
  }

  resized(): void {
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
      this.note.textContent = data.x.length === 0 ? t("plot.empty") : "";
      this.show();
    } catch (e) {
      if (!request.signal.aborted) this.note.textContent = String((e as Error).message);
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
    ctx.restore();
  }

  private draw(): void {
    const text = css("--text"),
      grid = css("--grid");
    const s = this.settings;
    const series: uPlot.Series[] = [{ label: t("plot.time"), value: (_, v) => (v === null ? "–" : v.toFixed(2) + " s") }];
    const short = (v: number | null) => (v === null || v === undefined ? "–" : Number(v.toPrecision(5)).toString());
    const bands: uPlot.Band[] = [];
    if (s.band) {
      const first = series.length;
      const stroke = faded(css("--band"), 0.9);
      series.push({ label: s.band, stroke, width: 1, points: { show: false }, value: (_, v) => short(v) });
      series.push({ label: "−" + s.band, stroke, width: 1, points: { show: false }, class: "quiet" });
      bands.push({ series: [first, first + 1], fill: faded(css("--band"), 0.28) });
    }
    s.lines.forEach((line, i) => {
      const stroke = colour(line.label, line.ink ?? i);
      series.push({
        label: line.label,
        stroke,
        width: line.width ?? 1.4,
        ...(line.dash ? { dash: line.dash } : {}),
        ...(line.dots
          ? { paths: () => null, points: { show: true, size: 5, fill: stroke, width: 0 } }
          : { points: { show: false } }),
        show: !this.hidden.has(i),
        value: (_, v) => short(v),
      });
    });
    const axis = {
      stroke: text,
      grid: { stroke: grid, width: 1 },
      ticks: { stroke: grid, width: 1 },
      font: "12px system-ui, sans-serif",
      labelFont: "12px system-ui, sans-serif",
    };
    const options: uPlot.Options = {
      width: this.width,
      height: this.height,
      scales: {
        x: { time: false, auto: false, min: this.linked.from, max: this.linked.to },
        y: {
          ...(s.logY ? { distr: 3 as const } : {}),
          range: (_, min, max) => {
            if (s.logY) return [Math.max(min ?? 1e-3, 1e-6), Math.max(max ?? 1, 1e-5)];
            for (const v of s.include ?? []) (min = Math.min(min ?? v, v)), (max = Math.max(max ?? v, v));
            if (s.robust && min !== null && max !== null) [min, max] = this.usual(min, max);
            if (min === null || max === null || !Number.isFinite(min) || !Number.isFinite(max)) return [-1, 1];
            const room = (max - min || Math.abs(max) || 1) * 0.06;
            return [min - room, max + room];
          },
        },
      },
      axes: [
        { ...axis, size: 34, label: `${t("plot.time")}, s`, labelSize: 16, gap: 3 },
        { ...axis, size: 64, label: s.unit, labelSize: 18, ...(s.logY ? powers : {}) },
      ],
      series,
      bands,
      padding: [8, 12, 0, 0],
      cursor: { drag: { x: true, y: true, uni: 40, setScale: false }, focus: { prox: 16 }, points: { size: 7 } },
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
    const left = time === null || time < this.linked.from || time > this.linked.to ? -10 : u.valToPos(time, "x");
    u.setCursor({ left, top: left < 0 ? -10 : 5 }, false);
  }

  hover(on: boolean): void {
    this.pointing = on;
    if (!on) this.linked.point(null);
  }

  private selected(u: uPlot): void {
    const { left, top, width, height } = u.select;
    if (width < 4 && height < 4) return;
    const a = u.posToVal(left, "x"),
      b = u.posToVal(left + width, "x");
    const high = u.posToVal(top, "y"),
      low = u.posToVal(top + height, "y");
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    const boxed = height > 0 && height < u.over.clientHeight - 1;
    if (width > 4 && width < u.over.clientWidth) this.linked.set(a, b);
    if (boxed) this.lockY(low, high);
  }

  private lockY(low: number, high: number): void {
    this.settings.include = undefined as never;
    this.chart?.setScale("y", { min: low, max: high });
  }

  private reset(): void {
    this.linked.reset();
    if (this.chart) {
      this.chart.setScale("y", { min: null as never, max: null as never });
      this.draw();
    }
  }

  private key(e: KeyboardEvent): void {
    if (e.target !== this.element || e.ctrlKey || e.metaKey || e.altKey) return;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.linked.pan(-0.15),
      ArrowRight: () => this.linked.pan(0.15),
      "+": () => this.linked.zoom(0.6),
      "=": () => this.linked.zoom(0.6),
      "-": () => this.linked.zoom(1 / 0.6),
      "0": () => this.reset(),
      Home: () => this.linked.set(this.linked.start, this.linked.start + this.linked.to - this.linked.from),
      End: () => this.linked.set(this.linked.stop - (this.linked.to - this.linked.from), this.linked.stop),
    };
    const action = actions[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  }

  private wheel(e: WheelEvent): void {
    if (!this.chart || !(e.ctrlKey || document.activeElement === this.element || document.fullscreenElement === this.element))
      return;
    e.preventDefault();
    const box = this.chart.over.getBoundingClientRect();
    const about = this.chart.posToVal(e.clientX - box.left, "x");
    if (Math.abs(e.deltaX) > Math.abs(e.deltaY)) this.linked.pan(Math.sign(e.deltaX) * 0.08);
    else this.linked.zoom(e.deltaY > 0 ? 1.2 : 1 / 1.2, about);
  }

  /** Shift, or the middle button: moves instead of choosing a range. */
  private grab(e: PointerEvent): void {
    this.element.focus({ preventScroll: true });
    if (!this.chart || !(e.shiftKey || e.button === 1)) return;
    e.preventDefault();
    e.stopPropagation();
    this.dragging = { x: e.clientX, from: this.linked.from, to: this.linked.to };
    const move = (m: PointerEvent) => {
      if (!this.dragging || !this.chart) return;
      const { x, from, to } = this.dragging;
      const by = ((x - m.clientX) / Math.max(1, this.chart.over.clientWidth)) * (to - from);
      const left = Math.min(Math.max(from + by, this.linked.start), this.linked.stop - (to - from));
      this.linked.set(left, left + to - from);
    };
    const end = () => {
      this.dragging = null;
      window.removeEventListener("pointermove", move);
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", end, { once: true });
    // uPlot listens for the mouse, not the pointer
    this.place.addEventListener("mousedown", (m) => m.stopPropagation(), { capture: true, once: true });
  }

  private toggleLines(): void {
    this.lines.hidden = !this.lines.hidden;
    this.lines.replaceChildren();
    this.settings.lines.forEach((line, i) => {
      this.lines.append(
        h(
          "label",
          null,
          h("input", {
            type: "checkbox",
            checked: !this.hidden.has(i),
            onChange: (e: Event) => this.chart?.setSeries(i + this.first, { show: (e.target as HTMLInputElement).checked }),
          }),
          h("input", {
            type: "color",
            value: hex(colour(line.label, line.ink ?? i)),
            "aria-label": `${t("plot.colour")}: ${line.label}`,
            onInput: (e: Event) => {
              chooseColour(line.label, (e.target as HTMLInputElement).value);
              this.draw();
            },
          }),
          line.label,
        ),
      );
    });
    this.lines.append(
      h(
        "button",
        { type: "button", onClick: () => (this.settings.lines.forEach((l) => chooseColour(l.label, null)), this.draw()) },
        t("plot.colours_back"),
      ),
    );
  }

  /** Everything in the range as comma separated text; every row where they are not too many. */
  private async rows(): Promise<string> {
    const data = await this.settings.load(this.linked.from, this.linked.to, 0, new AbortController().signal);
    const names = ["time_s", ...this.settings.lines.map((l) => `${l.label} (${this.settings.unit})`)];
    if (this.settings.band) names.push(`${this.settings.band}`, `-${this.settings.band}`);
    const quoted = names.map((n) => (/[",]/.test(n) ? `"${n.replaceAll('"', '""')}"` : n));
    const out = [quoted.join(",")];
    data.x.forEach((x, i) => out.push([x, ...data.y.map((y) => y[i] ?? "")].join(",")));
    return out.join("\n") + "\n";
  }

  private png(): void {
    if (!this.chart) return;
    const lines = this.settings.lines.map((l, i) => ({ label: l.label, colour: colour(l.label, l.ink ?? i) }));
    pictureOf(this.chart, `${this.settings.title}, ${this.settings.unit}`, lines).toBlob(
      (blob) => blob && saveAs(blob, this.name("png")),
    );
  }

  private svg(): void {
    if (!this.chart) return;
    const shown = this.settings.lines.map((l, i) => ({
      label: l.label,
      colour: colour(l.label, l.ink ?? i),
      dots: l.dots ?? false,
      dash: l.dash,
      hidden: this.hidden.has(i),
    }));
    const text = svgOf(
      this.chart,
      this.settings.title,
      this.settings.unit,
      shown,
      this.settings.band ? css("--band") : null,
      this.linked.spans,
    );
    saveAs(new Blob([text], { type: "image/svg+xml" }), this.name("svg"));
  }
}

/** Links the cursors of plots: whichever the mouse is over leads. */
export function linkCursors(plots: TimePlot[], linked: Linked): void {
  for (const plot of plots) {
    plot.element.addEventListener("pointerenter", () => plot.hover(true));
    plot.element.addEventListener("pointerleave", () => plot.hover(false));
  }
  linked.onCursor(Linked.perFrame(() => plots.forEach((p) => p.pointed())));
}
