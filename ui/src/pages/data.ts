// A data set: what is in its files, what is doubtful, its settings as a form, and the way to a run.
import { api, type Inspection, type Settings } from "../api";
import { h, replace, saveAs } from "../dom";
import { OptionForm } from "../form";
import { number, t } from "../i18n";
import { mainOptions } from "../labels";
import type { Page } from "../page";
import { said } from "../reasons";
import { OutageLine } from "../plots/timeline";
import { Desk } from "./desk";
import { noiseView } from "./noise";
import { runButton } from "./runbutton";
import { rawCard, rawSignals } from "./raw";
import { TaskChoice, type TaskState } from "./tasks";

function problems(list: Inspection["problems"]): HTMLElement {
  const icon = { error: "✗", warning: "⚠", info: "ℹ" };
  return h(
    "ul",
    { class: "problems" },
    ...list.map((p) =>
      h("li", { class: p.level }, h("strong", null, `${icon[p.level]} ${said(p.text)}`), p.mend && h("span", null, ` — ${said(p.mend)}`)),
    ),
  );
}

function files(found: Inspection): HTMLElement {
  const head = [
    t("data.file"),
    t("data.kind"),
    t("data.rows"),
    `${t("data.rate")}, Hz`,
    t("data.gaps"),
    t("data.doubled"),
    `${t("data.span")}, s`,
  ];
  return h(
    "div",
    { class: "scroll", tabIndex: 0 },
    h(
      "table",
      null,
      h("thead", null, h("tr", null, ...head.map((x, i) => h("th", { scope: "col", class: i > 1 ? "figure" : "" }, x)))),
      h(
        "tbody",
        null,
        ...found.files.flatMap((f) =>
          [
            h(
              "tr",
              null,
              h("td", null, f.path),
              h("td", null, h("span", { class: `badge ${f.kind === "unknown" ? "failed" : "done"}` }, f.kind)),
              ...[f.rows, f.rate_hz, f.gaps, f.duplicates].map((x) => h("td", { class: "figure" }, number(x, 6))),
              h("td", { class: "figure" }, f.start_s !== null && f.stop_s !== null ? number(f.stop_s - f.start_s, 6) : "–"),
            ),
            f.problems.length > 0 && h("tr", null, h("td", { colSpan: 7 }, problems(f.problems))),
          ].filter((x): x is HTMLTableRowElement => x !== false),
        ),
      ),
    ),
  );
}

function findings(found: Inspection): HTMLElement {
  const sorted = [...found.findings].sort((a, b) => a.confidence - b.confidence);
  return h(
    "div",
    { class: "scroll", tabIndex: 0 },
    h(
      "table",
      { class: "findings" },
      h(
        "thead",
        null,
        h(
          "tr",
          null,
          ...[t("data.what"), t("data.value"), t("data.how_sure"), t("data.why")].map((x) => h("th", { scope: "col" }, x)),
        ),
      ),
      h(
        "tbody",
        null,
        ...sorted.map((f) =>
          h(
            "tr",
            { class: f.confidence < 0.9 ? "doubtful" : "" },
            h("td", null, h("code", null, f.key)),
            h("td", null, f.value),
            h(
              "td",
              null,
              h("meter", {
                min: 0,
                max: 1,
                low: 0.6,
                high: 0.9,
                optimum: 1,
                value: f.confidence,
                "aria-label": t("data.how_sure"),
              }),
              ` ${f.confidence < 0.9 ? "⚠ " : ""}${Math.round(100 * f.confidence)} %`,
            ),
            h("td", null, said(f.why)),
          ),
        ),
      ),
    ),
  );
}

export async function dataPage(name: string, query: URLSearchParams): Promise<Page> {
  const from = query.get("run");
  const [options, found, commands, again, before] = await Promise.all([
    api.options("dataset"),
    api.inspect(name),
    api.commands(),
    from ? api.run(from) : null,
    from ? api.runSettings(from) : null,
  ]);
  // What was found out stays a finding: only what is changed here is given to the run, or its guesses would count as yours.
  const base = { ...found.form.settings };
  const changes = (of: Settings): Settings => Object.fromEntries(Object.entries(of).filter(([k, v]) => JSON.stringify(v) !== JSON.stringify(base[k])));
  // a run's own settings over those of the data set
  if (before) found.form = { ...before, settings: { ...base, ...before.settings } };
  const desk = new Desk();
  const toml = h("pre", { class: "toml", tabIndex: 0 }, found.form.toml);
  // settings of the run over those of the data set
  const form = new OptionForm(options, () => desk.changed(), (key) => key === "outage", [], mainOptions.dataset);
  desk.follow(form);
  const gnss = found.files.filter((f) => f.provides.includes("fixes"));
  const length = Math.max(0, ...(gnss.length > 0 ? gnss : found.files).map((f) => (f.stop_s ?? 0) - (f.start_s ?? 0))) || 600;
  const outages = new OutageLine((list) =>
    form.put(
      "outage",
      list.map((o) => ({ ...o })),
    ),
  );
  const title = h("input", { type: "text", class: "run-name", value: again?.title ?? found.path, "aria-label": t("run.title") });
  const start: HTMLButtonElement = runButton(
    t("data.run"),
    () => ({
      kind: "dataset",
      dataset: name,
      title: title.value.trim() || name,
      settings: tasks.settings(changes(form.settings), form.settings),
      ...tasks.order,
    }),
    () => desk.forget(),
    (order) => tasks.start(order),
  );
  const order = again?.order;
  const scheme = found.form.settings["filter.scheme"];
  const tasks: TaskChoice = new TaskChoice(found, commands, () => desk.changed(), length, {
    task: order && order.command !== "run" ? order.command : "base.observations" in found.form.settings ? "ppk" : scheme === "gnss" ? "gnss" : "process",
    arguments: order?.arguments ?? {},
  });
  form.load(found.form);
  desk.begin({
    form,
    title,
    start,
    of: "dataset",
    more: () => tasks.state,
    reason: () => tasks.obstacle,
    understood: (now) => (toml.textContent = now.toml),
  });
  desk.show(found.form);
  const draft = desk.draft;
  if (draft) {
    title.value = draft.title;
    form.load({ ...found.form, settings: draft.settings });
    tasks.take((draft.more ?? {}) as TaskState);
    void desk.judge();
  }
  form.doubts(found.findings);
  outages.show((form.settings["outage"] as never) ?? [], length);
  // asked for only when it is opened: the whole log is read for it
  const noise = h("details", { class: "card" }, h("summary", null, t("noise.title")));
  let view: { redraw: () => void } | null = null;
  noise.addEventListener("toggle", () => {
    if (!noise.open || noise.children.length > 1) return;
    const wait = h("p", { class: "muted" }, t("noise.wait"));
    noise.append(wait);
    void noiseView("datasets", name).then(
      (v) => {
        view = v;
        wait.replaceWith(v.element);
      },
      (e: Error) => (wait.textContent = e.message),
    );
  });
  const doubts = found.findings.filter((f) => f.confidence < 0.9).length;
  const element = h(
    "div",
    { class: "editor" },
    h(
      "div",
      { class: "bar" },
      h("h1", null, `${t("data.title")}: ${name}`),
      title,
      start,
      h("button", { type: "button", onClick: () => saveAs(new Blob([toml.textContent ?? ""]), "dataset.toml") }, t("data.save")),
    ),
    desk.problem,
    draft && desk.restored(),
    desk.obstacle,
    tasks.element,
    h(
      "details",
      { class: "card", open: found.files.length <= 8 || found.problems.length > 0 },
      h("summary", null, `${t("data.files")} (${found.files.length})`),
      files(found),
      found.problems.length > 0 && problems(found.problems),
    ),
    h(
      "details",
      { class: "card" },
      h("summary", null, `${t("data.findings")} (${found.findings.length}): ${doubts > 0 ? t("data.doubts", { n: doubts }) : t("data.no_doubts")}`),
      findings(found),
    ),
    rawCard(name, found),
    rawSignals(name, found),
    noise,
    outages.element,
    h(
      "div",
      { class: "split" },
      h(
        "div",
        { class: "left" },
        h("h2", null, t("data.settings")),
        h("p", { class: "muted" }, t(found.own_toml ? "data.own" : "data.inferred")),
        form.element,
      ),
      h("div", { class: "right" }, h("details", { class: "card" }, h("summary", null, "dataset.toml"), toml)),
    ),
  );
  replace(element, ...[...element.children]);
  return { title: name, element, redraw: () => (outages.draw(), view?.redraw()) };
}
