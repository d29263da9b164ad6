// One run: live while it works, then its views.
import { api, watchRuns, type Group, type RunDetails, type RunEvent, type Spread, type Summary } from "../api";
import { append, copyText, h, icon, replace, saveAs, tell } from "../dom";
import { number, t } from "../i18n";
import type { Page } from "../page";
import { Linked } from "../plots/linked";
import { PlanView } from "../plots/plan";
import { HorizonView } from "../plots/horizon";
import type { Track3d } from "../plots/space";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { stateBadge } from "./start";
import { errorPlots, innovationPlots, motionPlots, sensorPlots, unit } from "./views";

type Cells = (string | HTMLElement)[];

export function table(head: string[], rows: Cells[], caption: string): HTMLElement {
  const text = () => [head, ...rows.map((r) => r.map((c) => (typeof c === "string" ? c : c.textContent)))].map((r) => r.join("\t")).join("\n");
  return h(
    "div",
    { class: "table-block" },
    h("h3", null, caption, h("button", { type: "button", class: "icon", title: t("table.copy"), "aria-label": `${t("table.copy")}: ${caption}`, onClick: () => void copyText(text(), caption) }, icon("copy"))),
    h("div", { class: "scroll", tabIndex: 0 }, h("table", null, h("thead", null, h("tr", null, ...head.map((x, i) => h("th", { scope: "col", class: i > 0 ? "figure" : "" }, x)))),
      h("tbody", null, ...rows.map((r) => h("tr", null, ...r.map((c, i) => h(i === 0 ? "th" : "td", i === 0 ? { scope: "row" } : { class: "figure" }, c))))))),
  );
}

const units: Record<string, string> = { position_m: "m", velocity_m_s: "m/s", attitude_deg: "°" };
const isSpread = (x: unknown): x is Spread => typeof x === "object" && x !== null && "rms" in x;

export function errorRows(summary: Summary): { key: string; name: string; spread: Spread }[] {
  const out: { key: string; name: string; spread: Spread }[] = [];
  for (const [group, u] of Object.entries(units))
    for (const [axis, spread] of Object.entries(summary.errors?.[group] ?? {}))
      if (isSpread(spread) && spread.rms !== null) out.push({ key: `${group}.${axis}`, name: `${t(`view.${group.split("_")[0]!}`)} ${t(axis)}, ${u}`, spread });
  return out;
}

function overview(run: RunDetails): HTMLElement {
  const s = run.summary;
  const box = h("div", { class: "overview" });
  if (!s) return append(box, h("p", { class: "muted" }, t("plot.empty"))), box;
  const card = (name: string, value: string, note = "") => h("div", { class: "stat" }, h("span", { class: "stat-name" }, name), h("strong", null, value), h("span", { class: "muted" }, note));
  const cards = h("div", { class: "stats" });
  const shown = ["position_m.horizontal", "position_m.up", "attitude_deg.heading"];
  for (const { key, name, spread } of errorRows(s)) if (shown.includes(key)) append(cards, card(name, number(spread.rms, 3), `rms · ${t("table.max")} ${number(spread.max, 3)}`));
  const inside = s.outages?.filter((o) => o.inside_3sigma !== null) ?? [];
  if (inside.length > 0) append(cards, card(t("table.outages"), `${inside.filter((o) => o.inside_3sigma).length} / ${inside.length}`, t("table.inside")));
  append(box, cards);
  if (s.imu && s.gnss)
    append(box, h("p", { class: "muted" }, `${t("overview.imu", { n: s.imu.epochs, rate: number(s.imu.rate_hz), gaps: s.imu.gaps })}; ${t("overview.gnss", { n: s.gnss.epochs, accepted: s.gnss.accepted, rejected: s.gnss.rejected })}. ${s.settled_after_s !== null ? t("table.settled", { s: number(s.settled_after_s) }) : ""}`));
  if (s.warnings.length > 0) append(box, h("h3", null, t("table.warnings")), h("ul", { class: "problems" }, ...s.warnings.map((w) => h("li", { class: "warning" }, `⚠ ${w}`))));
  const rows = errorRows(s);
  if (rows.length > 0) append(box, table([t("table.quantity"), t("table.rms"), t("table.p95"), t("table.max")], rows.map(({ name, spread }) => [name, number(spread.rms), number(spread.p95), number(spread.max)]), t("table.errors")));
  if (s.outages && s.outages.length > 0)
    append(box, table(["at", "length", "end", "max_h", "end_v", "max_3d", "inside"].map((x) => t(`table.${x}`)),
      s.outages.map((o) => [number(o.start_s, 6), number(o.duration_s), number(o.end_horizontal_m), number(o.max_horizontal_m), number(o.end_vertical_m), number(o.max_3d_m), o.inside_3sigma === null ? "–" : t(o.inside_3sigma ? "yes" : "no")]), t("table.outages")));
  const c = s.consistency ?? {};
  const consistency: Cells[] = [];
  for (const [name, value] of Object.entries(c)) {
    const v = value as Record<string, number | null> | null;
    if (v && "mean" in v && v["mean"] !== null) consistency.push([name.replaceAll("_", " "), number(v["mean"]), number(v["expected"] ?? null), number(v["low95"] ?? null), number(v["high95"] ?? null)]);
  }
  for (const [name, value] of Object.entries((c["nis"] ?? {}) as Record<string, Record<string, number | null> | null>))
    if (value && value["mean"] !== null && value["mean"] !== undefined) consistency.push([`NIS ${t(`aid.${name}`)}`, number(value["mean"]), number(value["dof"] ?? null), "–", "–"]);
  if (consistency.length > 0) append(box, table([t("table.quantity"), t("table.mean"), t("table.expected"), t("table.low"), t("table.high")], consistency, t("table.consistency")));
  append(box, h("h3", null, t("run.files")), h("ul", { class: "files" }, ...run.files.map((f) => h("li", null, h("a", { href: api.fileUrl(run.id, f, true) }, f)))));
  return box;
}

async function trackData(run: string): Promise<Track3d> {
  const names = ["local:north", "local:east", "local:up", "attitude:roll", "attitude:pitch", "attitude:heading"].map((n) => `/solution/${n}`);
  const s = await api.series(run, names, { points: 1500 });
  const [north, east, up, roll, pitch, heading] = names.map((n) => s.columns[n]!);
  return { time: s.time_s, north: north!, east: east!, up: up!, roll: roll!, pitch: pitch!, heading: heading! };
}

interface View {
  element: HTMLElement;
  redraw: () => void;
}

async function trackView(run: string, groups: Group[], linked: Linked): Promise<View> {
  const track = await trackData(run);
  const plan = new PlanView(linked, window.innerWidth < 1700 ? 640 : 420);
  const local = async (group: string) => {
    const s = await api.series(run, [`${group}/local:east`, `${group}/local:north`], { points: 1500 });
    return { time: s.time_s, east: s.columns[`${group}/local:east`]!, north: s.columns[`${group}/local:north`]! };
  };
  const tracks = [{ label: t("track.solution"), ink: 0, ...track }];
  if (groups.some((g) => g.group === "/reference")) tracks.push({ label: t("track.reference"), ink: 2, ...(await local("/reference")) } as never);
  if (groups.some((g) => g.group === "/gnss")) tracks.push({ label: t("track.gnss"), ink: 1, dots: true, ...(await local("/gnss")) } as never);
  plan.show(tracks);
  const { SpaceView, nearest } = await import("../plots/space");
  const space = new SpaceView(track, linked);
  const horizon = new HorizonView((time) => {
    const i = nearest(track.time, time);
    return track.roll[i] === undefined ? null : { roll: track.roll[i] ?? 0, pitch: track.pitch[i] ?? 0, heading: track.heading[i] ?? 0 };
  }, linked);
  const slider = h("input", { type: "range", min: String(linked.start), max: String(linked.stop), step: "any", value: String(linked.start), "aria-label": t("time.at"), onInput: () => linked.point(Number(slider.value)) });
  const shown = h("output", null, "0 s");
  linked.onCursor(() => {
    if (linked.cursor === null) return;
    slider.value = String(linked.cursor);
    shown.textContent = `${linked.cursor.toFixed(1)} s`;
  });
  let playing = 0;
  const play = h("button", { type: "button", onClick: () => {
    window.clearInterval(playing);
    if (play.textContent === t("space.stop")) return (play.textContent = t("space.play"));
    play.textContent = t("space.stop");
    const step = (linked.stop - linked.start) / 900;
    playing = window.setInterval(() => {
      const next = Number(slider.value) + step;
      linked.point(next > linked.stop ? linked.start : next);
      if (!play.isConnected) window.clearInterval(playing);
    }, 33);
    return undefined;
  } }, t("space.play"));
  const element = h("div", null, h("div", { class: "time-bar" }, play, slider, shown), h("div", { class: "track-grid" }, plan.element, space.element, horizon.element));
  return { element, redraw: () => (plan.redraw(), space.redraw(), horizon.redraw()) };
}

function plotsView(plots: TimePlot[], linked: Linked, note = ""): View {
  linkCursors(plots, linked);
  const element = h("div", null, note && h("p", { class: "muted" }, note), plots.length === 0 && h("p", { class: "muted" }, t("plot.empty")), h("div", { class: "plots" }, ...plots.map((p) => p.element)));
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}

function tableView(run: string, groups: Group[], linked: Linked): View {
  const chooser = h("select", { "aria-label": t("table.group"), onChange: () => void fill() }, ...groups.map((g) => h("option", { value: g.group }, g.group.slice(1))));
  const from = h("input", { type: "number", step: "any", value: String(linked.cursor ?? linked.from), "aria-label": t("table.from_row"), onChange: () => void fill() });
  const place = h("div");
  const fill = async () => {
    const g = groups.find((x) => x.group === chooser.value)!;
    const rate = g.stop_s !== null && g.start_s !== null && g.rows > 1 ? (g.stop_s - g.start_s) / (g.rows - 1) : 1;
    const start = Math.max(Number(from.value), g.start_s ?? 0);
    const ids = g.columns.slice(0, 64).map((c) => c.id);
    const s = await api.series(run, ids, { from: start, to: start + 200 * rate, points: 0 });
    const head = [`${t("plot.time")}, s`, ...g.columns.slice(0, 64).map((c) => `${c.id.slice(g.group.length + 1).replace(":", " ").replace(/^std_/, "σ ").replaceAll("_", " ")}${unit(c.unit) ? `, ${unit(c.unit)}` : ""}`)];
    replace(place, table(head, s.time_s.map((x, i) => [number(x, 9), ...g.columns.slice(0, 64).map((c) => number(s.columns[c.id]![i], c.id.includes("/position:l") ? 11 : 6))]), `${g.group.slice(1)} (${g.rows})`));
  };
  void fill();
  return { element: h("div", null, h("p", { class: "form-tools" }, h("label", null, t("table.group"), " ", chooser), h("label", null, t("table.from_row"), " ", from, " s")), place), redraw: () => undefined };
}

async function whileWorking(run: RunDetails, done: () => void): Promise<Page> {
  const bar = h("progress", { max: 1, value: run.progress ?? 0, "aria-label": t("run.working") });
  const log = h("pre", { class: "log", tabIndex: 0 });
  const words = h("p", null, t(run.state === "waiting" ? "run.queue" : "run.working"));
  const refresh = async () => (log.textContent = await api.log(run.id));
  const timer = window.setInterval(() => void refresh(), 1500);
  const stop = watchRuns((e: RunEvent) => {
    if (e.id !== run.id) return;
    bar.value = e.progress;
    words.textContent = `${t(e.state === "waiting" ? "run.queue" : "run.working")} ${Math.round(100 * e.progress)} %`;
    if (e.state !== "waiting" && e.state !== "running") done();
  });
  void refresh();
  const element = h("div", null, h("h1", null, run.title), h("section", { class: "card" }, words, bar, h("p", null, h("button", { type: "button", onClick: () => void api.cancel(run.id).catch((e: Error) => tell(e.message, "error")) }, t("run.cancel"))), h("h2", null, t("run.log")), log));
  return { title: run.title, element, close: () => (stop(), window.clearInterval(timer)) };
}

const tabs = ["overview", "track", "errors", "sensors", "innovations", "motion", "table", "report", "log"] as const;

async function finished(run: RunDetails, first: string): Promise<Page> {
  const groups = run.files.includes("run.h5") ? await api.channels(run.id) : [];
  const stops = groups.map((g) => g.stop_s).filter((x): x is number => x !== null);
  const linked = new Linked(0, Math.max(1e-3, ...stops));
  linked.spans = (run.summary?.outages ?? []).map((o) => ({ from: o.start_s, to: o.start_s + o.duration_s, label: t("outage.title") }));
  const place = h("div", { class: "view", role: "tabpanel", id: "view", tabIndex: 0 });
  const made = new Map<string, View>();
  let current = "";
  const make = async (name: string): Promise<View> => {
    const plain = (element: HTMLElement): View => ({ element, redraw: () => undefined });
    switch (name) {
      case "track": return trackView(run.id, groups, linked);
      case "errors": return plotsView(errorPlots(run.id, groups, linked), linked, groups.some((g) => g.group === "/errors") ? "" : t("view.no_reference"));
      case "sensors": return plotsView(sensorPlots(run.id, groups, linked), linked);
      case "innovations": return plotsView(innovationPlots(run.id, groups, linked), linked);
      case "motion": return plotsView(motionPlots(run.id, groups, linked), linked);
      case "table": return tableView(run.id, groups, linked);
      case "report": {
        const url = api.fileUrl(run.id, "report.html");
        return plain(h("div", null, h("p", null, h("a", { href: url, target: "_blank", rel: "noopener" }, t("run.print")), " · ", h("a", { href: api.fileUrl(run.id, "report.html", true) }, "report.html")), h("iframe", { class: "report", src: url, title: t("run.report") })));
      }
      case "log": {
        const text = await api.log(run.id);
        return plain(h("div", null, h("button", { type: "button", onClick: () => saveAs(new Blob([text]), "log.txt") }, "log.txt"), h("pre", { class: "log", tabIndex: 0 }, text)));
      }
      default: return plain(overview(run));
    }
  };
  const buttons = tabs
    .filter((name) => !["track", "errors", "sensors", "innovations", "motion", "table"].includes(name) || groups.length > 0)
    .filter((name) => name !== "report" || run.files.includes("report.html"))
    .map((name) => h("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": "view", onClick: () => void show(name) }, t(`tab.${name}`)));
  const show = async (name: string) => {
    current = name;
    history.replaceState(null, "", `#/run/${encodeURIComponent(run.id)}/${name}`);
    for (const b of buttons) {
      b.setAttribute("aria-selected", String(b.id === `tab-${name}`));
      b.tabIndex = b.id === `tab-${name}` ? 0 : -1;
    }
    place.setAttribute("aria-labelledby", `tab-${name}`);
    try {
      if (!made.has(name)) made.set(name, await make(name));
      if (current === name) replace(place, made.get(name)!.element);
    } catch (e) {
      replace(place, h("p", { class: "bad", role: "alert" }, (e as Error).message));
    }
  };
  const list = h("div", { class: "tabs", role: "tablist", "aria-label": run.title }, ...buttons);
  list.addEventListener("keydown", (e) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
    if (!by) return;
    const at = buttons.findIndex((b) => b.id === `tab-${current}`);
    const next = buttons[(at + by + buttons.length) % buttons.length]!;
    next.focus();
    next.click();
  });
  const others = (await api.runs()).filter((r) => r.id !== run.id && r.state === "done");
  const compare = h("select", { "aria-label": t("run.compare"), onChange: () => (location.hash = `#/compare/${encodeURIComponent(run.id)}/${encodeURIComponent(compare.value)}`) },
    h("option", { value: "" }, `${t("run.compare")} …`), ...others.map((r) => h("option", { value: r.id }, r.title)));
  const element = h(
    "div",
    { class: "run" },
    h("div", { class: "bar" }, h("h1", null, run.title), stateBadge(run), h("span", { class: "grow" }), others.length > 0 && compare,
      run.files.includes("scenario.toml") && h("a", { class: "button", href: `#/scenario?run=${encodeURIComponent(run.id)}` }, t("run.again")),
      run.dataset && h("a", { class: "button", href: `#/data/${encodeURIComponent(run.dataset)}` }, t("run.again"))),
    run.state === "failed" && h("p", { class: "bad", role: "alert" }, `${t("run.failed")}: ${run.message}`),
    list,
    place,
  );
  await show(first !== "" && buttons.some((b) => b.id === `tab-${first}`) ? first : run.state === "done" ? "overview" : "log");
  return { title: run.title, element, redraw: () => made.forEach((v) => v.redraw()) };
}

export async function runPage(id: string, tab: string): Promise<Page> {
  const run = await api.run(id);
  if (run.state !== "waiting" && run.state !== "running") return finished(run, tab);
  return whileWorking(run, () => window.dispatchEvent(new HashChangeEvent("hashchange")));
}
