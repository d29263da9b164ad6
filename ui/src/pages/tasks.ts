// What can be done with a data set, and why not where it cannot.
import { api, type CommandForm, type Inspection, type Provided, type Settings } from "../api";
import { h, replace } from "../dom";
import { OptionForm } from "../form";
import { t } from "../i18n";

export type Task = "process" | "gnss" | "ppk" | "ahrs" | "gravity" | "allan";

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
    { task: "gnss", reason: need([positions, "gnss"]) },
    { task: "ppk", reason: need([has.ranges.length > 1, "base"], [has.navigation, "navigation"]) },
    { task: "ahrs", reason: need([has.imu, "imu"]) },
    { task: "gravity", reason: need([has.imu, "imu"], [positions, "gnss"]) },
    { task: "allan", reason: need([has.imu, "imu"]) },
  ];
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

  constructor(
    private readonly found: Inspection,
    private readonly commands: CommandForm[],
    private readonly changed: () => void,
    given: { task?: string; arguments?: Settings } = {},
  ) {
    const offers = offersOf(found);
    this.task = (offers.find((o) => o.task === given.task && o.reason === "") ?? offers.find((o) => o.reason === ""))?.task ?? "process";
    const buttons = offers.map((o) =>
      h(
        "label",
        { class: `task ${o.reason ? "off" : ""}`, title: o.reason },
        h("input", {
          type: "radio",
          name: "task",
          value: o.task,
          disabled: o.reason !== "",
          checked: o.task === this.task && o.reason === "",
          onChange: () => this.choose(o.task),
        }),
        h("span", null, h("strong", null, t(`task.${o.task}`)), h("span", { class: "muted" }, o.reason ? `${t("task.not")}: ${o.reason}` : t(`task.${o.task}_what`))),
      ),
    );
    replace(this.element, h("h2", null, t("task.title")), h("div", { class: "task-list", role: "radiogroup", "aria-label": t("task.title") }, ...buttons), this.more, this.options);
    this.choose(this.task, given.arguments ?? {});
  }

  /** Why nothing can be started; empty where something can. */
  get obstacle(): string {
    const offer = offersOf(this.found).find((o) => o.task === this.task);
    if (!offer || offer.reason) return offer?.reason ?? t("need.imu");
    if (this.task === "ppk" && (!this.base || this.base === this.rover)) return t("need.base");
    return this.wrong > 0 ? t("form.mend_first") : "";
  }

  private wrong = 0;

  private get command(): string {
    return this.task === "ahrs" || this.task === "gravity" ? this.task : "process";
  }

  private choose(task: Task, given: Settings = {}): void {
    this.task = task;
    this.wrong = 0;
    const command = this.commands.find((c) => c.command === this.command);
    const hidden = task === "process" ? [] : ["scheme", "smooth", "backward", "loop", "mechanization", "self-check"];
    this.form = null;
    replace(this.options);
    replace(this.more);
    if (task === "ppk") this.stations();
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

  private stations(): void {
    const { ranges } = contentsOf(this.found);
    const select = (label: string, first: string, take: (v: string) => void) => {
      const s = h("select", { "aria-label": label, onChange: () => (take(s.value), this.changed()) }, ...ranges.map((r) => h("option", { value: r }, r)));
      s.value = first;
      return h("label", null, `${label} `, s);
    };
    const rover = String(this.found.form.settings["gnss.observations"] ?? ranges.find((r) => /rover/i.test(r)) ?? ranges[0] ?? "");
    this.rover = ranges.includes(rover) ? rover : (ranges[0] ?? "");
    this.base = ranges.find((r) => /base/i.test(r) && r !== this.rover) ?? ranges.find((r) => r !== this.rover) ?? "";
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
    return { command: this.command === "process" ? "run" : this.command, arguments: args };
  }

  /** Allan deviations are a study. */
  start(order: Record<string, unknown>) {
    if (this.task !== "allan") return api.start(order);
    return api.startStudy({ command: "analyze allan", title: order["title"], dataset: order["dataset"], settings: {} });
  }
}
