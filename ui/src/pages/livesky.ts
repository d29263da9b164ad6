// The satellites that the receiver of a live run reports: where they are, how strong, which it uses.
import { h, replace } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { SkyPlot } from "../plots/skyplot";
import { table } from "./overview";

interface Satellite {
  name: string;
  elevation: number | null;
  azimuth: number | null;
  cn0: number | null;
  used: boolean;
}

/** From a message; what is no satellite is passed over. */
function satellitesOf(message: Record<string, unknown>): Satellite[] {
  const list = Array.isArray(message["satellites"]) ? (message["satellites"] as unknown[]) : [];
  const value = (s: Record<string, unknown>, key: string) => (typeof s[key] === "number" ? (s[key] as number) : null);
  return list.flatMap((each) => {
    const s = (each ?? {}) as Record<string, unknown>;
    if (typeof s["name"] !== "string") return [];
    return [{ name: s["name"], elevation: value(s, "elevation_deg"), azimuth: value(s, "azimuth_deg"), cn0: value(s, "cn0_db_hz"), used: s["used"] === true }];
  });
}

const strongest = 55,
  old_ms = 10_000;

export class LiveSky {
  readonly element: HTMLElement;
  private readonly sky = new SkyPlot([], new Linked(0, 1), 1);
  private readonly rows = h("div");
  private readonly count = h("p", { role: "status" });
  private told = "";
  private heard = 0;

  constructor() {
    const key = (status: number, text: string) => h("span", { class: "sky-key" }, h("span", { class: `swatch status-${status}` }), text);
    this.element = h(
      "section",
      { class: "card live-sky", hidden: true },
      h("h2", null, t("live.satellites")),
      this.count,
      h("div", { class: "live-sky-grid" }, h("div", null, this.sky.element as unknown as HTMLElement, h("p", { class: "muted" }, key(0, t("sky.used")), key(2, t("live.sky_unused")))), this.rows),
    );
  }

  take(message: Record<string, unknown>): void {
    const all = satellitesOf(message);
    this.heard = Date.now();
    this.element.hidden = false;
    this.told = t("live.sky_count", { used: all.filter((s) => s.used).length, n: all.length });
    this.age();
    this.sky.show(
      all
        .filter((s) => s.azimuth !== null && s.elevation !== null)
        .map((s) => ({ name: s.name, station: false, seen: [{ time: 0, azimuth: s.azimuth!, elevation: s.elevation!, status: s.used ? 0 : 2, residual: null, sigma: null }] })),
    );
    const bar = (s: Satellite) =>
      h("span", { class: `cn0 ${s.used ? "used" : ""}` }, h("span", { style: `width:${(100 * Math.min(s.cn0 ?? 0, strongest)) / strongest}%` }), h("b", null, number(s.cn0, 3)));
    const list = table(
      [t("sky.source"), t("live.cn0"), t("live.elevation"), t("live.azimuth"), t("sky.used")],
      all.map((s) => [s.name, number(s.cn0, 3), number(s.elevation, 3), number(s.azimuth, 3), t(s.used ? "yes" : "no")]),
      t("sky.table"),
    );
    list.querySelectorAll("tbody tr").forEach((row, i) => replace(row.children[1] as HTMLElement, bar(all[i]!)));
    replace(this.rows, list);
  }

  /** A receiver that has fallen silent is told. */
  age(): void {
    const late = Date.now() - this.heard;
    this.count.textContent = late > old_ms ? t("live.sky_old", { s: Math.round(late / 1000) }) : this.told;
    this.element.classList.toggle("old", late > old_ms);
  }
}
