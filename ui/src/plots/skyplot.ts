// Satellites and stations by azimuth and elevation: where they went, where they are at the cursor, what became of their ranges.
import { append, replace, svg } from "../dom";
import { t } from "../i18n";
import type { Linked } from "./linked";

export interface Seen {
  time: number;
  azimuth: number;
  elevation: number;
  /** 0 used, 1 rejected, 2 not asked. */
  status: number;
  residual: number | null;
  sigma: number | null;
}

export interface Source {
  name: string;
  station: boolean;
  seen: Seen[];
}

const radius = 200;

/** Zenith in the middle, north up, east at the right; what is below the horizon stands on the rim. */
function place(azimuth: number, elevation: number): [number, number] {
  const r = radius * (1 - Math.min(90, Math.max(0, elevation)) / 90),
    a = (azimuth * Math.PI) / 180;
  return [r * Math.sin(a), -r * Math.cos(a)];
}

function nearest(seen: Seen[], time: number, reach: number): Seen | null {
  let best: Seen | null = null;
  for (const s of seen) if (Math.abs(s.time - time) <= reach && (!best || Math.abs(s.time - time) < Math.abs(best.time - time))) best = s;
  return best;
}

export class SkyPlot {
  readonly element = svg("svg", { viewBox: "-240 -232 480 464", class: "sky", role: "img", "aria-label": t("sky.title") });
  private readonly now = svg("g", {});
  private readonly paths = svg("g", {});
  private sources: Source[] = [];
  private last = 0;

  constructor(
    sources: Source[],
    private readonly linked: Linked,
    private readonly spacing: number,
  ) {
    const grid = (node: SVGElement) => (node.setAttribute("class", "sky-grid"), node);
    for (const elevation of [0, 30, 60]) {
      const r = radius * (1 - elevation / 90);
      append(this.element, grid(svg("circle", { r, cx: 0, cy: 0 })));
      append(this.element, svg("text", { x: 3, y: -r - 3 + (elevation === 0 ? 14 : 0), class: "sky-mark" }, `${elevation}°`));
    }
    for (let a = 0; a < 180; a += 30) {
      const [x, y] = place(a, 0);
      append(this.element, grid(svg("line", { x1: -x, y1: -y, x2: x, y2: y })));
    }
    for (const [name, a] of [["north", 0], ["east", 90], ["south", 180], ["west", 270]] as const) {
      const [x, y] = place(a, 0);
      append(
        this.element,
        svg("text", { x: x * 1.1, y: y * 1.1 + 5, class: "sky-compass", "text-anchor": "middle" }, t(`sky.${name}`)),
      );
    }
    append(this.element, this.paths, this.now);
    linked.onCursor(() => this.mark());
    this.show(sources);
  }

  show(sources: Source[]): void {
    this.sources = sources;
    this.last = Math.max(0, ...sources.map((s) => s.seen.at(-1)?.time ?? 0));
    replace(this.paths, ...sources.filter(({ seen }) => seen.length > 1).map((source) => this.path(source)));
    this.mark();
  }

  private path({ seen }: Source): SVGElement {
    let text = "";
    seen.forEach((s, i) => {
      const [x, y] = place(s.azimuth, s.elevation);
      const joined = i > 0 && s.time - seen[i - 1]!.time < 2.5 * this.spacing;
      text += `${joined ? "L" : "M"}${x.toFixed(1)},${y.toFixed(1)}`;
    });
    return svg("path", { d: text, class: "sky-path" });
  }

  /** Where each of them is at the cursor, or was last. */
  private mark(): void {
    const { cursor } = this.linked;
    replace(this.now);
    for (const { name, station, seen } of this.sources) {
      const at = cursor === null ? seen.at(-1) : nearest(seen, cursor, this.spacing);
      if (!at) continue;
      const [x, y] = place(at.azimuth, at.elevation);
      const lost = cursor === null && at.time < this.last - 1.5 * this.spacing;
      const look = { class: `sky-now ${lost ? "lost" : `status-${at.status}`}` };
      append(
        this.now,
        at.status === 1 && !lost
          ? svg("path", { ...look, d: `M${x - 6},${y - 6}l12,12m0,-12l-12,12` })
          : station
            ? svg("rect", { ...look, x: x - 6, y: y - 6, width: 12, height: 12 })
            : svg("circle", { ...look, cx: x, cy: y, r: 6 }),
        svg("text", { x: x > 150 ? x - 10 : x + 10, y: y + 4, "text-anchor": x > 150 ? "end" : "start", class: "sky-name" }, name),
      );
    }
  }
}
