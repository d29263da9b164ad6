// The studies of the program: a form of each, made of the option table, and the way to a run.
import { api, type CommandForm, type DatasetInfo, type Run, type Settings } from "../api";
import { h, replace } from "../dom";
import { OptionForm, labelOf } from "../form";
import { maybe, t } from "../i18n";
import type { Page } from "../page";
import { Desk } from "./desk";
import { runButton } from "./runbutton";

export async function studiesPage(query: URLSearchParams, name: string): Promise<Page> {
  const [studies, examples, sets, runs] = await Promise.all([api.studies(), api.examples(), api.datasets(), api.runs()]);
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
  const place = h("div", { class: "study-form" });
  const element = h("div", { class: "studies" }, h("h1", null, t("study.title")), list, place);
  if (chosen) replace(place, form(chosen, examples, sets, recordingsOf(runs, sets), query));
  // on a phone the form stands below a long list
  if (chosen && window.innerWidth < 700) window.setTimeout(() => place.scrollIntoView(), 0);
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

/** Where signals are recorded: in a run that made them, or in a file of a data set. */
interface Recording {
  label: string;
  of: { run: string } | { dataset: string; file: string };
}

const recorded = /\.(ibyte|ubyte|ishort|gr_complex|cfile|iq|dat|bin|raw)$/i;

function recordingsOf(runs: Run[], sets: DatasetInfo[]): Recording[] {
  return [
    ...runs.filter((r) => r.command === "receiver generate" && r.state === "done").map((r) => ({ label: r.title, of: { run: r.id } })),
    ...sets.flatMap((d) => d.files.filter((f) => recorded.test(f.name)).map((f) => ({ label: `${d.name}/${f.name}`, of: { dataset: d.name, file: f.name } }))),
  ];
}

/** The choice of a recording; that of a run says itself how it was sampled. */
class RecordingChoice {
  readonly element: HTMLSelectElement;

  constructor(
    private readonly all: Recording[],
    given: string | null,
    private readonly options: OptionForm,
  ) {
    this.element = h(
      "select",
      { "aria-label": t("study.recording"), onChange: () => void this.read() },
      ...all.map((r, i) => h("option", { value: String(i) }, r.label)),
    );
    const at = all.findIndex((r) => "run" in r.of && r.of.run === given);
    if (at >= 0) this.element.value = String(at);
    void this.read();
  }

  get chosen(): Recording | undefined {
    return this.all[Number(this.element.value || -1)];
  }

  private async read(): Promise<void> {
    const of = this.chosen?.of;
    if (!of) return;
    const summary = "run" in of ? ((await api.run(of.run).catch(() => null))?.summary as Record<string, unknown> | null | undefined) : null;
    if (of !== this.chosen?.of) return;
    for (const [key, name] of [["sample-rate", "sample_rate_hz"], ["intermediate-frequency", "intermediate_frequency_hz"], ["format", "format"]] as const)
      this.options.put(key, (summary?.[name] as Settings[string] | undefined) || undefined, false);
    this.options.put("start", undefined);
  }
}

function form(study: CommandForm, examples: { name: string; toml: string }[], sets: DatasetInfo[], recordings: Recording[], query: URLSearchParams): HTMLElement {
  const given = query.get("dataset");
  const desk = new Desk();
  const start = runButton(
    t("study.run"),
    () => ({ command: study.command, title: title.value.trim() || study.command, settings: options.settings, ...(recording ? { recording: recording.chosen?.of } : inputOf()) }),
    () => desk.forget(),
    (order) => api.startStudy(order),
  );
  const options = new OptionForm(study.options, () => (items?.(), desk.changed()), () => false, ["general"]);
  desk.follow(options);
  let recording: RecordingChoice | null = null;
  const list = h("div");
  const items = study.command === "paper" ? paperItems(options, list) : null;
  const used: Settings = {};
  for (const o of study.options) if (o.default !== null) used[o.key] = o.default;
  options.load({ settings: {}, used, toml: "", problem: null });
  const title = h("input", { type: "text", class: "run-name", value: study.command.replace("analyze ", ""), "aria-label": t("run.title") });
  const accepts = study.accepts ?? [];
  if (accepts.includes("recording")) recording = new RecordingChoice(recordings, query.get("recording"), options);
  const needs = study.input !== null && study.input !== undefined && !recording;
  const takesData = needs && accepts.includes("dataset");
  const takesScenario = needs && accepts.includes("scenario");
  const input = h(
    "select",
    { "aria-label": t("study.input"), onChange: () => desk.changed() },
    ...(study.optional_input ? [h("option", { value: "" }, "–")] : []),
    ...(takesScenario ? examples.map((e) => h("option", { value: `example:${e.name}` }, `${t("nav.scenario")}: ${e.name}`)) : []),
    ...(takesData ? sets.map((d) => h("option", { value: `data:${d.name}` }, `${t("data.title")}: ${d.name}`)) : []),
  );
  if (given) input.value = `data:${given}`;
  desk.begin({
    form: options,
    title,
    start,
    more: () => input.value,
    reason: () => {
      const missing = study.options.find((o) => o.required && !(o.key in options.settings));
      return recording && !recording.chosen ? t("study.no_recording") : missing ? t("study.missing", { what: labelOf(missing.key) }) : "";
    },
  });
  // a recording says itself how it was sampled: nothing of it is kept
  const draft = recording ? null : desk.draft;
  if (draft) {
    title.value = draft.title;
    options.load({ settings: draft.settings, used, toml: "", problem: null });
    if ([...input.options].some((o) => o.value === draft.more)) input.value = String(draft.more);
    items?.();
    desk.allow();
  }
  const inputOf = (): Record<string, unknown> => {
    if (!needs || input.value === "") return {};
    const [kind, ...rest] = input.value.split(":");
    const name = rest.join(":");
    return kind === "data" ? { dataset: name } : { scenario: { toml: examples.find((e) => e.name === name)?.toml ?? "" } };
  };
  const element = h(
    "section",
    { class: "card" },
    h("h2", null, study.command.replace("analyze ", "")),
    h("p", { class: "muted" }, maybe(`study.${study.command.replace("analyze ", "")}`, study.purpose)),
    h("div", { class: "bar" }, title, needs && h("label", null, t("study.input"), " ", input), recording && h("label", null, t("study.recording"), " ", recording.element), start),
    draft && desk.restored(),
    desk.obstacle,
    (needs || recording) && h("p", { class: "muted" }, maybe(`study.input.${study.command}`, study.input ?? "")),
    list,
    options.element,
    h("details", null, h("summary", null, t("study.examples")), h("pre", { class: "toml", tabIndex: 0 }, study.examples)),
  );
  return element;
}
