// Artificial horizon and heading at the cursor.
import { css, h } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "./linked";

export interface AttitudeAt {
  (time: number): { roll: number; pitch: number; heading: number } | null;
}

export class HorizonView {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", {
    width: 520,
    height: 520,
    class: "horizon",
    role: "img",
    "aria-label": t("horizon.title"),
  });
  private readonly words = h("p", { class: "readout" });

  constructor(
    private readonly attitude: AttitudeAt,
    private readonly linked: Linked,
  ) {
    this.element = h(
      "figure",
      { class: "plot" },
      h("figcaption", null, h("span", { class: "plot-title" }, t("horizon.title"))),
      this.canvas,
      this.words,
    );
    linked.onCursor(Linked.perFrame(() => this.redraw()));
    this.redraw();
  }

  redraw(): void {
    const now = this.attitude(this.linked.cursor ?? this.linked.from);
    const g = this.canvas.getContext("2d")!;
    const c = this.canvas.width / 2,
      r = c - 34;
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.clearRect(0, 0, 2 * c, 2 * c);
    const { roll, pitch, heading } = now ?? { roll: 0, pitch: 0, heading: 0 };
    g.save();
    g.beginPath(), g.arc(c, c, r, 0, 2 * Math.PI), g.clip();
    g.translate(c, c), g.rotate((-roll * Math.PI) / 180);
    const scale = r / 35;
    (g.fillStyle = "#4a90c2"), g.fillRect(-2 * c, -4 * c, 4 * c, 4 * c + pitch * scale);
    (g.fillStyle = "#8a6a3f"), g.fillRect(-2 * c, pitch * scale, 4 * c, 4 * c);
    g.strokeStyle = g.fillStyle = "#fff";
    (g.lineWidth = 3), (g.font = "20px system-ui, sans-serif"), (g.textBaseline = "middle");
    for (let p = -80; p <= 80; p += 10) {
      const y = (pitch - p) * scale,
        half = p === 0 ? 2 * c : 60;
      if (Math.abs(y) > r) continue;
      g.beginPath(), g.moveTo(-half, y), g.lineTo(half, y), g.stroke();
      if (p !== 0) g.fillText(String(p), half + 6, y);
    }
    g.restore();
    g.save(), g.translate(c, c);
    (g.strokeStyle = css("--warn")), (g.lineWidth = 7);
    g.beginPath(),
      g.moveTo(-110, 0),
      g.lineTo(-40, 0),
      g.lineTo(-22, 18),
      g.lineTo(0, 0),
      g.lineTo(22, 18),
      g.lineTo(40, 0),
      g.lineTo(110, 0),
      g.stroke();
    (g.strokeStyle = css("--text")),
      (g.fillStyle = css("--text")),
      (g.lineWidth = 2),
      (g.textAlign = "center"),
      (g.textBaseline = "middle");
    g.font = "20px system-ui, sans-serif";
    for (let a = 0; a < 360; a += 30) {
      const turn = ((a - heading - 90) * Math.PI) / 180;
      g.fillText(
        { 0: "N", 90: "E", 180: "S", 270: "W" }[a] ?? String(a / 10),
        (r + 18) * Math.cos(turn),
        (r + 18) * Math.sin(turn),
      );
    }
    g.beginPath(), g.moveTo(0, -r + 4), g.lineTo(-9, -r + 22), g.lineTo(9, -r + 22), g.closePath(), g.fill();
    g.restore();
    this.words.textContent = now
      ? `${t("roll")} ${number(roll, 4)}°, ${t("pitch")} ${number(pitch, 4)}°, ${t("heading")} ${number(heading, 5)}°`
      : t("plot.empty");
  }
}
