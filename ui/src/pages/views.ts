// The plots of a run: which columns stand together.
import { api, type Group, type Series } from "../api";
import { maybe, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, type Data, type Line } from "../plots/timeplot";

type Values = (number | null)[];

/** Columns of a run as the lines of a plot; `combine` makes lines of columns. */
export function loader(run: string, ids: string[], combine: (columns: Values[]) => Values[] = (c) => c) {
  return async (from: number | undefined, to: number | undefined, points: number, signal: AbortSignal): Promise<Data> => {
    const s: Series = await api.series(run, ids, { from, to, points }, undefined, signal);
    // a picture is thinned on purpose, a file of numbers is not
    return { x: s.time_s, y: combine(ids.map((id) => s.columns[id]!)), thinned: points === 0 && s.thinned };
  };
}

const times = (values: Values, factor: number): Values => values.map((v) => (v === null ? null : factor * v));

export function unit(text: string): string {
  return { deg: "°", "deg/h": "°/h", SI: "" }[text] ?? text;
}

/** Value with its band of three sigma, one plot a component. */
function banded(run: string, group: string, table: string, what: string, g: Group, linked: Linked, single: boolean): TimePlot[] {
  // a solution alone has latitude and longitude, its sigmas have north and east
  const mine = g.columns.filter((c) => c.id.startsWith(`${group}/${single ? "std_" : ""}${table}:`));
  return mine.map((column, i) => {
    const axis = t(column.name);
    const sigma = single ? column.id : column.id.replace(`/${table}:`, `/std_${table}:`);
    return new TimePlot(
      {
        title: single ? t("view.sigma_of", { what, axis }) : t("view.error_of", { what, axis }),
        unit: unit(column.unit),
        lines: single ? [{ label: "σ", ink: i }] : [{ label: `${t("error")} ${axis}`, ink: i }],
        optional: true,
        stack: table,
        ...(single ? {} : { band: t("band") }),
        include: [0],
        load: single
          ? loader(run, [sigma])
          : loader(run, [column.id, sigma], ([error, s]) => [error!, times(s!, 3), times(s!, -3)]),
      },
      linked,
    );
  });
}

export function errorPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const errors = groups.find((g) => g.group === "/errors");
  const g = errors ?? groups.find((x) => x.group === "/solution");
  if (!g) return [];
  return ["position", "velocity", "attitude"].flatMap((table) =>
    banded(run, g.group, table, t(`view.${table}`), g, linked, !errors),
  );
}

export function sensorPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const g = groups.find((x) => x.group === "/sensor_errors");
  const truth = groups.find((x) => x.group === "/sensor_truth");
  if (!g) return [];
  const out: TimePlot[] = [];
  for (const table of ["gyro_bias", "accel_bias", "gyro_scale_factor", "accel_scale_factor"]) {
    g.columns
      .filter((c) => c.id.startsWith(`/sensor_errors/${table}:`))
      .forEach((column, i) => {
        const known = truth?.columns.find((c) => c.id === column.id.replace("/sensor_errors/", "/sensor_truth/"));
        const sigma = column.id.replace(`/${table}:`, `/std_${table}:`);
        const lines: Line[] = [{ label: t("estimate"), ink: i }];
        if (known) lines.push({ label: t("truth"), ink: 6, dash: [6, 4] });
        out.push(
          new TimePlot(
            {
              title: `${t(`view.${table}`)} ${column.name}`,
              unit: unit(column.unit),
              lines,
              stack: table,
              band: t("band"),
              load: async (from, to, points, signal) => {
                const s = await api.series(run, [column.id, sigma], { from, to, points }, undefined, signal);
                const value = s.columns[column.id]!,
                  sd = s.columns[sigma]!;
                const y: Values[] = [value];
                if (known) {
                  const k = await api.series(run, [known.id], { from, to, points }, undefined, signal);
                  y.push(resampled(k.time_s, k.columns[known.id]!, s.time_s));
                }
                y.push(
                  value.map((v, j) => (v === null ? null : v + 3 * (sd[j] ?? 0))),
                  value.map((v, j) => (v === null ? null : v - 3 * (sd[j] ?? 0))),
                );
                return { x: s.time_s, y };
              },
            },
            linked,
          ),
        );
      });
  }
  return out;
}

/** Linear between the points of another time axis. */
export function resampled(x: number[], y: Values, at: number[]): Values {
  let j = 0;
  return at.map((time) => {
    while (j + 2 < x.length && x[j + 1]! <= time) ++j;
    const [a, b] = [y[j], y[j + 1]];
    if (a === null || a === undefined || b === null || b === undefined || time < x[0]! || time > x.at(-1)!) return null;
    return a + ((b - a) * (time - x[j]!)) / Math.max(x[j + 1]! - x[j]!, 1e-12);
  });
}

/** 95 % point of chi-square for one to three degrees of freedom. */
const limit95 = [3.841, 5.991, 7.815];

/** Components by the kind of aid; others are numbered. */
const axes: Record<string, string[]> = {
  gnss_position: ["north", "east", "down"],
  gnss_velocity: ["north", "east", "down"],
  baro: ["down"],
  mag: ["heading"],
  nonholonomic: ["lateral", "vertical"],
  pseudorange: [""],
  range_rate: [""],
};

/** Accepted, rejected and excluded innovations as lines of their own; then the band, of what was not withheld. */
export function innovationLines(v: Values, sigma: Values, status: Values | undefined): Values[] {
  const of = (wanted: number) => v.map((x, j) => (sigma[j] && status![j] === wanted ? x : null));
  const lines = status ? [of(0), of(1), of(3)] : [v.map((x, j) => (sigma[j] ? x : null))];
  // while fixes are withheld the band grows far beyond what is seen: it is that of what was used
  const band = sigma.map((x, j) => (x && status?.[j] !== 2 ? 3 * x : null));
  return [...lines, band, times(band, -1)];
}

export function innovationPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const out: TimePlot[] = [];
  const units: Record<string, string> = {
    gnss_position: "m",
    gnss_velocity: "m/s",
    baro: "m",
    pseudorange: "m",
    range_rate: "m/s",
    mag: "rad",
    zero_velocity: "m/s",
    zero_rate: "rad/s",
    nonholonomic: "m/s",
  };
  for (const g of groups.filter((x) => x.group.startsWith("/innovations/"))) {
    const kind = g.group.split("/")[2]!,
      name = maybe(`aid.${kind}`, kind.replaceAll("_", " "));
    const status = g.columns.find((c) => c.id.startsWith(`${g.group}/gate:status`));
    for (const [i, component] of ["north", "east", "down"].entries()) {
      const axis = axes[kind] ? axes[kind]![i] : String(i + 1);
      const ids = [`${g.group}/innovation:${component}`, `${g.group}/sigma:${component}`];
      if (axis === undefined || !g.columns.some((c) => c.id === ids[0])) continue;
      out.push(
        new TimePlot(
          {
            title: `${name}: ${t("innovation")} ${axis && t(axis)}`.trim(),
            unit: units[kind] ?? "",
            lines: [
              { label: status ? t("accepted") : t("innovation"), ink: 0, dots: true },
              ...(status
                ? [
                    { label: t("rejected"), paint: "--rejected", dots: true },
                    { label: t("excluded"), paint: "--excluded", dots: true },
                  ]
                : []),
            ],
            band: t("band"),
            stack: kind,
            include: [0],
            robust: true,
            load: loader(run, status ? [...ids, status.id] : ids, ([v, s, st]) => innovationLines(v!, s!, st)),
          },
          linked,
        ),
      );
    }
    out.push(
      new TimePlot(
        {
          title: `${name}: ${t("nis")}`,
          unit: "1",
          lines: [
            { label: t("nis"), ink: 0, dots: true },
            { label: t("nis95"), ink: 1, dash: [6, 4] },
          ],
          logY: true,
          stack: kind,
          load: loader(run, [`${g.group}/gate:nis`, `${g.group}/gate:dof`], ([nis, dof]) => [
            // what is nearly zero stands at the lower edge
            nis!.map((x) => (x !== null && x > 0 ? Math.max(x, 1e-3) : null)),
            dof!.map((d) => (d === null ? null : (limit95[d - 1] ?? d + 1.645 * Math.sqrt(2 * d)))),
          ]),
        },
        linked,
      ),
    );
  }
  return out;
}

export function motionPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  if (!groups.some((g) => g.group === "/solution")) return [];
  const of = (title: string, u: string, ids: string[], labels: string[], combine?: (c: Values[]) => Values[]) =>
    new TimePlot(
      { title, unit: u, optional: true, lines: labels.map((label, ink) => ({ label, ink })), load: loader(run, ids, combine) },
      linked,
    );
  const ids = (table: string, names: string[]) => names.map((n) => `/solution/${table}:${n}`);
  return [
    of(t("editor.height"), "m", ids("position", ["height"]), [t("editor.height")]),
    of(t("view.velocity"), "m/s", ids("velocity", ["north", "east", "down"]), [t("north"), t("east"), t("down")]),
    of(t("editor.speed"), "m/s", ids("velocity", ["north", "east", "down"]), [t("editor.speed")], (c) => [
      c[0]!.map((v, i) => (v === null ? null : Math.hypot(v, c[1]![i] ?? 0, c[2]![i] ?? 0))),
    ]),
    of(`${t("roll")}, ${t("pitch")}`, "°", ids("attitude", ["roll", "pitch"]), [t("roll"), t("pitch")]),
    of(t("heading"), "°", ids("attitude", ["heading"]), [t("heading")], ([v]) => [unwrapped(v!)]),
  ];
}

/** A gap where the heading passes north, instead of a line across the plot. */
function unwrapped(v: Values): Values {
  return v.map((x, i) => (i > 0 && x !== null && v[i - 1] !== null && Math.abs(x - v[i - 1]!) > 180 ? null : x));
}
