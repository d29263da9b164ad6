// Tracks on a map-like plane: metres east and north, one scale for both, with a scale bar and a cursor linked to time.
import { copyText, css, h, icon, saveAs } from "../dom";
import { t } from "../i18n";
import { colour } from "./colours";
import { Linked, firstFrom, type Mark } from "./linked";
import { graticule, type Line, type Plane } from "./graticule";
import { TileLayer, tileZooms } from "./tiles";

export interface Track2d {
  label: string;
  ink: number;
  time: number[];
  east: (number | null)[];
  north: (number | null)[];
  dots?: boolean;
  /** Variables of the style sheet, one a point: what has a fixed meaning, as the quality of fixes. */
  paints?: string[];
}

export class PlanView {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { class: "plan-canvas", role: "img", "aria-label": t("plan.title") });
  private readonly legend = h("span", { class: "legend" });
  private tracks: Track2d[] = [];
  private readonly hidden = new Set<string>();
  private centre = { east: 0, north: 0 };
  private scale = 1;
  private fitted = false;
  private size: [number, number] = [0, 0]; // of the canvas, px
  private plane: Plane | null = null;
  /** The lines that were drawn last. */
  lines: { meridians: Line[]; parallels: Line[] } = { meridians: [], parallels: [] };
  /** A map under the tracks, where there are tiles of one. */
  tiles: TileLayer | null = null;
  private readonly paint = Linked.perFrame(() => this.draw());

  constructor(
    private readonly linked: Linked | null,
    private readonly tall = 420,
  ) {
    const button = (sign: string | Node, name: string, action: () => void) =>
      h("button", { type: "button", class: "icon", title: name, "aria-label": name, onClick: action }, sign);
    this.element = h(
      "figure",
      { class: "plot plan", tabIndex: 0 },
      h(
        "figcaption",
        null,
        h("span", { class: "plot-title" }, t("plan.title")),
        this.legend,
        h(
          "span",
          { class: "plot-tools" },
          button("+", t("plot.closer"), () => this.zoom(1.5)),
          button("−", t("plot.farther"), () => this.zoom(1 / 1.5)),
          button("↺", t("plot.reset"), () => this.fit()),
          button(icon("copy"), t("plot.copy"), () => void copyText(this.rows(), t("plan.title"))),
          button("PNG", t("plot.png"), () => this.canvas.toBlob((b) => b && saveAs(b, "track.png"))),
          button("SVG", t("plot.svg"), () => saveAs(new Blob([this.svg()], { type: "image/svg+xml" }), "track.svg")),
          button("CSV", t("plot.csv"), () => saveAs(new Blob([this.rows()], { type: "text/csv" }), "track.csv")),
          button(
            icon("full"),
            t("plot.full"),
            () => void (document.fullscreenElement ? document.exitFullscreen() : this.element.requestFullscreen()),
          ),
        ),
      ),
      this.canvas,
    );
    (this.element as unknown as { plan: PlanView }).plan = this;
    new ResizeObserver(() => this.paint()).observe(this.canvas);
    this.canvas.addEventListener("pointerdown", (e) => this.drag(e));
    this.canvas.addEventListener("pointermove", (e) => this.hover(e));
    this.canvas.addEventListener("pointerleave", () => this.linked?.point(null));
    this.canvas.addEventListener("dblclick", () => this.fit());
    this.canvas.addEventListener(
      "wheel",
      (e) => {
        if (!e.ctrlKey && document.activeElement !== this.element) return;
        e.preventDefault();
        this.zoom(e.deltaY > 0 ? 1 / 1.2 : 1.2, e);
      },
      { passive: false },
    );
    this.element.addEventListener("keydown", (e) => this.key(e));
    linked?.onCursor(this.paint);
    linked?.onRange(this.paint);
  }

  show(tracks: Track2d[], refit = true): void {
    this.tracks = tracks;
    this.legend.replaceChildren(
      ...tracks.map((track) =>
        h(
          "label",
          null,
          h("input", {
            type: "checkbox",
            checked: !this.hidden.has(track.label),
            onChange: (e: Event) => {
              if ((e.target as HTMLInputElement).checked) this.hidden.delete(track.label);
              else this.hidden.add(track.label);
              this.paint();
            },
          }),
          h("span", { class: "swatch", style: `background:${colour(track.label, track.ink)}` }),
          track.label,
        ),
      ),
    );
    if (refit || !this.fitted) this.fitted = false;
    this.paint();
  }

  /** Where on the Earth the plane lies: from then on lines of latitude and longitude are drawn, and a map if there is one. */
  async lie(plane: Plane): Promise<void> {
    if (!Number.isFinite(plane.lat) || !Number.isFinite(plane.lon)) return;
    if (plane.lat === this.plane?.lat && plane.lon === this.plane.lon) return;
    this.plane = plane;
    this.paint();
    const zooms = await tileZooms();
    if (zooms.length === 0) return;
    this.tiles = new TileLayer(zooms, plane, this.paint);
    this.paint();
  }

  redraw(): void {
    this.show(this.tracks, false);
  }

  fit(): void {
    this.fitted = false;
    this.paint();
  }

  private zoom(factor: number, at?: MouseEvent): void {
    if (at) {
      const box = this.canvas.getBoundingClientRect();
      const dx = (at.clientX - box.left - box.width / 2) / this.scale,
        dy = (at.clientY - box.top - box.height / 2) / this.scale;
      this.centre.east += dx * (1 - 1 / factor);
      this.centre.north -= dy * (1 - 1 / factor);
    }
    this.scale *= factor;
    this.paint();
  }

  private key(e: KeyboardEvent): void {
    if (e.target !== this.element) return;
    const step = 60 / this.scale;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => (this.centre.east -= step),
      ArrowRight: () => (this.centre.east += step),
      ArrowUp: () => (this.centre.north += step),
      ArrowDown: () => (this.centre.north -= step),
      "+": () => (this.scale *= 1.3),
      "=": () => (this.scale *= 1.3),
      "-": () => (this.scale /= 1.3),
      "0": () => (this.fitted = false),
    };
    if (!actions[e.key]) return;
    e.preventDefault();
    actions[e.key]!();
    this.paint();
  }

  private drag(e: PointerEvent): void {
    let { clientX: x, clientY: y } = e;
    this.canvas.setPointerCapture(e.pointerId);
    const move = (m: PointerEvent) => {
      this.centre.east -= (m.clientX - x) / this.scale;
      this.centre.north += (m.clientY - y) / this.scale;
      ({ clientX: x, clientY: y } = m);
      this.paint();
    };
    this.canvas.addEventListener("pointermove", move);
    this.canvas.addEventListener("pointerup", () => this.canvas.removeEventListener("pointermove", move), { once: true });
  }

  private hover(e: PointerEvent): void {
    const track = this.tracks[0];
    if (!track || e.buttons !== 0 || !this.linked) return;
    const box = this.canvas.getBoundingClientRect();
    let best = 20 ** 2,
      time: number | null = null;
    track.time.forEach((at, i) => {
      const p = this.place(track.east[i] ?? NaN, track.north[i] ?? NaN);
      const d = (p[0] - (e.clientX - box.left)) ** 2 + (p[1] - (e.clientY - box.top)) ** 2;
      if (d < best) (best = d), (time = at);
    });
    this.linked.point(time);
  }

  private place(east: number, north: number): [number, number] {
    return [
      this.size[0] / 2 + (east - this.centre.east) * this.scale,
      this.size[1] / 2 - (north - this.centre.north) * this.scale,
    ];
  }

  private bounds(): [number, number, number, number] {
    let [a, b, c, d] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const track of this.tracks)
      track.east.forEach((e, i) => {
        const n = track.north[i];
        if (e === null || n === null || n === undefined) return;
        (a = Math.min(a, e)), (b = Math.max(b, e)), (c = Math.min(c, n)), (d = Math.max(d, n));
      });
    return Number.isFinite(a) ? [a, b, c, d] : [-1, 1, -1, 1];
  }

  private draw(): void {
    const width = this.canvas.clientWidth,
      height =
        document.fullscreenElement === this.element ? window.innerHeight - 60 : this.tall * (window.innerWidth >= 2200 ? 1.8 : 1);
    if (width === 0) return;
    this.canvas.style.height = `${height}px`;
    this.size = [width, height];
    if (!this.fitted) {
      const [a, b, c, d] = this.bounds();
      this.centre = { east: (a + b) / 2, north: (c + d) / 2 };
      // a station at rest: centimetres of carrier phase are to be seen
      this.scale = 0.88 * Math.min(width / Math.max(b - a, 0.05), height / Math.max(d - c, 0.05));
      this.fitted = true;
    }
    const ratio = devicePixelRatio;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const g = this.canvas.getContext("2d")!;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = css("--surface");
    g.fillRect(0, 0, width, height);
    this.tiles?.draw(g, this.scale, (e, n) => this.place(e, n), this.bounds_m);
    this.grid(g, width, height);
    // the first one on top
    for (const track of [...this.tracks].reverse()) if (!this.hidden.has(track.label)) this.line(g, track);
    this.marks(g);
    // rests and wheels are where nothing was wrong
    for (const m of this.linked?.marks ?? []) if (m.paint !== "--good") this.mark(g, m);
  }

  /** What happened, where it was then. */
  private mark(g: CanvasRenderingContext2D, m: Mark): void {
    const track = this.tracks[0];
    if (!track) return;
    const i = firstFrom(track.time, m.at);
    if (i >= track.time.length) return;
    const [x, y] = this.place(track.east[i] ?? NaN, track.north[i] ?? NaN);
    if (x !== x) return;
    g.strokeStyle = css(m.paint);
    g.lineWidth = 2;
    g.beginPath(), g.moveTo(x - 5, y - 5), g.lineTo(x + 5, y + 5), g.moveTo(x + 5, y - 5), g.lineTo(x - 5, y + 5), g.stroke();
  }

  private step(pixels: number): number {
    const raw = pixels / this.scale,
      power = 10 ** Math.floor(Math.log10(raw));
    return [1, 2, 5, 10].map((m) => m * power).find((m) => m >= raw)!;
  }

  private get bounds_m(): [number, number, number, number] {
    const [halfEast, halfNorth] = [this.canvas.clientWidth / 2 / this.scale, this.canvas.clientHeight / 2 / this.scale];
    return [this.centre.east - halfEast, this.centre.east + halfEast, this.centre.north - halfNorth, this.centre.north + halfNorth];
  }

  /** Metres where it is not known where the plane lies, or where it covers so much that lines would be curved. */
  private get gridLines(): { meridians: Line[]; parallels: Line[]; unit: string } {
    const bounds = this.bounds_m;
    const widest = 2e6;
    if (this.plane && bounds[1] - bounds[0] < widest && bounds[3] - bounds[2] < widest) return { ...graticule(this.plane, bounds, 110 / this.scale), unit: "" };
    const step = this.step(90),
      unit = step >= 1000 ? 1000 : 1;
    const lines = (low: number, high: number) => {
      const out: Line[] = [];
      for (let n = Math.ceil(low / step); n * step <= high; ++n) out.push({ at: n * step, label: String(Number(((n * step) / unit).toPrecision(6))) });
      return out;
    };
    return { meridians: lines(bounds[0], bounds[1]), parallels: lines(bounds[2], bounds[3]), unit: step >= 1000 ? "km" : "m" };
  }

  private grid(g: CanvasRenderingContext2D, width: number, height: number): void {
    const { unit, ...lines } = this.gridLines;
    this.lines = lines;
    g.strokeStyle = css("--grid");
    g.lineWidth = 1;
    g.font = "11px system-ui, sans-serif";
    // over the tiles of a map labels need a ground
    const label = (text: string, x: number, y: number) => {
      g.fillStyle = css("--surface");
      if (this.tiles) g.fillRect(x - 2, y - 10, g.measureText(text).width + 4, 13);
      g.fillStyle = css("--muted");
      g.fillText(text, x, y);
    };
    for (const { at } of lines.meridians) {
      const [x] = this.place(at, 0);
      g.beginPath(), g.moveTo(x, 0), g.lineTo(x, height), g.stroke();
    }
    for (const { at } of lines.parallels) {
      const [, y] = this.place(0, at);
      g.beginPath(), g.moveTo(0, y), g.lineTo(width, y), g.stroke();
    }
    // not where the scale and the arrow stand, nor in the corner of the other labels
    const bar = this.step(110) * this.scale + 40;
    for (const line of lines.meridians) {
      const [x] = this.place(line.at, 0);
      const end = x + 3 + g.measureText(line.label).width;
      if (x >= 0 && end < width - bar) label(line.label, x + 3, height - 5);
    }
    for (const line of lines.parallels) {
      const [, y] = this.place(0, line.at);
      if (y > 30 && y < height - 20) label(line.label, 4, y - 3); // the unit stands above
    }
    g.fillStyle = css("--muted");
    if (unit) g.fillText(`${t("plan.axes")}, ${unit}`, 4, 14);
    // scale bar and north
    const length = this.step(110) * this.scale;
    g.strokeStyle = g.fillStyle = css("--text");
    g.lineWidth = 2;
    const x = width - length - 20,
      y = height - 26;
    g.beginPath(), g.moveTo(x, y - 5), g.lineTo(x, y), g.lineTo(x + length, y), g.lineTo(x + length, y - 5), g.stroke();
    const metres = this.step(110);
    g.textAlign = "center";
    g.fillText(metres >= 1000 ? `${metres / 1000} km` : `${metres} m`, x + length / 2, y - 6);
    g.beginPath(), g.moveTo(width - 24, 34), g.lineTo(width - 18, 14), g.lineTo(width - 12, 34), g.closePath(), g.fill();
    g.fillText("N", width - 18, 46);
    g.textAlign = "left";
  }

  private line(g: CanvasRenderingContext2D, track: Track2d): void {
    g.strokeStyle = g.fillStyle = colour(track.label, track.ink);
    g.lineWidth = 2;
    g.lineJoin = "round";   // mitred corners of a track that turns back on itself, as at rest, would stand out as spikes
    g.globalAlpha = 1;
    if (track.dots) {
      track.east.forEach((e, i) => {
        if (track.paints) g.fillStyle = css(track.paints[i] ?? "--muted");
        const [x, y] = this.place(e ?? NaN, track.north[i] ?? NaN);
        if (x === x) g.fillRect(x - 1.5, y - 1.5, 3, 3);
      });
      return;
    }
    g.beginPath();
    let pen = false;
    track.east.forEach((e, i) => {
      const n = track.north[i];
      if (e === null || n === null || n === undefined) return (pen = false);
      const [x, y] = this.place(e, n);
      if (pen) g.lineTo(x, y);
      else g.moveTo(x, y);
      return (pen = true);
    });
    g.stroke();
    // where it went without GNSS
    for (const span of this.linked?.spans ?? []) {
      g.strokeStyle = css("--warn");
      g.lineWidth = 6;
      g.globalAlpha = 0.35;
      g.beginPath();
      track.time.forEach((time, i) => {
        if (time < span.from || time > span.to) return;
        const [x, y] = this.place(track.east[i] ?? NaN, track.north[i] ?? NaN);
        g.lineTo(x, y);
      });
      g.stroke();
      g.globalAlpha = 1;
    }
  }

  private marks(g: CanvasRenderingContext2D): void {
    const track = this.tracks[0];
    if (!track || track.time.length === 0) return;
    const ring = (i: number, fill: string) => {
      const [x, y] = this.place(track.east[i] ?? NaN, track.north[i] ?? NaN);
      if (x !== x) return;
      g.beginPath(), g.arc(x, y, 6, 0, 2 * Math.PI);
      g.fillStyle = fill;
      g.strokeStyle = css("--text");
      g.lineWidth = 2;
      g.fill(), g.stroke();
    };
    ring(0, css("--surface"));
    const time = this.linked?.cursor;
    if (time === null || time === undefined) return;
    for (let i = 1; i < track.time.length; ++i) {
      if (track.time[i]! >= time) return ring(i, css("--warn"));
    }
  }

  private rows(): string {
    const out = ["track,time_s,east_m,north_m"];
    for (const track of this.tracks)
      track.time.forEach((time, i) => out.push(`"${track.label}",${time},${track.east[i] ?? ""},${track.north[i] ?? ""}`));
    return out.join("\n") + "\n";
  }

  private svg(): string {
    const width = this.canvas.clientWidth,
      height = this.canvas.clientHeight;
    const paths = this.tracks
      .filter((track) => !this.hidden.has(track.label))
      .map((track) => {
        const points = track.east
          .map((e, i) => this.place(e ?? NaN, track.north[i] ?? NaN))
          .filter(([x]) => x === x)
          .map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`);
        return `<polyline fill="none" stroke="${colour(track.label, track.ink)}" stroke-width="2" stroke-linejoin="round" points="${points.join(" ")}"/>`;
      });
    const metres = this.step(110),
      length = metres * this.scale;
    const bar =
      `<path d="M${width - length - 20},${height - 31}v5h${length}v-5" fill="none" stroke="#000" stroke-width="2"/>` +
      `<text x="${width - length / 2 - 20}" y="${height - 34}" text-anchor="middle" font-family="sans-serif" font-size="12">${metres >= 1000 ? `${metres / 1000} km` : `${metres} m`}</text>`;
    const lines = this.gridLines;
    const grid = [
      ...lines.meridians.map(({ at, label }) => {
        const x = this.place(at, 0)[0].toFixed(1);
        return `<path d="M${x},0V${height}" stroke="#ccc"/><text x="${Number(x) + 3}" y="${height - 5}" font-family="sans-serif" font-size="11" fill="#555">${label}</text>`;
      }),
      ...lines.parallels.map(({ at, label }) => {
        const y = this.place(0, at)[1].toFixed(1);
        return `<path d="M0,${y}H${width}" stroke="#ccc"/><text x="4" y="${Number(y) - 3}" font-family="sans-serif" font-size="11" fill="#555">${label}</text>`;
      }),
    ].join("");
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}">${grid}${paths.join("\n")}${bar}</svg>\n`;
  }
}
