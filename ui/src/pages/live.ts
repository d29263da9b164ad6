// Live navigation: the messages of a running `schuler live` as they arrive (docs/live.md).
import { api } from "../api";
import { h, replace, saveAs } from "../dom";
import { maybe, number, t } from "../i18n";
import type { Page } from "../page";
import { metresOf } from "../plots/graticule";
import { HorizonView } from "../plots/horizon";
import { Linked } from "../plots/linked";
import { PlanView } from "../plots/plan";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { watchLive } from "../streams";
import { LiveSky } from "./livesky";

type Message = Record<string, unknown>;

/** What is kept of the states: ten a second, an hour of them. */
const shortest_s = 0.1,
  most = 36_000,
  mostEvents = 200;

const columns = ["height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg", "std_n_m", "std_e_m", "std_d_m", "std_roll_deg", "std_pitch_deg", "std_heading_deg"] as const;
type ColumnName = (typeof columns)[number];

class Kept {
  readonly time: number[] = [];
  readonly east: number[] = [];
  readonly north: number[] = [];
  readonly of = Object.fromEntries(columns.map((c) => [c, [] as (number | null)[]])) as Record<ColumnName, (number | null)[]>;
  private origin: { lat: number; lon: number } | null = null;
  /** Told where the plane lies. */
  placed: ((origin: { lat: number; lon: number }) => void) | null = null;
  /** The time of the first message: times are shown from there. */
  zero: number | null = null;

  /** Metres east and north of the first state: radii of the ellipsoid there. */
  take(m: Message): boolean {
    const [lat, lon, at] = [m["lat_deg"], m["lon_deg"], m["time_s"]] as number[];
    if (typeof lat !== "number" || typeof lon !== "number" || typeof at !== "number") return false;
    let time = at - (this.zero ??= at);
    const last = this.time.at(-1);
    if (last !== undefined && time < last - 60) {
      // it was started anew, or another log is replayed
      this.clear();
      this.zero = at;
      this.origin = null;
      time = 0;
    } else if (last !== undefined && time - last < shortest_s * 0.999) return false;
    const origin = this.origin ?? { lat, lon };
    if (!this.origin) this.placed?.((this.origin = origin));
    const metres = metresOf(origin);
    const turn = ((((lon - origin.lon + 540) % 360) + 360) % 360) - 180;
    this.time.push(time);
    this.east.push(((turn * Math.PI) / 180) * metres.east);
    this.north.push((((lat - origin.lat) * Math.PI) / 180) * metres.north);
    for (const c of columns) this.of[c].push(typeof m[c] === "number" ? (m[c] as number) : null);
    if (this.time.length > most)
      for (const list of [this.time, this.east, this.north, ...Object.values(this.of)]) list.splice(0, most / 10);
    return true;
  }

  private clear(): void {
    for (const list of [this.time, this.east, this.north, ...Object.values(this.of)]) list.length = 0;
  }

  csv(): string {
    const rows = this.time.map((x, i) => [x, this.east[i], this.north[i], ...columns.map((c) => this.of[c][i] ?? "")].join(","));
    return [["time_s", "east_m", "north_m", ...columns].join(","), ...rows].join("\n") + "\n";
  }
}

function described(e: Message): string {
  const kind = maybe(`live.event.${String(e["kind"])}`, String(e["kind"]).replaceAll("_", " "));
  const rest = ["phase", "source", "aid", "status", "seconds"].filter((k) => e[k] !== undefined);
  const word = (k: string) => (k === "phase" ? maybe(`live.phase.${String(e[k])}`, String(e[k])) : k === "seconds" ? `${number(e[k] as number, 3)} s` : k === "aid" ? maybe(`aid.${String(e[k])}`, String(e[k])) : String(e[k]).replaceAll("_", " "));
  return `${kind}${rest.length > 0 ? ": " : ""}${rest.map(word).join(", ")}`;
}

export async function livePage(): Promise<Page> {
  const { live } = await api.about();
  if (!live)
    return {
      title: t("nav.live"),
      element: h("section", { class: "card" }, h("h1", null, t("nav.live")), h("p", null, t("live.none")), h("pre", { class: "toml", tabIndex: 0 }, "schuler live car.toml\nschuler ui --live tcp://localhost:5010")),
    };
  const kept = new Kept();
  const linked = new Linked(0, 1);
  let now: Message | null = null,
    health: Message | null = null,
    heard = 0,
    changed = false;
  const events: Message[] = [];

  const link = h("p", { class: "live-link", role: "status" }, t("live.connecting", { address: live }));
  const stats = h("div", { class: "stats" });
  const plan = new PlanView(linked, 430);
  const track = { label: t("track.solution"), ink: 0, time: kept.time, east: kept.east, north: kept.north };
  plan.show([track]);
  kept.placed = (origin) => void plan.lie(origin);
  const follow = h("input", { type: "checkbox", checked: true });
  const horizon = new HorizonView(
    () => (now ? { roll: Number(now["roll_deg"]), pitch: Number(now["pitch_deg"]), heading: Number(now["heading_deg"]) } : null),
    linked,
  );
  const plot = (title: string, unit: string, lines: [ColumnName, string][], more: { logY?: boolean } = {}) =>
    new TimePlot(
      {
        title,
        unit,
        height: 150,
        ...more,
        mayBeEmpty: true,
        lines: lines.map(([, label], ink) => ({ label, ink })),
        load: async () => ({ x: [...kept.time], y: lines.map(([c]) => [...kept.of[c]]) }),
      },
      linked,
    );
  const three = (a: ColumnName, b: ColumnName, c: ColumnName, names: string[]): [ColumnName, string][] => [a, b, c].map((x, i) => [x, t(names[i]!)]);
  const place = ["north", "east", "down"],
    angles = ["roll", "pitch", "heading"];
  const sigma = (what: string) => t("view.sigma_of", { what: t(what), axis: "" }).trim();
  const plots = [
    plot(sigma("view.position"), "m", three("std_n_m", "std_e_m", "std_d_m", place), { logY: true }),
    plot(t("view.velocity"), "m/s", three("vel_n_m_s", "vel_e_m_s", "vel_d_m_s", place)),
    plot(t("view.attitude"), "°", three("roll_deg", "pitch_deg", "heading_deg", angles)),
    plot(sigma("view.attitude"), "°", three("std_roll_deg", "std_pitch_deg", "std_heading_deg", angles), { logY: true }),
    plot(t("editor.height"), "m", [["height_m", t("editor.height")]]),
  ];
  linkCursors(plots, linked);
  const sources = h("div");
  const list = h("div");
  const sky = new LiveSky();

  const card = (name: string, value: string, note = "") => h("div", { class: "stat" }, h("span", { class: "stat-name" }, name), h("strong", null, value), h("span", { class: "muted" }, note));
  const of = (m: Message | null, key: string) => (typeof m?.[key] === "number" ? (m[key] as number) : null);
  const drawStats = () => {
    const speed = now ? Math.hypot(of(now, "vel_n_m_s") ?? NaN, of(now, "vel_e_m_s") ?? NaN) : null;
    const flat = now ? Math.hypot(of(now, "std_n_m") ?? NaN, of(now, "std_e_m") ?? NaN) : null;
    const phase = String(health?.["phase"] ?? (now ? "navigating" : ""));
    replace(
      stats,
      card(t("live.phase"), phase ? maybe(`live.phase.${phase}`, phase.replaceAll("_", " ")) : "–", now ? `t = ${((of(now, "time_s") ?? NaN) - (kept.zero ?? 0)).toFixed(1)} s` : ""),
      card(t("live.position"), now ? `${(of(now, "lat_deg") ?? NaN).toFixed(7)}°, ${(of(now, "lon_deg") ?? NaN).toFixed(7)}°` : "–", now ? `${t("editor.height")} ${number(of(now, "height_m"), 6)} m` : ""),
      card(t("live.sigma"), `${number(flat, 3)} m`, `${t("vertical")} ${number(of(now, "std_d_m"), 3)} m`),
      card(t("editor.speed"), `${number(speed, 4)} m/s`, `${t("down")} ${number(of(now, "vel_d_m_s"), 3)} m/s`),
      card(t("heading"), `${number(of(now, "heading_deg"), 5)}°`, `σ ${number(of(now, "std_heading_deg"), 2)}°`),
      card(t("overview.imu_card"), `${number(of(health, "imu_hz"), 4)} Hz`, t("live.latency", { median: number(of(health, "latency_median_ms"), 3), largest: number(of(health, "latency_largest_ms"), 3) })),
    );
  };
  const drawHealth = () => {
    if (!health) return replace(sources, h("p", { class: "muted" }, t("live.no_health")));
    const samples = (health["samples"] ?? {}) as Record<string, Record<string, number>>;
    const names = Object.keys(samples);
    const statuses = ["taken", ...new Set(names.flatMap((n) => Object.entries(samples[n]!).filter(([k, v]) => k !== "taken" && v > 0).map(([k]) => k)))];
    replace(
      sources,
      h(
        "div",
        { class: "scroll", tabIndex: 0 },
        h(
          "table",
          null,
          h("thead", null, h("tr", null, h("th", { scope: "col" }, t("live.source")), ...statuses.map((s) => h("th", { scope: "col", class: "figure" }, maybe(`live.status.${s}`, s.replaceAll("_", " ")))))),
          h("tbody", null, ...names.map((n) => h("tr", null, h("th", { scope: "row" }, n.replaceAll("_", " ")), ...statuses.map((s) => h("td", { class: "figure" }, String(samples[n]![s] ?? 0)))))),
        ),
      ),
      h("p", { class: "muted" }, ["holes", "restarts", "garbage", "foreign", "reconnections", "dropped", "readers"].map((k) => `${t(`live.count.${k}`)} ${of(health, k) ?? 0}`).join(" · ")),
    );
  };
  const drawEvents = () =>
    replace(
      list,
      events.length === 0
        ? h("p", { class: "muted" }, t("live.no_events"))
        : h(
            "div",
            { class: "scroll live-events", tabIndex: 0 },
            h("table", null, h("tbody", null, ...events.map((e) => h("tr", null, h("td", { class: "figure" }, `${number((of(e, "time_s") ?? NaN) - (kept.zero ?? 0), 6)} s`), h("td", null, described(e)))))),
          ),
    );
  const draw = () => {
    if (document.hidden) return;
    const silent = heard > 0 && Date.now() - heard > 3000;
    link.classList.toggle("silent", silent);
    if (silent && connected) link.textContent = t("live.silent", { s: Math.round((Date.now() - heard) / 1000) });
    sky.age();
    if (!changed) return;
    changed = false;
    drawStats();
    horizon.redraw();
    if (kept.time.length === 0) return;
    linked.extend(kept.time[0]!, Math.max(kept.time.at(-1)!, kept.time[0]! + 1));
    if (follow.checked) plan.fit();
    else plan.redraw();
    if (!element.querySelector("figure.plot:hover")) linked.point(kept.time.at(-1)!);
  };
  let connected = false;
  const linkChanged = (m: Message) => {
    connected = m["connected"] === true;
    heard = connected ? Date.now() : 0;
    const address = String(m["address"]);
    link.textContent = connected ? t("live.connected", { address }) : t("live.lost", { address, why: String(m["text"]) });
    link.classList.toggle("bad", !connected);
  };
  const take = (m: Message) => {
    if (connected && Date.now() - heard > 3000) link.textContent = t("live.connected", { address: live });
    heard = Date.now();
    if (typeof m["time_s"] === "number") kept.zero ??= m["time_s"];
    if (m["type"] === "state" && m["at"] !== "lag") {
      now = m;
      kept.take(m);
      changed = true;
    } else if (m["type"] === "health") {
      health = m;
      changed = true;
      if (m["phase"] !== "navigating") now = null;
      drawHealth();
    } else if (m["type"] === "satellites") {
      sky.take(m);
    } else if (m["type"] === "event") {
      events.unshift(m);
      events.length = Math.min(events.length, mostEvents);
      drawEvents();
    }
  };
  const leave = watchLive(
    (name, m) => (name === "link" ? linkChanged(m) : take(m)),
    () => {
      connected = false;
      link.textContent = t("live.connecting", { address: live });
    },
  );
  const timer = window.setInterval(draw, 200);
  drawStats();
  drawHealth();
  drawEvents();
  const element = h(
    "div",
    { class: "live" },
    h(
      "div",
      { class: "bar" },
      h("h1", null, t("nav.live")),
      h("span", { class: "grow" }),
      h("label", null, follow, ` ${t("live.follow")}`),
      h("button", { type: "button", onClick: () => saveAs(new Blob([kept.csv()], { type: "text/csv" }), "live.csv") }, "CSV"),
    ),
    link,
    stats,
    h(
      "div",
      { class: "quality-grid" },
      h(
        "div",
        { class: "quality-left" },
        plan.element,
        sky.element,
        h("section", { class: "card" }, h("h2", null, t("live.health")), sources),
        h("section", { class: "card" }, h("h2", null, t("event.title")), list),
      ),
      h("div", { class: "quality-right" }, horizon.element, ...plots.map((p) => p.element)),
    ),
  );
  return {
    title: t("nav.live"),
    element,
    redraw: () => [...plots, plan, horizon].forEach((p) => p.redraw()),
    close: () => (leave(), window.clearInterval(timer)),
  };
}
