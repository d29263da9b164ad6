// Attitude without position: what `schuler ahrs` found.
import { api, type Group } from "../api";
import { t } from "../i18n";
import type { Linked } from "../plots/linked";
import { TimePlot } from "../plots/timeplot";

type Values = (number | null)[];

/** A gap where an angle passes from one end of its range to the other, instead of a line across the plot. */
export function withoutJumps(v: Values): Values {
  return v.map((x, i) => (i > 0 && x !== null && v[i - 1] !== null && Math.abs(x - v[i - 1]!) > 180 ? null : x));
}

export function attitudePlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const g = groups.find((x) => x.group === "/attitude");
  if (!g) return [];
  const has = (name: string) => g.columns.some((c) => c.name === name);
  const id = (name: string) => `/attitude/table:${name}`;
  return ["roll", "pitch", "heading"]
    .filter((axis) => has(`${axis}_deg`))
    .flatMap((axis, ink) => {
      const sigma = has(`std_${axis}_deg`);
      const value = new TimePlot(
        {
          title: t(axis),
          unit: "°",
          height: 165,
          lines: [{ label: t(axis), ink }],
          load: async (from, to, points, signal) => {
            const s = await api.series(run, [id(`${axis}_deg`)], { from, to, points }, undefined, signal);
            return { x: s.time_s, y: [withoutJumps(s.columns[id(`${axis}_deg`)]!)] };
          },
        },
        linked,
      );
      if (!sigma) return [value];
      return [
        value,
        new TimePlot(
          {
            title: t("view.sigma_of", { what: "", axis: t(axis) }).trim(),
            unit: "°",
            height: 120,
            logY: true,
            optional: true,
            lines: [{ label: "σ", ink }],
            load: async (from, to, points, signal) => {
              const s = await api.series(run, [id(`std_${axis}_deg`)], { from, to, points }, undefined, signal);
              return { x: s.time_s, y: [s.columns[id(`std_${axis}_deg`)]!.map((x) => (x !== null && x > 0 ? x : null))] };
            },
          },
          linked,
        ),
      ];
    });
}
