// A Monte Carlo campaign: errors over the runs, consistency, the runs one by one.
import { api, type Group, type RunDetails } from "../api";
import { h } from "../dom";
import { number, t } from "../i18n";
import type { Linked } from "../plots/linked";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { table } from "./overview";
import type { View } from "./track";
import { loader, unit } from "./views";

const most_rows = 200;

/** "position_east_m" as "Position east", "nees_position" as "NEES: position". */
export function nameOf(key: string): string {
  const [, block = key, axis = ""] = /^(.+?)_(east|north|up|down|x|y|z)_/.exec(key) ?? [];
  const words = { position: "view.position", velocity: "view.velocity", attitude: "view.attitude", gyro_bias: "view.gyro_bias", accel_bias: "view.accel_bias" };
  const known = (words as Record<string, string>)[block];
  return `${known ? t(known) : block.replaceAll("_", " ")} ${axis ? t(axis) : ""}`.trim();
}

function plotsOf(run: string, group: Group, linked: Linked): TimePlot[] {
  const id = (name: string) => `/ensemble/table:${name}`;
  const names = group.columns.map((c) => c.name);
  const errors = names
    .filter((n) => n.endsWith("_rms"))
    .map((n) => {
      const stem = n.slice(0, -4);
      return new TimePlot(
        {
          title: t("ensemble.error_of", { what: nameOf(stem + "_") }),
          unit: unit(group.columns.find((c) => c.name === n)!.unit),
          include: [0],
          band: t("ensemble.band"),
          lines: [
            { label: t("ensemble.median"), ink: 0 },
            { label: "rms", ink: 1, dash: [6, 4] },
          ],
          load: loader(run, [`${stem}_median`, n, `${stem}_q95`, `${stem}_q05`].map(id)),
        },
        linked,
      );
    });
  const nees = names
    .filter((n) => n.startsWith("nees_") && !/_(low|high)95$/.test(n))
    .map(
      (n) =>
        new TimePlot(
          {
            title: `NEES: ${nameOf(n.slice(5)).toLowerCase()}`,
            unit: "1",
            lines: [{ label: "NEES", ink: 0 }],
            band: "95 %",
            load: loader(run, [n, `${n}_high95`, `${n}_low95`].map(id)),
          },
          linked,
        ),
    );
  return [...errors, ...nees];
}

/** Rows of runs.csv with the errors that matter most. */
function runTable(csv: string): HTMLElement {
  const [head = [], ...rows] = csv
    .trim()
    .split("\n")
    .map((line) => line.split(","));
  const fixed = ["run", "seed", "failed"];
  const shown = head.filter((n) => fixed.includes(n) || /^(position_m_(horizontal|up)|attitude_deg_heading)_rms$/.test(n) || n.includes("."));
  const title: Record<string, string> = {
    run: t("ensemble.run"),
    seed: t("ensemble.seed"),
    failed: t("state.failed"),
    position_m_horizontal_rms: `${t("view.position")} ${t("horizontal")}, m`,
    position_m_up_rms: `${t("view.position")} ${t("up")}, m`,
    attitude_deg_heading_rms: `${t("heading")}, °`,
  };
  const cells = rows.slice(0, most_rows).map((r) =>
    shown.map((n) => {
      const value = r[head.indexOf(n)] ?? "";
      if (n === "failed") return t(value === "1" ? "yes" : "no");
      return fixed.includes(n) ? value : value === "" ? "–" : number(Number(value), 4);
    }),
  );
  return table(shown.map((n) => title[n] ?? n), cells, t("ensemble.runs"));
}

export async function ensembleView(run: RunDetails, groups: Group[], linked: Linked): Promise<View> {
  const plots = plotsOf(run.id, groups.find((g) => g.group === "/ensemble")!, linked);
  linkCursors(plots, linked);
  const csv = run.files.includes("runs.csv") ? await api.fileText(run.id, "runs.csv") : "";
  const mc = run.summary?.montecarlo;
  const element = h(
    "div",
    null,
    mc && h("p", { class: "muted" }, t("ensemble.lead", { n: mc.runs, failed: mc.failed })),
    h("div", { class: "plots" }, ...plots.map((p) => p.element)),
    csv !== "" && runTable(csv),
  );
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}
