// A form from the option table of the program: one field an option, its unit, its sentence, what it is now and what is wrong.
import type { Json, Option, Problem, Settings, Understood } from "./api";
import { append, h, replace } from "./dom";
import { help, maybe, t } from "./i18n";
import { labelKeys, sectionOf, wordsOf } from "./labels";
import { said } from "./reasons";

export function labelOf(key: string): string {
  const [own, words] = labelKeys(key);
  return maybe(own, maybe(words, wordsOf(key)));
}

const nameOf = (section: string) => maybe(`section.${section}`, section.replaceAll(".", " ").replaceAll("_", " "));

/** The kinds of trajectories that use an option; null: all. */
export function kindsOf(option: Option): string[] | null {
  return /^trajectory\.type: (.+)$/.exec(option.applies ?? "")?.[1]?.split(", ") ?? null;
}

function shownValue(v: Json): string {
  if (v === null || v === undefined) return "";
  return typeof v === "string" ? v : typeof v === "number" ? String(v) : JSON.stringify(v);
}

/** What is wrong with a text typed into a field, or the value it stands for. */
function parsed(option: Option, text: string): { value: Json } | { wrong: string } {
  const bounds = (x: number) =>
    Number.isFinite(x) && (option.low === null || x >= option.low) && (option.high === null || x <= option.high);
  const wrong = { wrong: t("form.wrong", { accepts: said(option.accepts) }) };
  const decimal = (s: string) => (s.trim() === "" ? NaN : Number(s.trim().replace(/^([+-]?\d+),(\d+)$/, "$1.$2")));
  switch (option.shape) {
    case "number": {
      const x = decimal(text);
      return bounds(x) ? { value: x } : wrong;
    }
    case "integer": {
      const x = Number(text);
      return Number.isInteger(x) && bounds(x) ? { value: x } : wrong;
    }
    case "text":
      return option.choices.length === 0 || option.choices.includes(text) ? { value: text } : wrong;
    case "numbers": {
      const list = text
        .replace(/^\[|\]$/g, "")
        .split(/[;,\s]+/)
        .filter(Boolean)
        .map(Number);
      return list.every(bounds) && (option.length === 0 || list.length === option.length) ? { value: list } : wrong;
    }
    default:
      if (option.shape === "texts" && !text.trim().startsWith("["))
        return { value: text.split(/[,;]+/).map((x) => x.trim()).filter(Boolean) };
      // a value of its own form: a list or a number as JSON, otherwise text
      if (option.shape === "any" && !/^[[{"\d+-]|^(true|false)$/.test(text.trim())) return { value: text };
      try {
        return { value: JSON.parse(text) as Json };
      } catch {
        return option.shape === "any" ? { value: text } : wrong;
      }
  }
}

interface Field {
  option: Option;
  row: HTMLElement;
  inputs: (HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement)[];
  message: HTMLElement;
  doubt: HTMLElement;
}

export class OptionForm {
  readonly element = h("div", { class: "form" });
  readonly settings: Settings = {};
  private used: Settings = {};
  private readonly fields = new Map<string, Field>();
  private readonly sections = new Map<string, HTMLDetailsElement>();
  private readonly search = h("input", {
    type: "search",
    placeholder: t("form.search"),
    "aria-label": t("form.search"),
    onInput: () => this.filter(),
  });
  private readonly onlySet = h("input", { type: "checkbox", onChange: () => this.filter() });
  private readonly first: string[];
  /** Fields whose text is no value: what is used is still the one before. */
  private readonly wrong = new Set<string>();
  /** Told whenever the number of such fields changes. */
  judged: (wrong: number) => void = () => undefined;

  constructor(
    options: Option[],
    private readonly changed: () => void,
    private readonly skip: (key: string) => boolean = () => false,
    open: string[] = [],
    /** Options that stand first, open. */
    first: string[] = [],
  ) {
    this.first = first.filter((key) => options.some((o) => o.key === key));
    append(this.element, h("div", { class: "form-tools" }, this.search, h("label", null, this.onlySet, t("form.only_set"))));
    const main = this.first.length > 0 ? this.section("main", true) : null;
    for (const key of this.first) main!.append(this.field(options.find((o) => o.key === key)!));
    for (const option of options) {
      if (this.skip(option.key) || this.first.includes(option.key)) continue;
      const name = sectionOf(option.key);
      (this.sections.get(name) ?? this.section(name, open.includes(name))).append(this.field(option));
    }
  }

  private section(name: string, open: boolean): HTMLDetailsElement {
    const section = h("details", { open }, h("summary", null, nameOf(name)));
    this.sections.set(name, section);
    this.element.append(section);
    return section;
  }

  /** Among the first ones the name of an option says whose it is. */
  private label(key: string): string {
    const section = sectionOf(key);
    return this.first.includes(key) && section !== "general" ? `${nameOf(section)}: ${labelOf(key)}` : labelOf(key);
  }

  private field(option: Option): HTMLElement {
    const id = `option-${option.key.replaceAll(".", "-")}`;
    const message = h("p", { class: "field-wrong", id: `${id}-wrong`, role: "alert", hidden: true });
    const doubt = h("p", { class: "field-doubt", hidden: true });
    const sentence = help(option.help);
    const described = { "aria-describedby": `${id}-help ${id}-wrong` };
    const inputs: Field["inputs"] = [];
    const choices = option.shape === "texts" ? [] : option.choices; // of a list more than one may be given
    if (option.shape === "flag" || choices.length > 0) {
      const values = option.shape === "flag" ? ["true", "false"] : choices;
      inputs.push(
        h(
          "select",
          { id, ...described, onChange: () => this.take(option.key) },
          h("option", { value: "" }, "–"),
          ...values.map((v) => h("option", { value: v }, option.shape === "flag" ? t(v === "true" ? "yes" : "no") : v)),
        ),
      );
    } else if (option.shape === "numbers" && option.length > 1 && option.length < 5) {
      for (let i = 0; i < option.length; ++i)
        inputs.push(
          h("input", {
            type: "text",
            inputMode: "decimal",
            id: i === 0 ? id : `${id}-${i}`,
            "aria-label": `${labelOf(option.key)} ${i + 1}`,
            ...described,
            onInput: () => this.take(option.key),
          }),
        );
    } else if (option.shape === "tables" || option.shape === "table" || option.key.endsWith("waypoints")) {
      inputs.push(h("textarea", { id, rows: 3, spellcheck: false, ...described, onInput: () => this.take(option.key) }));
    } else {
      const numeric = option.shape === "number" || option.shape === "integer";
      inputs.push(
        h("input", {
          type: "text",
          id,
          ...(numeric ? { inputMode: "decimal" } : {}),
          ...described,
          onInput: () => this.take(option.key),
        }),
      );
    }
    const reset = h(
      "button",
      {
        type: "button",
        class: "icon reset",
        title: t("form.back"),
        "aria-label": `${t("form.back")}: ${option.key}`,
        onClick: () => this.put(option.key, undefined),
      },
      "↺",
    );
    const row = h(
      "div",
      { class: "field", "data-key": option.key },
      h("label", { htmlFor: id, title: option.key }, this.label(option.key)),
      h("span", { class: `inputs n${inputs.length}` }, ...inputs, h("span", { class: "unit" }, option.unit), reset),
      h(
        "p",
        { class: "help", id: `${id}-help` },
        sentence,
        option.shape === "number" || option.shape === "integer"
          ? h(
              "span",
              { class: "accepts" },
              ` · ${said(option.accepts.replace(/\d{6,}/g, (n) => Number(n).toExponential().replace("e+", "e")))}`,
            )
          : null,
      ),
      doubt,
      message,
    );
    this.fields.set(option.key, { option, row, inputs, message, doubt });
    return row;
  }

  /** Takes what is typed in a field. */
  private take(key: string): void {
    const { option, inputs, message, row } = this.fields.get(key)!;
    const texts = inputs.map((i) => i.value);
    const empty = texts.every((x) => x.trim() === "");
    let wrong = "";
    if (empty) {
      delete this.settings[key];
    } else {
      // of three numbers those that are not typed stay as they are
      const now = this.used[key];
      const filled = texts.map((x, i) => (x.trim() === "" && Array.isArray(now) ? String(now[i]) : x));
      const result =
        option.shape === "flag" ? { value: texts[0] === "true" } : parsed(option, filled.join(inputs.length > 1 ? ";" : ""));
      if ("wrong" in result) wrong = result.wrong;
      else this.settings[key] = result.value;
    }
    message.hidden = wrong === "";
    message.textContent = wrong;
    for (const i of inputs) i.setAttribute("aria-invalid", String(wrong !== ""));
    if (wrong === "") this.wrong.delete(key);
    else this.wrong.add(key);
    this.judged(this.wrong.size);
    row.classList.toggle("given", key in this.settings);
    if (wrong === "") this.changed();
  }

  /** Sets a field as if it had been typed; undefined: back to what is used without it. */
  put(key: string, value: Json | undefined, tell = true): void {
    if (this.wrong.delete(key)) this.judged(this.wrong.size);
    const field = this.fields.get(key);
    if (value === undefined) delete this.settings[key];
    else this.settings[key] = value;
    if (field) this.fill(field);
    if (tell) this.changed();
  }

  private fill({ option, inputs, row, message }: Field): void {
    const value = this.settings[option.key];
    const given = value !== undefined;
    row.classList.toggle("given", given);
    message.hidden = true;
    inputs.forEach((input, i) => {
      input.setAttribute("aria-invalid", "false");
      if (inputs.length > 1) input.value = given && Array.isArray(value) ? shownValue(value[i] ?? null) : "";
      else input.value = given ? shownValue(value) : "";
    });
    this.hint({ option, inputs } as Field);
  }

  /** What is used where nothing is given stands in the empty field. */
  private hint({ option, inputs }: Field): void {
    const used = this.used[option.key];
    inputs.forEach((input, i) => {
      if (input instanceof HTMLSelectElement) {
        const word =
          used === undefined || used === null
            ? t("form.by_itself")
            : option.shape === "flag"
              ? t(used ? "yes" : "no")
              : shownValue(used);
        input.options[0]!.textContent = used === undefined || used === null ? word : `${word} ${t("form.default")}`;
      } else {
        input.placeholder =
          inputs.length > 1
            ? Array.isArray(used)
              ? shownValue(used[i] ?? null)
              : ""
            : shownValue(used ?? null) || t("form.by_itself");
      }
    });
  }

  load(now: Understood): void {
    this.wrong.clear();
    this.judged(0);
    for (const key of Object.keys(this.settings)) delete this.settings[key];
    Object.assign(this.settings, now.settings);
    this.used = now.used;
    for (const field of this.fields.values()) this.fill(field);
    this.understood(now);
  }

  /** What the server makes of the settings: values that are used, and what is wrong, beside the field. */
  understood(now: Understood): void {
    if (!now.problem) this.used = now.used;
    for (const field of this.fields.values()) {
      if (!now.problem) this.hint(field);
      if (field.message.dataset.from === "server") field.message.hidden = true;
    }
    if (now.problem) this.blame(now.problem);
    const kind = String(this.settings["trajectory.type"] ?? this.used["trajectory.type"] ?? "");
    for (const { option, row } of this.fields.values()) {
      const kinds = kindsOf(option);
      row.classList.toggle("other-kind", kinds !== null && !kinds.includes(kind));
    }
    for (const section of this.sections.values())
      section.classList.toggle("empty", !section.querySelector(".field:not(.other-kind)"));
  }

  blame(problem: Problem): boolean {
    const field = this.fields.get(problem.key);
    if (!field) return false;
    field.message.hidden = false;
    field.message.dataset.from = "server";
    field.message.textContent = said(problem.text + (problem.mend ? `; ${problem.mend}` : ""));
    field.row.closest("details")!.open = true;
    return true;
  }

  /** Marks what is a guess, with the evidence; what is doubtful stands together, so that no long section is opened for it. */
  doubts(findings: { key: string; value: string; confidence: number; why: string }[]): void {
    const unsure: Field[] = [];
    for (const f of findings) {
      const field = this.fields.get(f.key);
      if (!field) continue;
      field.doubt.hidden = false;
      const doubtful = f.confidence < 0.9;
      field.row.classList.toggle("doubtful", doubtful);
      replace(field.doubt, `${doubtful ? "⚠ " : "✓ "}${t("data.sure", { percent: Math.round(100 * f.confidence) })}: ${said(f.why)}`);
      if (doubtful && !this.first.includes(f.key)) unsure.push(field);
    }
    if (unsure.length === 0) return;
    const place = this.section("doubtful", true);
    // first of all but the tools
    this.element.insertBefore(place, this.element.querySelector("details"));
    for (const { option, row } of unsure) {
      const section = sectionOf(option.key);
      if (section !== "general") row.querySelector("label")!.textContent = `${nameOf(section)}: ${labelOf(option.key)}`;
      place.append(row);
    }
  }

  private filter(): void {
    const word = this.search.value.toLowerCase();
    for (const { option, row } of this.fields.values()) {
      const hit = word === "" || `${option.key} ${row.textContent}`.toLowerCase().includes(word);
      row.hidden = !hit || (this.onlySet.checked && !(option.key in this.settings));
    }
    for (const section of this.sections.values()) {
      const any = section.querySelector(".field:not([hidden])");
      section.hidden = !any;
      if (word !== "" && any) section.open = true;
    }
  }
}
