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

function form(study: CommandForm, examples: { name: string; toml: string }[], sets: string[], given: string | null): HTMLElement {
  const start = runButton(
    t("study.run"),
    () => ({ command: study.command, title: title.value.trim() || study.command, settings: options.settings, ...inputOf() }),
    undefined,
    (order) => api.startStudy(order),
  );
  const options = new OptionForm(study.options, () => undefined, () => false, ["general"]);
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
    options.element,
    h("details", null, h("summary", null, t("study.examples")), h("pre", { class: "toml", tabIndex: 0 }, study.examples)),
  );
}
