// The state of a run in a word.
import type { Run } from "../api";
import { h } from "../dom";
import { t } from "../i18n";
import { said } from "../reasons";

export function stateBadge(run: Run): HTMLElement {
  const icon = { waiting: "…", running: "▶", done: "✓", failed: "✗", cancelled: "⊘" }[run.state];
  return h("span", { class: `badge ${run.state}`, title: said(run.message) }, `${icon} ${t(`state.${run.state}`)}`);
}
