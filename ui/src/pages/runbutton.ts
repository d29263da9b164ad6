import { api } from "../api";
import { h, tell } from "../dom";

/** Starts what `order` says and goes to the run. */
export function runButton(label: string, order: () => Record<string, unknown>): HTMLButtonElement {
  const start = async () => {
    try {
      const run = await api.start(order());
      location.hash = `#/run/${encodeURIComponent(run.id)}`;
    } catch (e) {
      tell((e as Error).message, "error");
    }
  };
  return h("button", { type: "button", class: "primary run", onClick: () => void start() }, `▶ ${label}`);
}
