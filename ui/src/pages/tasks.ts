// What can be done with a data set, and why not where it cannot.
import { api, type CommandForm, type Inspection, type Provided, type Settings } from "../api";
import { h, replace } from "../dom";
import { OptionForm } from "../form";
import { number, t } from "../i18n";
import { gridOf, outageGrid, usualGrid, type Grid } from "./outagegrid";

export type Task = "process" | "grid" | "gnss" | "ppk" | "ahrs" | "gravity" | "allan";

export interface Offer {
  task: Task;
  /** Why it cannot be done; empty: it can. */
  reason: string;
}

interface Has {
  imu: boolean;
  fixes: boolean;
  ranges: string[];
  navigation: boolean;
  initial: boolean;
}

export function contentsOf(found: Inspection): Has {
  const providing = (what: Provided) => found.files.filter((f) => f.provides.includes(what)).map((f) => f.path);
  const settings = found.form.settings;
  return {
    imu: providing("imu").length > 0 || "imu.file" in settings,
    fixes: providing("fixes").length > 0 || "gnss.file" in settings,
    ranges: providing("ranges"),
    navigation: providing("ephemerides").length + providing("orbits").length > 0,
    initial: Object.keys(settings).some((k) => k.startsWith("initial.")),
  };
}

export function offersOf(found: Inspection): Offer[] {
  const has = contentsOf(found);
  const positions = has.fixes || has.ranges.length > 0;
  const need = (...missing: [boolean, string][]) => missing.filter(([there]) => !there).map(([, what]) => t(`need.${what}`)).join("; ");
  return [
    { task: "process", reason: need([has.imu, "imu"], [positions || has.initial, "gnss"]) },
    { task: "grid", reason: need([has.imu, "imu"], [positions, "gnss"]) },
    { task: "gnss", reason: need([positions, "gnss"]) },
    { task: "ppk", reason: need([has.ranges.length > 1, "base"], [has.navigation, "navigation"]) },
    { task: "ahrs", reason: need([has.imu, "imu"]) },
    { task: "gravity", reason: need([has.imu, "imu"], [positions, "gnss"]) },
    { task: "allan", reason: need([has.imu, "imu"]) },
  ];
}

/** A task as a draft or a run has it. */
export interface TaskState {
  task?: string;
  arguments?: Settings;
  rover?: string;
  base?: string;
  grid?: Grid;
}

/** The choice of a task with the options of its command, and the order that it comes to. */
export class TaskChoice {
  readonly element = h("section", { class: "card tasks" });
  task: Task;
  private form: OptionForm | null = null;
  private readonly options = h("div");
  private readonly more: HTMLElement = h("div");
  private base = "";
  private rover = "";
  private grid: Grid;
  private readonly buttons = new Map<Task, HTMLInputElement>();

  constructor(
    private readonly found: Inspection,
    private readonly commands: CommandForm[],
    private readonly changed: () => void,
    /** Of the log, s. */
    private readonly duration: number,
    given: TaskState = {},
  ) {
    const offers = offersOf(found);
    this.grid = usualGrid(duration);
    const buttons = offers.map((o) => {
      const button = h("input", { type: "radio", name: "task", value: o.task, disabled: o.reason !== "", onChange: () => this.choose(o.task) });
      this.buttons.set(o.task, button);
      return h(
        "label",
        { class: `task ${o.reason ? "off" : ""}`, title: o.reason },
        button,
        h("span", null, h("strong", null, t(`task.${o.task}`)), h("span", { class: "muted" }, o.reason ? `${t("task.not")}: ${o.reason}` : t(`task.${o.task}_what`))),
      );
    });
    replace(this.element, h("h2", null, t("task.title")), h("div", { class: "task-list", role: "radiogroup", "aria-label": t("task.title") }, ...buttons), this.more, this.options);
    this.task = "process";
    this.take(given);
  }

  /** Takes up what a draft or an earlier run has; of what cannot be done here the first that can. */
  take(given: TaskState): void {
    const offers = offersOf(this.found);
    const { outage, ...others } = given.arguments ?? {};
    // a run has no task of that name: it is told by its windows
    const ordered = given.grid ? null : gridOf(outage);
    this.grid = given.grid ?? ordered ?? this.grid;
    const wanted = given.task === "process" && ordered ? "grid" : given.task;
    this.task = (offers.find((o) => o.task === wanted && o.reason === "") ?? offers.find((o) => o.reason === ""))?.task ?? "process";
    const button = this.buttons.get(this.task);
    if (button && !button.disabled) button.checked = true;
    this.choose(this.task, ordered ? others : (given.arguments ?? {}), given);
  }

  /** What a draft keeps. */
  get state(): TaskState {
    return { task: this.task, arguments: { ...(this.form?.settings ?? {}) }, rover: this.rover, base: this.base, grid: { ...this.grid } };
  }

  /** Why nothing can be started; empty where something can. */
  get obstacle(): string {
    const offer = offersOf(this.found).find((o) => o.task === this.task);
    if (!offer || offer.reason) return offer?.reason ?? t("need.imu");
    if (this.task === "ppk" && (!this.base || this.base === this.rover)) return t("need.base");
    if (this.task === "grid" && this.windows.length === 0) return t("task.grid_none");
    return this.wrong > 0 ? t("form.mend_first") : "";
  }

  private wrong = 0;

  private get windows(): string[] {
    return outageGrid(this.duration, this.grid);
  }

  private get command(): string {
    return this.task === "ahrs" || this.task === "gravity" ? this.task : "process";
  }

  private choose(task: Task, given: Settings = {}, stations: TaskState = {}): void {
    this.task = task;
    this.wrong = 0;
    const command = this.commands.find((c) => c.command === this.command);
    const hidden = task === "grid" ? ["outage"] : task === "process" ? [] : ["scheme", "smooth", "backward", "loop", "mechanization", "self-check"];
    this.form = null;
    replace(this.options);
    replace(this.more);
    if (task === "ppk") this.stations(stations);
    if (task === "grid") this.spacings();
    if (task !== "allan" && command) {
      const options = command.options.filter((o) => o.key !== "seed" && o.key !== "runs" && o.key !== "response" && (task === "ahrs" || task === "gravity" || !hidden.includes(o.key)));
      const used: Settings = {};
      for (const o of options) if (o.default !== null) used[o.key] = o.default;
      const form = new OptionForm(options, () => this.changed(), () => false, ["general"]);
      form.judged = (wrong) => {
        this.wrong = wrong;
        this.changed();
      };
      form.load({ settings: given, used, toml: "", problem: null });
      this.form = form;
      this.options.append(h("details", { open: task === "ahrs" || Object.keys(given).length > 0 }, h("summary", null, t("task.options")), form.element));
    }
    this.changed();
  }

  /** Length and spacing of the windows, and which they come to. */
  private spacings(): void {
    const said = h("p", { class: "muted", role: "status" });
    const tell = () => {
      const { windows } = this;
      const [first = "", last = ""] = [windows[0], windows.at(-1)].map((w) => w?.replace(":", " s + "));
      said.textContent = windows.length > 0 ? t("task.grid_windows", { n: windows.length, first: `${first} s`, last: `${last} s` }) : t("task.grid_none");
    };
    const field = (key: keyof Grid) =>
      h(
        "label",
        null,
        `${t(`task.grid_${key}`)} `,
        h("input", {
          type: "number",
          class: "runs",
          min: "0",
          step: "any",
          value: String(this.grid[key]),
          onInput: (e: Event) => {
            this.grid = { ...this.grid, [key]: Number((e.target as HTMLInputElement).value) };
            tell();
            this.changed();
          },
        }),
        " s",
      );
    tell();
    replace(this.more, h("p", { class: "form-tools grid-fields" }, field("length"), field("spacing"), field("clear")), said, h("p", { class: "muted" }, t("task.grid_log", { s: number(this.duration) })));
  }

  private stations(given: TaskState = {}): void {
    const { ranges } = contentsOf(this.found);
    const select = (label: string, first: string, take: (v: string) => void) => {
      const s = h("select", { "aria-label": label, onChange: () => (take(s.value), this.changed()) }, ...ranges.map((r) => h("option", { value: r }, r)));
      s.value = first;
      return h("label", null, `${label} `, s);
    };
    const rover = String(this.found.form.settings["gnss.observations"] ?? ranges.find((r) => /rover/i.test(r)) ?? ranges[0] ?? "");
    this.rover = given.rover && ranges.includes(given.rover) ? given.rover : ranges.includes(rover) ? rover : (ranges[0] ?? "");
    this.base = given.base && ranges.includes(given.base) ? given.base : ranges.find((r) => /base/i.test(r) && r !== this.rover) ?? ranges.find((r) => r !== this.rover) ?? "";
    replace(
      this.more,
      h("p", { class: "form-tools" }, select(t("task.rover"), this.rover, (v) => (this.rover = v)), select(t("task.base"), this.base, (v) => (this.base = v))),
    );
  }

  /** Settings over those of the data set that the task needs. */
  settings(changed: Settings, whole: Settings): Settings {
    if (this.task !== "ppk" && this.task !== "gnss") return changed;
    // a receiver's log alone is found by its settings: all of them are given
    const out: Settings = { ...whole, "filter.scheme": "gnss" };
    const { files } = this.found;
    // beside the ephemerides of the ranges' own file
    const navigation = files.filter((f) => f.provides.includes("ephemerides") && !f.provides.includes("ranges")).map((f) => f.path);
    const longest = (what: Provided) => files.filter((f) => f.provides.includes(what)).sort((a, b) => b.rows - a.rows)[0]?.path;
    if (this.task === "gnss" && !("gnss.file" in out) && !("gnss.observations" in out)) {
      // without an IMU nothing was proposed: the longest log of the receiver, fixes before ranges
      const fixes = longest("fixes");
      const ranges = longest("ranges");
      if (fixes) out["gnss.file"] = fixes;
      else if (ranges) {
        out["gnss.observations"] = ranges;
        if (navigation.length > 0) out["gnss.navigation"] = navigation;
      }
    }
    if (this.task === "ppk") {
      delete out["gnss.file"];
      out["gnss.observations"] = this.rover;
      out["base.observations"] = this.base;
      if (!("gnss.navigation" in out) && navigation.length > 0) out["gnss.navigation"] = navigation;
    }
    return out;
  }

  get order(): Record<string, unknown> {
    const args: Settings = { ...(this.form?.settings ?? {}) };
    if (this.task === "gnss" || this.task === "ppk") args["scheme"] = "gnss";
    if (this.task === "grid") args["outage"] = this.windows;
    return { command: this.command === "process" ? "run" : this.command, arguments: args };
  }

  /** Allan deviations are a study. */
  start(order: Record<string, unknown>) {
    if (this.task !== "allan") return api.start(order);
    return api.startStudy({ command: "analyze allan", title: order["title"], dataset: order["dataset"], settings: {} });
  }
}
