// What `schuler gravity` found along the track.
import { api, type Group, type RunDetails, type Series } from "../api";
import { h } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors, type Along, type Line } from "../plots/timeplot";
import { table } from "./overview";
import type { View } from "./track";

type Values = (number | null)[];
const column = (name: string) => `/gravity/table:${name}`;

function figures(run: RunDetails): HTMLElement | null {
  const g = run.summary?.gravity;
  if (!g) return null;
  const rows = (["vertical", "north", "east"] as const).map((axis) => {
    const c = (g[`${axis}_mgal`] ?? {}) as Record<string, number | null>;
    // the summary speaks of up, the plots of down: so does the table
    const signed = (k: string) => (axis === "vertical" && (k === "estimate" || k === "final") && typeof c[k] === "number" ? -c[k] : (c[k] ?? null));
    return [t(axis === "vertical" ? "down" : axis), ...["estimate", "sigma", "final", "rms", "spread"].map((k) => number(signed(k), 3))];
  });
  const head = ["table.quantity", "gravity.at_end", "gravity.sigma", "gravity.final", "table.rms", "gravity.spread"];
  return h("div", { class: "figures" }, typeof g["statement"] === "string" && h("p", null, g["statement"]), table(head.map((x) => t(x)), rows, t("gravity.table")));
}

/** Columns by name; "-" before one turns its sign. */
interface Part {
  title: string;
  value: string;
  sigma?: string;
  truth?: string;
  also?: [string, string][];
}

const parts: Part[] = [
  {
    title: "gravity.down",
    value: "gravity_disturbance_mgal",
    sigma: "std_disturbance_up_mgal",
    truth: "-true_up_mgal",
    also: [["gravity.levelled", "levelled_mgal"]],
  },
  { title: "gravity.east", value: "disturbance_east_mgal", sigma: "std_disturbance_east_mgal", truth: "true_east_mgal" },
  { title: "gravity.north", value: "disturbance_north_mgal", sigma: "std_disturbance_north_mgal", truth: "true_north_mgal" },
  { title: "gravity.free_air", value: "free_air_anomaly_mgal" },
  { title: "gravity.classical", value: "classical_mgal", truth: "-true_up_mgal" },
  { title: "gravity.eotvos", value: "eotvos_mgal" },
  { title: "gravity.vertical_acceleration", value: "vertical_acceleration_mgal" },
];

export async function gravityView(run: RunDetails, groups: Group[], shared: Linked): Promise<View> {
  const all = groups.find((g) => g.group === "/gravity")!.columns.map((c) => c.id);
  const s: Series = await api.series(run.id, all, { points: 3000 });
  const distance = s.columns[column("distance_m")]!.map((x) => (x ?? 0) / 1000);
  // a track that does not move is told by time
  const moves = (distance.at(-1) ?? 0) > 0.5;
  const along: Along | undefined = moves ? { label: t("gravity.distance"), unit: "km", name: "distance_km" } : undefined;
  const x = moves ? distance : s.time_s;
  const linked = moves ? new Linked(x[0] ?? 0, x.at(-1) ?? 1) : shared;
  const values = (name: string): Values | null => {
    const turned = name.startsWith("-");
    const v = s.columns[column(turned ? name.slice(1) : name)];
    if (!v || v.every((y) => y === null)) return null;
    return turned ? v.map((y) => (y === null ? null : -y)) : v;
  };
  const plots = parts.flatMap((p) => {
    const value = values(p.value),
      sigma = p.sigma ? values(p.sigma) : null,
      truth = p.truth ? values(p.truth) : null;
    if (!value) return [];
    const lines: Line[] = [{ label: t("estimate"), ink: 0 }];
    const y: Values[] = [value];
    for (const [label, name] of p.also ?? []) {
      const v = values(name);
      if (!v) continue;
      lines.push({ label: t(label), ink: 2 });
      y.push(v);
    }
    if (truth) {
      lines.push({ label: t("truth"), ink: 6, dash: [6, 4] });
      y.push(truth);
    }
    if (sigma) for (const k of [3, -3]) y.push(value.map((v, i) => (v === null ? null : v + k * (sigma[i] ?? 0))));
    const load = async (from?: number, to?: number, points?: number) => {
      if (points !== 0) return { x, y };
      const inside = x.flatMap((v, i) => (v >= (from ?? -Infinity) && v <= (to ?? Infinity) ? [i] : []));
      return { x: inside.map((i) => x[i]!), y: y.map((c) => inside.map((i) => c[i] ?? null)) };
    };
    return [
      new TimePlot(
        {
          title: t(p.title),
          unit: "mGal",
          lines,
          ...(sigma ? { band: t("band") } : {}),
          ...(along ? { along } : {}),
          ...(p.sigma ? { height: 230 } : {}),
          robust: true,
          load,
        },
        linked,
      ),
    ];
  });
  linkCursors(plots, linked);
  const element = h("div", null, figures(run), h("div", { class: "plots" }, ...plots.map((p) => p.element)));
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}
