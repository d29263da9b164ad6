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
  private readonly runs: HTMLInputElement = h("input", {
    type: "number",
    class: "runs",
    min: "2",
    max: "100000",
    value: "100",
    "aria-label": t("command.runs"),
    title: t("command.runs"),
    onInput: () => {
      this.touched = true;
      this.changed();
    },
  });
  private readonly many = h("label", { class: "run-count", hidden: true }, this.runs, ` ${t("command.n_runs")}`);
  private readonly select: HTMLSelectElement;
  readonly element: HTMLElement;
  private touched = false;

  constructor(
    commands: Command[],
    private readonly changed: () => void,
  ) {
    this.select = h(
      "select",
      {
        "aria-label": t("command"),
        onChange: () => {
          this.touched = true;
          this.follow();
          this.changed();
        },
      },
      ...commands.map((c) => h("option", { value: c }, t(`command.${c}`))),
    );
    this.element = h("span", { class: "command" }, this.select, this.many);
  }

  /** What settings suggest, until the user has chosen. */
  suggest(command: Command, runs?: number): void {
    if (this.touched) return;
    this.select.value = command;
    if (runs) this.runs.value = String(runs);
    this.follow();
  }

  /** For a draft: what is chosen, null until the user has chosen. */
  get choice(): { command: string; runs: string } | null {
    return this.touched ? { command: this.select.value, runs: this.runs.value } : null;
  }

  take(choice: unknown): void {
    const { command, runs } = (choice ?? {}) as { command?: string; runs?: string };
    if (command === undefined || runs === undefined) return;
    this.touched = true;
    this.select.value = command;
    this.runs.value = runs;
    this.follow();
  }

  private follow(): void {
    this.many.hidden = this.select.value !== "montecarlo";
  }

  get order(): Record<string, unknown> {
    const command = this.select.value;
    return command === "montecarlo" ? { command, runs: Math.round(Number(this.runs.value)) } : { command };
  }
}
