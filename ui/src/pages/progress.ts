// What a run at work says about itself: its stage, how far it is, how long it will take.
import { maybe, number, t } from "../i18n";
import type { RunEvent } from "../streams";

/** Stages that tell how far they are. */
const measured = ["", "filtering"];

/** The part done, or null where nobody knows it. */
export function partDone(e: Pick<RunEvent, "state" | "progress" | "stage">): number | null {
  return e.state === "running" && e.progress > 0 && measured.includes(e.stage) ? e.progress : null;
}

/** Seconds that are left by the time spent so far; null as long as that is a guess. */
export function timeLeft(e: Pick<RunEvent, "state" | "progress" | "stage" | "spent_s">): number | null {
  const part = partDone(e);
  const enough = 0.05;
  return part === null || part < enough || part >= 1 || !(e.spent_s > 0) ? null : (e.spent_s * (1 - part)) / part;
}

export function progressWords(e: RunEvent): string {
  if (e.state === "waiting") return t("run.queue");
  const part = partDone(e),
    left = timeLeft(e);
  const what = e.stage !== "" ? maybe(`stage.${e.stage}`, e.stage) : t(part === null ? "run.preparing" : "run.working");
  return [what, part === null ? "" : `${Math.round(100 * part)} %`, left === null ? "" : t("run.left", { s: number(left, 2) })].filter(Boolean).join(" · ");
}
