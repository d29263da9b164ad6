// The studies of the program: a form of each, made of the option table, and the way to a run.
import { api, type CommandForm, type Settings } from "../api";
import { h, replace } from "../dom";
import { OptionForm } from "../form";
import { maybe, t } from "../i18n";
import type { Page } from "../page";
import { runButton } from "./runbutton";

export async function studiesPage(query: URLSearchParams, name: string): Promise<Page> {
  const [studies, examples, sets] = await Promise.all([api.studies(), api.examples(), api.datasets()]);
  const chosen = studies.find((s) => s.command === name) ?? null;
  const list = h(
    "ul",
    { class: "examples" },
    ...studies.map((s) =>
      h(
        "li",
        null,
        h(
          "a",
          { href: `#/studies/${encodeURIComponent(s.command)}`, "aria-current": s === chosen ? "page" : undefined },
          h("strong", null, s.command.replace("analyze ", "")),
          h("span", null, maybe(`study.${s.command.replace("analyze ", "")}`, s.purpose)),
        ),
      ),
    ),
  );
  const place = h("div");
  const element = h("div", { class: "studies" }, h("h1", null, t("study.title")), list, place);
  if (chosen) replace(place, form(chosen, examples, sets.map((d) => d.name), query.get("dataset")));
  return { title: t("study.title"), element };
}

/** The items of the chosen paper; a click puts one into the form. */
function paperItems(options: OptionForm, place: HTMLElement): () => void {
  let papers: Awaited<ReturnType<typeof api.papers>> = [];
  let drawn = "";
  const draw = () => {
    const letter = String(options.settings["paper"] ?? "A");
    const chosen = String(options.settings["item"] ?? "");
    if (papers.length === 0 || drawn === `${letter} ${chosen}`) return;
    drawn = `${letter} ${chosen}`;
    const choice = h(
      "select",
      { "aria-label": t("study.of_paper"), onChange: () => (options.put("item", undefined, false), options.put("paper", choice.value)) },
      ...papers.map((p) => h("option", { value: p.paper }, `${t("study.of_paper")} ${p.paper}`)),
    );
    choice.value = letter;
    const take = (item: string) => (options.put("paper", letter, false), options.put("item", item));
    replace(
      place,
      h("p", { class: "form-tools" }, choice),
      h(
        "div",
        { class: "scroll paper-items", tabIndex: 0 },
        h(
          "table",
          null,
          h("thead", null, h("tr", null, ...["item", "page", "numbers", "takes", "what"].map((k) => h("th", { scope: "col" }, t(`study.item.${k}`))))),
          h(
            "tbody",
            null,
            ...(papers.find((p) => p.paper === letter)?.items ?? []).map((i) =>
              h(
                "tr",
                { class: i.item === chosen ? "doubtful" : "" },
                h("th", { scope: "row" }, h("button", { type: "button", class: "link", "aria-pressed": String(i.item === chosen), onClick: () => take(i.item) }, i.item)),
                h("td", null, i.page),
                h("td", { class: "figure" }, String(i.printed_numbers)),
                h("td", null, i.runs > 0 ? t("study.item.runs", { n: i.runs, s: Math.ceil(i.seconds) }) : `${Math.ceil(i.seconds)} s`),
                h("td", null, i.what),
              ),
            ),
          ),
        ),
      ),
    );
  };
  void api.papers().then(
    (all) => {
      papers = all;
      if (!("paper" in options.settings)) options.put("paper", all[0]?.paper ?? "A", false);
      draw();
    },
    (e: Error) => replace(place, h("p", { class: "bad", role: "alert" }, e.message)),
  );
  return draw;
}

function form(study: CommandForm, examples: { name: string; toml: string }[], sets: string[], given: string | null): HTMLElement {
  const start = runButton(
    t("study.run"),
    () => ({ command: study.command, title: title.value.trim() || study.command, settings: options.settings, ...inputOf() }),
    undefined,
    (order) => api.startStudy(order),
  );
  const options = new OptionForm(study.options, () => items?.(), () => false, ["general"]);
  const list = h("div");
  const items = study.command === "paper" ? paperItems(options, list) : null;
  options.judged = (wrong) => {
    start.disabled = wrong > 0;
    start.title = wrong > 0 ? t("form.mend_first") : "";
  };
  const used: Settings = {};
  for (const o of study.options) if (o.default !== null) used[o.key] = o.default;
  options.load({ settings: {}, used, toml: "", problem: null });
  const title = h("input", { type: "text", class: "run-name", value: study.command.replace("analyze ", ""), "aria-label": t("run.title") });
  const needs = study.input !== null && study.input !== undefined;
  // what a study can work on is said by its help: a scenario, a data set, or both
  const takesData = needs && /folder|data ?set|log/i.test(study.input!);
  const takesScenario = needs && /scenario/i.test(study.input!);
  const input = h(
    "select",
    { "aria-label": t("study.input") },
    ...(takesScenario || !takesData ? examples.map((e) => h("option", { value: `example:${e.name}` }, `${t("nav.scenario")}: ${e.name}`)) : []),
    ...(takesData ? sets.map((d) => h("option", { value: `data:${d}` }, `${t("data.title")}: ${d}`)) : []),
  );
  if (given) input.value = `data:${given}`;
  const inputOf = (): Record<string, unknown> => {
    if (!needs) return {};
    const [kind, ...rest] = input.value.split(":");
    const name = rest.join(":");
    return kind === "data" ? { dataset: name } : { scenario: { toml: examples.find((e) => e.name === name)?.toml ?? "" } };
  };
  return h(
    "section",
    { class: "card" },
    h("h2", null, study.command.replace("analyze ", "")),
    h("p", { class: "muted" }, study.purpose),
    h("div", { class: "bar" }, title, needs && h("label", null, t("study.input"), " ", input), start),
    needs && h("p", { class: "muted" }, study.input ?? ""),
    list,
    options.element,
    h("details", null, h("summary", null, t("study.examples")), h("pre", { class: "toml", tabIndex: 0 }, study.examples)),
  );
}
