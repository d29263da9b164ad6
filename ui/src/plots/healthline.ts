// The state of every source over time, a row each: used, refused, distrusted, left out, withheld, hanging or silent.
import type { Health } from "../api";
import { css, h } from "../dom";
import { maybe, t } from "../i18n";
import { Linked } from "./linked";

interface Look {
  paint: string;
  /** Part of the height of a row: thin where there are no data, or only a part was used. */
  high: number;
}

/** By the names of the summary. */
export const looks: Record<string, Look> = {
  used: { paint: "--ink-1", high: 1 },
  "partly used": { paint: "--ink-1", high: 0.5 },
  refused: { paint: "--rejected", high: 1 },
  "partly refused": { paint: "--rejected", high: 0.5 },
  distrusted: { paint: "--excluded", high: 1 },
  "left out": { paint: "--ink-4", high: 1 },
  withheld: { paint: "--fix-none", high: 1 },
  hanging: { paint: "--ink-7", high: 1 },
  silent: { paint: "--ink-6", high: 0.25 },
};

const rowHeight = 22;

export const sourceName = (source: string) => maybe(`aid.${source}`, maybe(`source.${source}`, source.replaceAll("_", " ")));
export const stateName = (state: string) => maybe(`health.${state.replaceAll(" ", "_")}`, state);

/** What each source was doing at a time. */
export function stateAt(all: Health[], source: string, time: number): string | null {
  const mine = all.filter((x) => x.source === source);
  return (mine.find((x) => x.from_s <= time && time <= x.to_s) ?? null)?.state ?? null;
}

export class HealthLine {
  readonly element: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly said = h("p", { class: "readout health-said" });
  readonly sources: string[];
  private readonly paint = Linked.perFrame(() => this.draw());

  constructor(
    readonly all: Health[],
    private readonly linked: Linked,
  ) {
    this.sources = [...new Set(all.map((x) => x.source))];
    const states = Object.keys(looks).filter((state) => all.some((x) => x.state === state));
    const summary = this.sources.map((s) => `${sourceName(s)}: ${[...new Set(all.filter((x) => x.source === s).map((x) => stateName(x.state)))].join(", ")}`).join("; ");
    this.canvas = h("canvas", { class: "health-canvas", role: "img", "aria-label": summary });
    this.canvas.style.height = `${rowHeight * this.sources.length + 24}px`;
    this.element = h(
      "figure",
      { class: "plot health" },
      h("figcaption", null, h("span", { class: "plot-title" }, t("health.title"))),
      this.canvas,
      h(
        "p",
        { class: "legend" },
        ...states.map((state) => h("span", null, h("span", { class: "health-key", style: `background:var(${looks[state]!.paint});height:${0.75 * looks[state]!.high}rem` }), stateName(state))),
      ),
      this.said,
    );
    (this.element as unknown as { health: HealthLine }).health = this;
    new ResizeObserver(() => this.paint()).observe(this.canvas);
    this.canvas.addEventListener("pointermove", (e) => this.linked.point(this.timeAt(e.offsetX)));
    this.canvas.addEventListener("pointerleave", () => this.linked.point(null));
    linked.onRange(this.paint);
    linked.onCursor(this.paint);
  }

  redraw(): void {
    this.draw();
  }

  private get left(): number {
    return Math.min(150, 0.34 * this.canvas.clientWidth);
  }

  private timeAt(x: number): number {
    const width = this.canvas.clientWidth - this.left - 12;
    return this.linked.from + ((x - this.left) / width) * (this.linked.to - this.linked.from);
  }

  /** Where a time of a source stands in the canvas, for tests. */
  placeOf(source: string, time: number): [number, number] {
    const width = this.canvas.clientWidth - this.left - 12;
    return [this.left + ((time - this.linked.from) / (this.linked.to - this.linked.from)) * width, rowHeight * (this.sources.indexOf(source) + 0.5)];
  }

  private draw(): void {
    const width = this.canvas.clientWidth,
      height = rowHeight * this.sources.length + 24;
    if (width === 0) return;
    this.canvas.width = Math.round(width * devicePixelRatio);
    this.canvas.height = Math.round(height * devicePixelRatio);
    const g = this.canvas.getContext("2d")!;
    g.scale(devicePixelRatio, devicePixelRatio);
    g.font = "12px system-ui, sans-serif";
    g.textBaseline = "middle";
    const { left } = this;
    const right = width - 12;
    this.sources.forEach((source) => {
      const [, y] = this.placeOf(source, 0);
      g.fillStyle = css("--text");
      g.fillText(sourceName(source), 4, y, left - 10);
      g.fillStyle = css("--grid");
      g.fillRect(left, y - 0.5, right - left, 1);
      for (const x of this.all) {
        if (x.source !== source || x.to_s < this.linked.from || x.from_s > this.linked.to) continue;
        const look = looks[x.state] ?? { paint: "--muted", high: 1 };
        const a = Math.max(left, this.placeOf(source, x.from_s)[0]),
          b = Math.min(right, this.placeOf(source, x.to_s)[0]);
        const high = 13 * look.high;
        g.fillStyle = css(look.paint);
        // what lasts a moment is seen all the same
        g.fillRect(a, y - high / 2, Math.max(b - a, 1.5), high);
      }
    });
    g.fillStyle = css("--muted");
    g.textAlign = "center";
    const raw = (this.linked.to - this.linked.from) / Math.max(2, (right - left) / 90),
      power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((m) => m >= raw) ?? raw;
    for (let time = Math.ceil(this.linked.from / step) * step; time <= this.linked.to * (1 + 1e-9); time += step) {
      const [x] = this.placeOf(this.sources[0]!, time);
      g.fillText(`${Number(time.toPrecision(8))}`, Math.min(x, right - 12), height - 9);
    }
    const { cursor } = this.linked;
    this.said.textContent = "";
    if (cursor === null) return;
    const [x] = this.placeOf(this.sources[0]!, cursor);
    if (x >= left && x <= right) {
      g.fillStyle = css("--text");
      g.fillRect(x - 0.5, 0, 1, height - 20);
    }
    this.said.textContent = `${cursor.toFixed(1)} s — ${this.sources.map((s) => `${sourceName(s)}: ${stateName(stateAt(this.all, s, cursor) ?? "–")}`).join(", ")}`;
  }
}
