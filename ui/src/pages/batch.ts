// Several data sets with one profile: what is chosen and set, and the table of their results, worst first.
import { api, type Json, type Run, type RunDetails, type Settings, type Summary } from "../api";
import { h, quietly, replace, saveAs, tell } from "../dom";
import { OptionForm } from "../form";
import { maybe, number, t } from "../i18n";
import { mainOptions } from "../labels";
import { toStartFrom, type Page } from "../page";
import { said } from "../reasons";
import { watchRuns } from "../streams";
import { Desk } from "./desk";
import { partDone } from "./progress";
import { stateBadge } from "./badge";

const tasks = ["process", "gnss", "ahrs", "gravity"] as const;
type Task = (typeof tasks)[number];

/** Which files a data set has is its own matter; a profile holds for all of them. */
const ownMatter = /(^|\.)(file|files|observations|navigation|columns|line|name|base\..*)$/;

function profileOf(settings: Settings): Settings {
  return Object.fromEntries(Object.entries(settings).filter(([key]) => !ownMatter.test(key)));
}

export async function batchPage(query: URLSearchParams): Promise<Page> {
  const [sets, options, commands, runs] = await Promise.all([api.datasets(), api.options("dataset"), api.commands(), api.runs()]);
  const desk = new Desk();
  const wanted = query.get("sets")?.split(",") ?? sets.map((d) => d.name);
  const chosen = new Set(sets.map((d) => d.name).filter((name) => wanted.includes(name)));
  const title = h("input", { type: "text", class: "run-name", value: query.get("title") ?? t("batch.title"), "aria-label": t("batch.name") });
  let task: Task = "process";
  let taskOptions: OptionForm | null = null;
  const begin = async () => {
    try {
      const { batch } = await api.startBatch({
        title: title.value.trim() || t("batch.title"),
        datasets: [...chosen],
        command: task === "ahrs" || task === "gravity" ? task : "run",
        arguments: { ...taskOptions?.settings, ...(task === "gnss" ? { scheme: "gnss" } : {}) },
        settings: profile.settings,
      });
      desk.forget();
      location.hash = `#/batch/${encodeURIComponent(batch)}`;
    } catch (e) {
      tell((e as Error).message, "error");
    }
  };
  const start = h("button", { type: "button", class: "primary run", onClick: () => void begin() });
  const changed = () => {
    start.textContent = `▶ ${t("batch.run", { n: chosen.size })}`;
    desk.changed();
  };
  const profile = new OptionForm(options.filter((o) => !ownMatter.test(o.key)), changed, () => false, [], mainOptions.dataset);
  desk.follow(profile);

  const boxes = sets.map((d) =>
    h("input", {
      type: "checkbox",
      value: d.name,
      checked: chosen.has(d.name),
      onChange: (e: Event) => {
        if ((e.target as HTMLInputElement).checked) chosen.add(d.name);
        else chosen.delete(d.name);
        changed();
      },
    }),
  );
  const all = (on: boolean) => {
    boxes.forEach((box) => ((box.checked = on), on ? chosen.add(box.value) : chosen.delete(box.value)));
    changed();
  };
  const place = h("div");
  const choose = (next: Task, given: Settings = {}) => {
    task = next;
    desk.leave(taskOptions);
    const command = commands.find((c) => c.command === (task === "gnss" ? "process" : task));
    taskOptions = null;
    replace(place);
    if (command && task !== "gnss") {
      taskOptions = new OptionForm(command.options.filter((o) => !["seed", "runs", "response"].includes(o.key)), changed, () => false, ["general"]);
      desk.follow(taskOptions);
      const used: Settings = {};
      for (const o of command.options) if (o.default !== null) used[o.key] = o.default;
      taskOptions.load({ settings: given, used, toml: "", problem: null });
      place.append(h("details", { open: Object.keys(given).length > 0 }, h("summary", null, t("task.options")), taskOptions.element));
    }
    changed();
  };
  const put = (settings: Settings) => {
    for (const key of Object.keys(profile.settings)) profile.put(key, undefined, false);
    for (const [key, value] of Object.entries(settings)) profile.put(key, value as Json, false);
    changed();
  };
  const earlier = runs.filter((r) => r.dataset !== null && r.order);
  const from = h(
    "select",
    {
      "aria-label": t("batch.from_run"),
      onChange: () => {
        if (from.value) void api.runSettings(from.value).then((s) => put(profileOf(s.settings)), (e: Error) => tell(e.message, "error"));
      },
    },
    h("option", { value: "" }, `${t("batch.from_run")} …`),
    ...earlier.slice(0, 100).map((r) => h("option", { value: r.id }, r.batch ? `${r.batch}: ${r.title}` : r.title)),
  );
  const load = () => {
    const input = h("input", { type: "file", accept: ".toml" });
    input.onchange = async () => {
      const text = await input.files?.[0]?.text();
      if (text === undefined) return;
      try {
        const now = await api.settings("dataset", { toml: text });
        if (now.problem) tell(`${now.problem.text}; ${now.problem.mend}`, "error");
        else put(profileOf(now.settings));
      } catch (e) {
        tell((e as Error).message, "error");
      }
    };
    input.click();
  };
  const choices = tasks.map((name) => h("input", { type: "radio", name: "task", value: name, checked: name === task, onChange: () => choose(name) }));
  profile.load({ settings: {}, used: {}, toml: "", problem: null });
  choose("process");
  desk.begin({
    form: profile,
    title,
    start,
    of: "dataset",
    more: () => ({ sets: [...chosen].sort(), task, options: { ...taskOptions?.settings } }),
    reason: () => (chosen.size === 0 ? t("batch.none") : ""),
  });
  const draft = desk.draft;
  if (draft) {
    const more = draft.more as { sets: string[]; task: Task; options: Settings };
    title.value = draft.title;
    profile.load({ settings: draft.settings, used: {}, toml: "", problem: null });
    chosen.clear();
    boxes.forEach((box) => ((box.checked = more.sets.includes(box.value)), box.checked && chosen.add(box.value)));
    choices.forEach((c) => (c.checked = c.value === more.task));
    choose(more.task, more.options);
  } else if (query.get("run")) void api.runSettings(query.get("run")!).then((s) => put(profileOf(s.settings)), () => undefined);
  void desk.judge();
  const element = h(
    "div",
    { class: "editor batch" },
    h("div", { class: "bar" }, h("h1", null, t("batch.title")), title, start),
    h("p", { class: "lead" }, t("batch.lead")),
    desk.problem,
    draft && desk.restored(),
    desk.obstacle,
    h(
      "section",
      { class: "card" },
      h("h2", null, t("start.datasets")),
      sets.length === 0
        ? h("p", { class: "muted" }, t("batch.no_sets"), " ", h("a", { href: "#/" }, t("nav.start")))
        : h(
            "p",
            { class: "form-tools" },
            h("button", { type: "button", onClick: () => all(true) }, t("batch.all")),
            h("button", { type: "button", onClick: () => all(false) }, t("batch.nothing")),
          ),
      h(
        "ul",
        { class: "plain-list batch-sets" },
        ...sets.map((d, i) => h("li", null, h("label", null, boxes[i]!, ` ${d.title}`), h("span", { class: "muted" }, ` ${t("start.n_files", { n: d.files.length })}`))),
      ),
    ),
    h(
      "section",
      { class: "card tasks" },
      h("h2", null, t("task.title")),
      h(
        "div",
        { class: "task-list", role: "radiogroup", "aria-label": t("task.title") },
        ...tasks.map((name, i) =>
          h(
            "label",
            { class: "task" },
            choices[i]!,
            h("span", null, h("strong", null, t(`task.${name}`)), h("span", { class: "muted" }, t(`task.${name}_what`))),
          ),
        ),
      ),
      place,
    ),
    h(
      "section",
      { class: "card" },
      h("h2", null, t("batch.profile")),
      h("p", { class: "muted" }, t("batch.profile_what")),
      h("p", { class: "form-tools" }, earlier.length > 0 && from, h("button", { type: "button", onClick: load }, t("editor.load"))),
      profile.element,
    ),
  );
  return { title: t("batch.title"), element };
}

/** As the table of `schuler batch`: failed, do not use, care, trustworthy, and the larger error first. */
function rank(run: Run): number {
  if (run.state !== "done") return run.state === "failed" || run.state === "cancelled" ? 0 : 4;
  return run.verdict === "do not use" ? 1 : run.verdict === "care" ? 2 : 3;
}

interface Figures {
  horizontal: number | null;
  largest: number | null;
  heading: number | null;
  check: number | null;
  rejected: number | null;
  why: string;
}

function figuresOf(run: Run, summary: Summary | null): Figures {
  const spread = (group: string, axis: string) => (summary?.errors?.[group]?.[axis] ?? null) as { rms: number | null; max: number | null } | null;
  const check = (summary?.self_check as Record<string, number | null> | null | undefined)?.["end_rms_m"];
  return {
    horizontal: spread("position_m", "horizontal")?.rms ?? null,
    largest: spread("position_m", "horizontal")?.max ?? null,
    heading: spread("attitude_deg", "heading")?.rms ?? null,
    check: check ?? null,
    rejected: summary?.gnss?.rejected ?? null,
    why: run.state === "done" ? (run.verdict === "trustworthy" ? "" : (summary?.verdict?.reasons[0] ?? "")) : run.message,
  };
}

export async function batchTablePage(batch: string): Promise<Page> {
  const summaries = new Map<string, Summary | null>();
  const place = h("div");
  const progress = new Map<string, number>();
  let rows: { run: Run; figures: Figures }[] = [];
  let drawn = "";
  const figures: [string, (row: (typeof rows)[number]) => number | null][] = [
    [`${t("run.duration")}, s`, ({ run }) => run.duration_s],
    [t("batch.horizontal"), ({ figures: f }) => f.horizontal],
    [t("table.max_h"), ({ figures: f }) => f.largest],
    [t("batch.heading"), ({ figures: f }) => f.heading],
    [`${t("batch.check")}, m`, ({ figures: f }) => f.check],
    [t("batch.rejected"), ({ figures: f }) => f.rejected],
  ];
  const cells = ({ run, figures: f }: (typeof rows)[number]): (number | string | null)[] => [
    run.dataset ?? run.title,
    run.state,
    run.verdict ?? "",
    run.duration_s,
    f.horizontal,
    f.largest,
    f.heading,
    f.check,
    f.rejected,
    f.why,
    run.note,
  ];
  const csv = () => {
    const names = ["dataset", "state", "verdict", "duration_s", "horizontal_rms_m", "horizontal_max_m", "heading_rms_deg", "self_check_rms_m", "gnss_rejected", "why", "note"];
    const quoted = (v: number | string | null) => (v === null ? "" : typeof v === "number" ? String(v) : /[",\n]/.test(v) ? `"${v.replaceAll('"', '""')}"` : v);
    return [names.join(","), ...rows.map((r) => cells(r).map(quoted).join(","))].join("\n") + "\n";
  };
  const draw = () => {
    const busy = rows.filter(({ run }) => run.state === "running" || run.state === "waiting");
    const done = rows.filter(({ run }) => run.state === "done");
    const failed = rows.filter(({ run }) => run.state === "failed" || run.state === "cancelled").length;
    const bad = done.filter(({ run }) => run.verdict === "do not use").length;
    const first = rows.find(({ run }) => run.order);
    // a column without a number, as errors without a reference, is left out
    const columns = figures.filter(([, value]) => rows.some((row) => value(row) !== null));
    const noted = rows.some(({ run }) => run.note !== "");
    const head = [t("data.title"), t("run.state"), t("quality.verdict"), ...columns.map(([name]) => name), t("batch.why"), ...(noted ? [t("note")] : [])];
    replace(
      place,
      h(
        "div",
        { class: "bar" },
        h("h1", null, `${t("batch.title")}: ${batch}`),
        h("span", { class: "grow" }),
        done.length > 1 && h("a", { class: "button", href: `#/compare/${done.slice(0, 9).map(({ run }) => encodeURIComponent(run.id)).join("/")}` }, t("start.compare")),
        first && h("a", { class: "button", href: `#/batch?run=${encodeURIComponent(first.run.id)}&sets=${rows.map(({ run }) => encodeURIComponent(run.dataset ?? "")).join(",")}&title=${encodeURIComponent(batch)}` }, t("run.again")),
        h("button", { type: "button", onClick: () => saveAs(new Blob([csv()], { type: "text/csv" }), "batch.csv") }, "CSV"),
        busy.length > 0 && h("button", { type: "button", onClick: () => void Promise.allSettled(busy.map(({ run }) => api.cancel(run.id))).then(refresh) }, t("batch.cancel")),
        busy.length === 0 &&
          h(
            "button",
            {
              type: "button",
              onClick: () => {
                if (confirm(t("batch.remove_sure", { n: rows.length, name: batch })))
                  void Promise.allSettled(rows.map(({ run }) => api.remove(run.id))).then(toStartFrom(location.hash));
              },
            },
            t("batch.remove"),
          ),
      ),
      h("p", { class: "lead", role: "status" }, t("batch.state", { n: rows.length, busy: busy.length, failed, bad })),
      h(
        "div",
        { class: "scroll", tabIndex: 0 },
        h(
          "table",
          { class: "runs batch-table" },
          h("thead", null, h("tr", null, ...head.map((x, i) => h("th", { scope: "col", class: i > 2 && i < 3 + columns.length ? "figure" : "" }, x)))),
          h(
            "tbody",
            null,
            ...rows.map((row) => {
              const { run, figures: f } = row;
              return h(
                "tr",
                { "data-run": run.id },
                h("th", { scope: "row" }, h("a", { href: `#/run/${encodeURIComponent(run.id)}` }, run.dataset ?? run.title)),
                h("td", { class: "state" }, run.state === "running" ? h("progress", { max: 1, value: progress.get(run.id) ?? run.progress ?? 0, "aria-label": t("state.running") }) : stateBadge(run)),
                h("td", { class: `word ${run.verdict === "trustworthy" ? "good" : run.verdict === "do not use" ? "poor" : ""}` }, run.verdict ? maybe(`verdict.${run.verdict}`, run.verdict) : "–"),
                ...columns.map(([, value]) => h("td", { class: "figure" }, number(value(row), 3))),
                h("td", { class: "why" }, said(f.why)),
                noted && h("td", { class: "why" }, run.note),
              );
            }),
          ),
        ),
      ),
    );
  };
  const refresh = async () => {
    const runs = (await api.runs()).filter((r) => r.batch === batch);
    if (runs.length === 0) throw new Error(t("batch.gone"));
    await Promise.all(
      runs.filter((r) => r.state === "done" && !summaries.has(r.id)).map(async (r) => summaries.set(r.id, (await api.run(r.id).catch(() => null as RunDetails | null))?.summary ?? null)),
    );
    rows = runs.map((run) => ({ run, figures: figuresOf(run, summaries.get(run.id) ?? null) }));
    const size = ({ figures: f }: (typeof rows)[number]) => f.horizontal ?? f.check ?? -1;
    rows.sort((a, b) => rank(a.run) - rank(b.run) || size(b) - size(a) || (a.run.dataset ?? "").localeCompare(b.run.dataset ?? ""));
    // drawn anew only where something changed: the focus of the keyboard stays
    const now = JSON.stringify(rows.map(({ run: { progress: _, ...rest }, figures }) => [rest, figures]));
    if (now !== drawn) draw();
    drawn = now;
  };
  await refresh();
  const again = quietly(150, () => void refresh().catch(() => undefined));
  const stop = watchRuns((e) => {
    if (!rows.some(({ run }) => run.id === e.id)) return;
    const part = partDone(e);
    if (part !== null) progress.set(e.id, part);
    const bar = place.querySelector<HTMLProgressElement>(`tr[data-run="${CSS.escape(e.id)}"] progress`);
    if (!bar || e.state !== "running") return again();
    if (part === null) bar.removeAttribute("value");
    else bar.value = part;
  });
  // an event that was missed while the page was being made is made up for
  const timer = window.setInterval(() => rows.some(({ run }) => run.state === "running" || run.state === "waiting") && again(), 3000);
  return { title: batch, element: place, close: () => (stop(), window.clearInterval(timer)) };
}
