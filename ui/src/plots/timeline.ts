// Outages on a time line: drag to cut GNSS, drag an edge to change it, or type the numbers below.
import { css, h, replace } from "../dom";
import { number, t } from "../i18n";

export interface Outage {
  start_s: number;
  duration_s: number;
}

export class OutageLine {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { class: "timeline", role: "img", "aria-label": t("outage.title") });
  private readonly list = h("div", { class: "outage-list" });
  private outages: Outage[] = [];
  private duration = 1;
  private draft: { from: number; to: number; index: number } | null = null;

  constructor(private readonly changed: (outages: Outage[]) => void) {
    this.element = h(
      "section",
      { class: "plot" },
      h(
        "figcaption",
        null,
        h("span", { class: "plot-title" }, t("outage.title")),
        h("span", { class: "plot-note" }, t("outage.hint")),
      ),
      this.canvas,
      this.list,
    );
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.canvas.addEventListener("pointerdown", (e) => this.grab(e));
    this.canvas.addEventListener("pointermove", (e) => {
      if (!this.draft) this.canvas.style.cursor = this.edge(e) ? "ew-resize" : "crosshair";
    });
  }

  show(outages: Outage[], duration: number): void {
    this.outages = outages.map((o) => ({ ...o }));
    this.duration = Math.max(duration, 1);
    this.draw();
    this.rows();
  }

  private get inner(): [number, number] {
    return [10, this.canvas.clientWidth - 20];
  }

  private time(e: PointerEvent): number {
    const [left, width] = this.inner;
    const at = (e.clientX - this.canvas.getBoundingClientRect().left - left) / width;
    const step = this.duration > 200 ? 1 : 0.1;
    return Math.round((Math.min(Math.max(at, 0), 1) * this.duration) / step) * step;
  }

  private edge(e: PointerEvent): { index: number; end: boolean } | null {
    const near = (6 / this.inner[1]) * this.duration,
      now = this.time(e);
    for (const [index, o] of this.outages.entries()) {
      if (Math.abs(now - o.start_s - o.duration_s) < near) return { index, end: true };
      if (Math.abs(now - o.start_s) < near) return { index, end: false };
    }
    return null;
  }

  private grab(e: PointerEvent): void {
    const edge = this.edge(e),
      now = this.time(e);
    const old = edge ? this.outages[edge.index]! : null;
    const fixed = old ? (edge!.end ? old.start_s : old.start_s + old.duration_s) : now;
    this.draft = { from: fixed, to: now, index: edge?.index ?? -1 };
    this.canvas.setPointerCapture(e.pointerId);
    const move = (m: PointerEvent) => {
      this.draft!.to = this.time(m);
      this.draw();
    };
    this.canvas.addEventListener("pointermove", move);
    this.canvas.addEventListener(
      "pointerup",
      () => {
        this.canvas.removeEventListener("pointermove", move);
        const { from, to, index } = this.draft!;
        this.draft = null;
        const span = { start_s: Math.min(from, to), duration_s: Math.abs(to - from) };
        if (index >= 0) this.outages.splice(index, 1);
        if (span.duration_s > this.duration * 0.004) this.outages.push(span);
        this.outages.sort((a, b) => a.start_s - b.start_s);
        this.tell();
      },
      { once: true },
    );
  }

  private tell(): void {
    this.draw();
    this.rows();
    this.changed(
      this.outages.map((o) => ({ start_s: Number(o.start_s.toFixed(3)), duration_s: Number(o.duration_s.toFixed(3)) })),
    );
  }

  private rows(): void {
    const field = (o: Outage, key: keyof Outage, name: string) =>
      h(
        "label",
        null,
        name,
        h("input", {
          type: "number",
          min: "0",
          step: "any",
          value: String(o[key]),
          onChange: (e: Event) => {
            const x = Number((e.target as HTMLInputElement).value);
            if (Number.isFinite(x) && x >= 0) o[key] = x;
            this.tell();
          },
        }),
        "s",
      );
    replace(
      this.list,
      ...this.outages.map((o, i) =>
        h(
          "div",
          { class: "outage" },
          field(o, "start_s", t("outage.start")),
          field(o, "duration_s", t("outage.length")),
          h(
            "button",
            {
              type: "button",
              class: "icon",
              "aria-label": `${t("remove")} ${i + 1}`,
              onClick: () => (this.outages.splice(i, 1), this.tell()),
            },
            "✕",
          ),
        ),
      ),
      h(
        "button",
        {
          type: "button",
          onClick: () => {
            const last = this.outages.at(-1);
            const start = last ? last.start_s + last.duration_s + 0.1 * this.duration : 0.6 * this.duration;
            this.outages.push({
              start_s: Math.round(Math.min(start, 0.9 * this.duration)),
              duration_s: Math.max(1, Math.round(0.05 * this.duration)),
            });
            this.tell();
          },
        },
        t("outage.add"),
      ),
    );
  }

  draw(): void {
    const width = this.canvas.clientWidth,
      height = 56;
    if (width === 0) return;
    this.canvas.width = width * devicePixelRatio;
    this.canvas.height = height * devicePixelRatio;
    const g = this.canvas.getContext("2d")!;
    g.scale(devicePixelRatio, devicePixelRatio);
    const [left, inner] = this.inner;
    const x = (time: number) => left + (time / this.duration) * inner;
    g.fillStyle = css("--ink-3");
    g.globalAlpha = 0.55;
    g.fillRect(left, 12, inner, 18);
    g.globalAlpha = 1;
    const spans = [...this.outages];
    if (this.draft) {
      if (this.draft.index >= 0) spans.splice(this.draft.index, 1);
      spans.push({ start_s: Math.min(this.draft.from, this.draft.to), duration_s: Math.abs(this.draft.to - this.draft.from) });
    }
    for (const s of spans) {
      const a = x(s.start_s),
        b = x(s.start_s + s.duration_s);
      g.fillStyle = css("--surface");
      g.fillRect(a, 9, b - a, 24);
      g.strokeStyle = css("--warn");
      g.lineWidth = 2;
      g.strokeRect(a, 10, Math.max(b - a, 1), 22);
      g.lineWidth = 1;
      for (let k = a + 4; k < b; k += 6) g.beginPath(), g.moveTo(k, 32), g.lineTo(Math.min(k + 8, b), 10), g.stroke();
    }
    g.fillStyle = css("--muted");
    g.font = "11px system-ui, sans-serif";
    g.textAlign = "center";
    const raw = this.duration / Math.max(2, inner / 90),
      power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((m) => m >= raw)!;
    for (let time = 0; time <= this.duration * 1.0001; time += step)
      g.fillText(`${number(time)} s`, Math.min(Math.max(x(time), 14), width - 18), 48);
  }
}
