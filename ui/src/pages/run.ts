// One run: live while it works, then its views.
import { api, type Group, type RunDetails } from "../api";
import { append, h, icon, idle, replace, saveAs, tell as say } from "../dom";
import { t } from "../i18n";
import { toStartFrom, type Page } from "../page";
import { said } from "../reasons";
import { watchRuns, type RunEvent } from "../streams";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors, stacked } from "../plots/timeplot";
import { ensembleView } from "./ensemble";
import { happenings, marksOf, type Happening } from "./events";
import { gravityView } from "./gravity";
import { noiseView } from "./noise";
import { documentView } from "./document";
import { partDone, progressWords } from "./progress";
import { qualityView } from "./quality";
import { skyView } from "./sky";
import { signalsView } from "./signals";
import { stateBadge } from "./badge";
import { trackView, type View } from "./track";
import { tableView } from "./values";
import { errorPlots, innovationPlots, motionPlots, sensorPlots } from "./views";

function plotsView(plots: TimePlot[], linked: Linked, note = ""): View {
  linkCursors(plots, linked);
  const element = h(
    "div",
    null,
    note && h("p", { class: "muted" }, note),
    plots.length === 0 && h("p", { class: "muted" }, t("plot.empty")),
    h("div", { class: "plots" }, ...stacked(plots)),
  );
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}

async function whileWorking(run: RunDetails, done: () => void): Promise<Page> {
  const bar = h("progress", { max: 1, "aria-label": t("run.working") });
  const log = h("pre", { class: "log", tabIndex: 0 });
  const words = h("p", { role: "status" });
  const tell = (e: RunEvent) => {
    const part = partDone(e);
    if (part === null) bar.removeAttribute("value");
    else bar.value = part;
    words.textContent = progressWords(e);
  };
  tell({ id: run.id, state: run.state, progress: run.progress ?? 0, stage: run.stage ?? "", spent_s: run.spent_s ?? 0, message: "" });
  let over = false;
  const ended = (state: RunDetails["state"]) => {
    if (over || state === "waiting" || state === "running") return;
    over = true;
    done();
  };
  // a short run may have ended before anyone listened, and a stream of events may break off: the state is asked for as well
  const refresh = async () => {
    log.textContent = await api.log(run.id);
    ended((await api.run(run.id)).state);
  };
  const timer = window.setInterval(() => void refresh().catch(() => undefined), 1500);
  const stop = watchRuns((e: RunEvent) => {
    if (e.id !== run.id) return;
    tell(e);
    ended(e.state);
  });
  void refresh().catch(() => undefined);
  const element = h(
    "div",
    null,
    h("h1", null, run.title),
    h(
      "section",
      { class: "card" },
      words,
      bar,
      h(
        "p",
        null,
        h(
          "button",
          { type: "button", onClick: () => void api.cancel(run.id).catch((e: Error) => say(e.message, "error")) },
          t("run.cancel"),
        ),
      ),
      h("h2", null, t("run.log")),
      log,
    ),
  );
  return { title: run.title, element, close: () => ((over = true), stop(), window.clearInterval(timer)) };
}

const tabs = [
  "overview",
  "document",
  "ensemble",
  "gravity",
  "track",
  "errors",
  "sensors",
  "innovations",
  "sky",
  "motion",
  "signals",
  "noise",
  "table",
  "report",
  "log",
] as const;

/** A comparison of couplings, or a study: numbers of its own, no trajectory. */
export function isDocument(run: RunDetails): boolean {
  return run.summary !== null && (run.kind === "study" || run.summary.schemes !== undefined);
}

/** Of fewer samples the program makes no Allan deviation. */
const fewestForAllan = 64;

/** Whether a run has what a tab shows. */
function shown(tab: (typeof tabs)[number], run: RunDetails, groups: Group[]): boolean {
  const has = (start: string) => groups.some((g) => g.group.startsWith(start));
  switch (tab) {
    case "track":
    case "motion":
      return has("/solution");
    case "errors":
      return has("/errors") || has("/solution");
    case "sensors":
      return has("/sensor_errors");
    case "innovations":
    case "sky":
    case "gravity":
    case "ensemble":
      return has(`/${tab}`);
    case "signals":
    case "table":
      return groups.length > 0;
    case "overview":
      return !isDocument(run);
    case "document":
      return isDocument(run);
    case "noise":
      return run.kind !== "montecarlo" && run.kind !== "study" && !isDocument(run) && run.state === "done" && (run.summary?.imu?.epochs ?? 0) >= fewestForAllan && (run.files.includes("scenario.toml") || run.files.includes("settings.toml"));
    case "report":
      return run.files.includes("report.html");
    default:
      return true;
  }
}

async function finished(run: RunDetails, groups: Group[], first: string): Promise<Page> {
  // the list of all runs is for comparisons alone: neither the run nor the server waits for it
  const others = idle().then(() => api.runs()).then(
    (all) => all.filter((r) => r.id !== run.id && r.state === "done"),
    () => [],
  );
  const stops = groups.map((g) => g.stop_s).filter((x): x is number => x !== null);
  const linked = new Linked(0, Math.max(1e-3, ...stops));
  linked.spans = (run.summary?.outages ?? []).map((o) => ({
    from: o.start_s,
    to: o.start_s + o.duration_s,
    label: t("outage.title"),
  }));
  const place = h("div", { class: "view", role: "tabpanel", id: "view", tabIndex: 0 });
  const made = new Map<string, View>();
  // what happened is marked on every axis of time, whichever view is opened first
  let happened: Promise<Happening[]> | null = null;
  const events = () =>
    (happened ??= idle().then(() => happenings(run, groups)).then((all) => {
      linked.marks = marksOf(all);
      if (linked.marks.length > 0) made.forEach((v) => v.redraw());
      return all;
    }));
  let current = "";
  const make = async (name: string): Promise<View> => {
    const plain = (element: HTMLElement): View => ({ element, redraw: () => undefined });
    switch (name) {
      case "track":
        return trackView(run.id, groups, linked);
      case "errors":
        return plotsView(
          errorPlots(run.id, groups, linked),
          linked,
          groups.some((g) => g.group === "/errors") ? "" : t("view.no_reference"),
        );
      case "sensors":
        return plotsView(sensorPlots(run.id, groups, linked), linked);
      case "innovations":
        return plotsView(innovationPlots(run.id, groups, linked), linked);
      case "sky":
        return skyView(run.id, groups, linked);
      case "gravity":
        return gravityView(run, groups, linked);
      case "ensemble":
        return ensembleView(run, groups, linked);
      case "noise":
        replace(place, h("p", { class: "muted" }, t("noise.wait")));
        return noiseView("runs", run.id);
      case "motion":
        return plotsView(motionPlots(run.id, groups, linked), linked);
      case "signals":
        return signalsView(run.id, groups, linked);
      case "document":
        return documentView(run.summary as never);
      case "table":
        return tableView(run.id, groups, linked);
      case "report": {
        const url = api.fileUrl(run.id, "report.html");
        return plain(
          h(
            "div",
            null,
            h(
              "p",
              null,
              h("a", { href: url, target: "_blank", rel: "noopener" }, t("run.print")),
              " · ",
              h("a", { href: api.fileUrl(run.id, "report.html", true) }, "report.html"),
            ),
            h("iframe", { class: "report", src: url, title: t("run.report") }),
          ),
        );
      }
      case "log": {
        const text = await api.log(run.id);
        return plain(
          h(
            "div",
            null,
            h("button", { type: "button", onClick: () => saveAs(new Blob([text]), "log.txt") }, "log.txt"),
            h("pre", { class: "log", tabIndex: 0 }, text),
          ),
        );
      }
      default:
        return qualityView(run, groups, linked, others, events());
    }
  };
  const buttons = tabs
    .filter((name) => shown(name, run, groups))
    .map((name) =>
      h(
        "button",
        { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": "view", onClick: () => void show(name) },
        t(`tab.${name}`),
      ),
    );
  const show = async (name: string) => {
    current = name;
    history.replaceState(null, "", `#/run/${encodeURIComponent(run.id)}/${name}`);
    for (const b of buttons) {
      b.setAttribute("aria-selected", String(b.id === `tab-${name}`));
      b.tabIndex = b.id === `tab-${name}` ? 0 : -1;
    }
    place.setAttribute("aria-labelledby", `tab-${name}`);
    delete place.dataset.tab;
    try {
      if (!made.has(name)) made.set(name, await make(name));
      if (current === name) {
        replace(place, made.get(name)!.element);
        place.dataset.tab = name;
      }
    } catch (e) {
      if (current !== name) return;
      place.dataset.tab = name;
      replace(place, h("p", { class: "bad", role: "alert" }, (e as Error).message));
    }
  };
  const title = h("h1", null, run.title);
  const note = h("p", { class: "run-note" });
  const write = () => ((note.textContent = run.note), (note.hidden = run.note === ""));
  write();
  const tool = (sign: string | Node, name: string, action: () => void) =>
    h("button", { type: "button", class: "icon", title: name, "aria-label": `${name}: ${run.title}`, onClick: action }, sign);
  const list = h("div", { class: "tabs", role: "tablist", "aria-label": run.title }, ...buttons);
  list.addEventListener("keydown", (e) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
    if (!by) return;
    const at = buttons.findIndex((b) => b.id === `tab-${current}`);
    const next = buttons[(at + by + buttons.length) % buttons.length]!;
    next.focus();
    next.click();
  });
  const compare = h(
    "select",
    {
      "aria-label": t("run.compare"),
      hidden: true,
      onChange: () => (location.hash = `#/compare/${encodeURIComponent(run.id)}/${encodeURIComponent(compare.value)}`),
    },
    h("option", { value: "" }, `${t("run.compare")} …`),
  );
  void others.then((all) => {
    append(compare, ...all.map((r) => h("option", { value: r.id }, r.title)));
    compare.hidden = all.length === 0;
  });
  const element = h(
    "div",
    { class: "run", "data-run": run.id },
    h(
      "div",
      { class: "bar" },
      title,
      stateBadge(run),
      h("span", { class: "grow" }),
      run.batch && h("a", { class: "button", href: `#/batch/${encodeURIComponent(run.batch)}` }, `${t("batch.title")}: ${run.batch}`),
      compare,
      run.files.includes("scenario.toml") &&
        h("a", { class: "button", href: `#/scenario?run=${encodeURIComponent(run.id)}` }, t("run.again")),
      run.dataset &&
        run.files.includes("settings.toml") &&
        h("a", { class: "button", href: `#/data/${encodeURIComponent(run.dataset)}?run=${encodeURIComponent(run.id)}` }, t("run.again")),
      run.command === "receiver generate" &&
        run.state === "done" &&
        h("a", { class: "button", href: `#/studies/${encodeURIComponent("receiver track")}?recording=${encodeURIComponent(run.id)}` }, t("study.track")),
      tool("✎", t("rename"), () => {
        const name = prompt(t("rename"), run.title);
        if (name) void api.rename(run.id, name).then(() => ((run.title = name), (title.textContent = name)));
      }),
      tool(icon("note"), t("note.edit"), () => {
        const text = prompt(t("note.edit"), run.note);
        if (text !== null) void api.annotate(run.id, text).then(() => ((run.note = text), write()), (e: Error) => say(e.message, "error"));
      }),
      tool("✕", t("remove"), () => {
        if (confirm(t("remove.sure", { name: run.title }))) void api.remove(run.id).then(toStartFrom(location.hash));
      }),
    ),
    note,
    run.state === "failed" && h("p", { class: "bad", role: "alert" }, `${t("run.failed")}: ${said(run.message)}`),
    list,
    place,
  );
  const view = first !== "" && buttons.some((b) => b.id === `tab-${first}`) ? first : run.state === "done" ? (isDocument(run) ? "document" : "overview") : "log";
  await show(view);
  if (groups.length > 0) void events().catch(() => undefined);
  return { title: run.title, element, redraw: () => made.forEach((v) => v.redraw()) };
}

export async function runPage(id: string, tab: string): Promise<Page> {
  const { channels, ...run } = await api.runWithChannels(id);
  if (run.state !== "waiting" && run.state !== "running") return finished(run, channels, tab);
  return whileWorking(run, () => window.dispatchEvent(new HashChangeEvent("hashchange")));
}
