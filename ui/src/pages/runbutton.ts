import { api, type Run } from "../api";
import { h, tell } from "../dom";
import { t } from "../i18n";

/** Starts what `order` says and goes to the run. */
export function runButton(
  label: string,
  order: () => Record<string, unknown>,
  started: () => void = () => undefined,
  begin: (order: Record<string, unknown>) => Promise<Run> = (o) => api.start(o),
): HTMLButtonElement {
  const start = async () => {
    try {
      if (button.disabled) return;
      const run = await begin(order());
      started();
      location.hash = `#/run/${encodeURIComponent(run.id)}`;
    } catch (e) {
      tell((e as Error).message, "error");
    }
  };
  const button = h("button", { type: "button", class: "primary run", onClick: () => void start() }, `▶ ${label}`);
  return button;
}

export type Command = "run" | "gravity" | "montecarlo";

/** What is to be done with a scenario or data set, and how often. */
export class CommandChoice {
  private readonly runs = h("input", {
    type: "number",
    class: "runs",
    min: "2",
    max: "100000",
    value: "100",
    "aria-label": t("command.runs"),
    title: t("command.runs"),
  });
  private readonly many = h("label", { class: "run-count", hidden: true }, this.runs, ` ${t("command.n_runs")}`);
  private readonly choice: HTMLSelectElement;
  readonly element: HTMLElement;
  private touched = false;

  constructor(commands: Command[]) {
    this.choice = h(
      "select",
      {
        "aria-label": t("command"),
        onChange: () => {
          this.touched = true;
          this.follow();
        },
      },
      ...commands.map((c) => h("option", { value: c }, t(`command.${c}`))),
    );
    this.element = h("span", { class: "command" }, this.choice, this.many);
  }

  /** What settings suggest, until the user has chosen. */
  suggest(command: Command, runs?: number): void {
    if (this.touched) return;
    this.choice.value = command;
    if (runs) this.runs.value = String(runs);
    this.follow();
  }

  private follow(): void {
    this.many.hidden = this.choice.value !== "montecarlo";
  }

  get order(): Record<string, unknown> {
    const command = this.choice.value;
    return command === "montecarlo" ? { command, runs: Math.round(Number(this.runs.value)) } : { command };
  }
}
