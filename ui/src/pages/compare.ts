// Several runs side by side: statistics, errors overlaid, difference, tracks.
import { api, type Group, type RunDetails } from "../api";
import { h, replace } from "../dom";
import { number, t } from "../i18n";
import type { Page } from "../page";
import { Linked } from "../plots/linked";
import { PlanView } from "../plots/plan";
import { TimePlot, linkCursors, type Data } from "../plots/timeplot";
import { withoutJumps } from "./attitude";
import { nameOf as documentName } from "./document";
import { nameOf as ensembleName } from "./ensemble";
import { errorRows, table } from "./overview";
import { planeOf } from "./quality";
import { isDocument } from "./run";
import { resampled, unit } from "./views";

type Values = (number | null)[];

/** The same column of several runs on the time axis of all of them together. */
async function together(
  runs: RunDetails[],
  groups: Group[][],
  id: string,
  range: { from?: number | undefined; to?: number | undefined; points: number },
  signal: AbortSignal,
): Promise<Data> {
  // only of those that have it
  const has = (i: number) => groups[i]!.some((g) => g.columns.some((c) => c.id === id));
  const all = await Promise.all(runs.map((r, i) => (has(i) ? api.series(r.id, [id], range, undefined, signal).catch(() => null) : null)));
  const x = [...new Set(all.flatMap((s) => s?.time_s ?? []))].sort((a, b) => a - b);
  return { x, y: all.map((s) => (s ? resampled(s.time_s, s.columns[id]!, x) : x.map(() => null))) };
}

function statistics(runs: RunDetails[]): HTMLElement {
  const columns = runs.map((r) => new Map((r.summary ? errorRows(r.summary) : []).map((e) => [e.name, e.spread])));
  const names = [...new Set(columns.flatMap((c) => [...c.keys()]))];
  const rows = names.map((name) => {
    const values = columns.map((c) => c.get(name)?.rms ?? null);
    const best = Math.min(...values.filter((v): v is number => v !== null));
    return [name, ...values.map((v) => (v === best && runs.length > 1 ? h("strong", null, number(v)) : number(v)))];
  });
  // whatever else the documents have in common: scalars of their summaries
  const flat = runs.map((r) => {
    const out = new Map<string, number>();
    const walk = (v: unknown, path: string, depth: number) => {
      if (typeof v === "number") out.set(path, v);
      else if (Array.isArray(v)) v.slice(0, 12).forEach((x: unknown, i) => walk(x, `${path} ${typeof x === "object" && x !== null && "scheme" in x ? String((x as { scheme: unknown }).scheme) : i + 1}`, depth + 1));
      else if (typeof v === "object" && v !== null && depth < 4) for (const [k, x] of Object.entries(v)) walk(x, `${path} ${k.replaceAll("_", " ")}`.trim(), depth + 1);
    };
    const { timing: _t, facts: _f, errors: _e, imu: _i, gnss: _g, outages: _o, warnings: _w, self_check: _s, consistency: _c, integrity: _n, ...rest } = (r.summary ?? {}) as Record<string, unknown>;
    walk(rest, "", 0);
    return out;
  });
  const couplings = runs.every((r) => r.summary?.schemes);
  if (names.length === 0 && !couplings)
    for (const key of [...new Set(flat.flatMap((f) => [...f.keys()]))].slice(0, 120))
      rows.push([key, ...flat.map((f) => number(f.get(key) ?? null))]);
  const outages = Math.max(0, ...runs.map((r) => r.summary?.outages?.length ?? 0));
  for (let i = 0; i < outages; ++i)
    rows.push([
      `${t("table.outage")} ${i + 1}: ${t("table.max_h")}`,
      ...runs.map((r) => {
        const o = r.summary?.outages?.[i];
        return o ? `${number(o.max_horizontal_m)} (${number(o.start_s)}–${number(o.start_s + o.duration_s)} s)` : "–";
      }),
    ]);
  if (couplings) return couplingTables(runs);
  return table([`${t("table.quantity")}, rms`, ...runs.map((r) => r.title)], rows, t("compare.table"));
}

/** Of comparisons of couplings: a table a quantity, a row a coupling, a column a run. */
function couplingTables(runs: RunDetails[]): HTMLElement {
  const nameOf = (row: Record<string, unknown>) => `${String(row["scheme"])}${typeof row["satellites"] === "number" ? `, ${row["satellites"]}` : ""}`;
  const rows = runs.map((r) => new Map((r.summary?.schemes ?? []).map((s) => [nameOf(s), s])));
  const couplings = [...new Set(rows.flatMap((m) => [...m.keys()]))];
  const quantities = [...new Set(rows.flatMap((m) => [...m.values()].flatMap((s) => Object.keys(s))))].filter(
    (key) => key !== "satellites" && rows.some((m) => [...m.values()].some((s) => typeof s[key] === "number")),
  );
  return h(
    "div",
    { class: "coupling-tables" },
    ...quantities.map((key) =>
      table(
        [t("run.scheme"), ...runs.map((r) => r.title)],
        couplings.map((c) => [c, ...rows.map((m) => number(m.get(c)?.[key] as number | undefined))]),
        documentName(key),
      ),
    ),
  );
}

/** What is overlaid of runs without errors of their own: the column, its title, and whether it is an angle that may jump. */
function overlaidColumns(group: string, names: string[]): { name: string; title: string; jumps?: boolean }[] {
  const sigma = (what: string, axis: string) => t("view.sigma_of", { what, axis }).trim();
  const axes = ["roll", "pitch", "heading"];
  const gravity: [string, string][] = [
    ["gravity_disturbance_mgal", t("gravity.down")],
    ["disturbance_east_mgal", t("gravity.east")],
    ["disturbance_north_mgal", t("gravity.north")],
    ["std_disturbance_up_mgal", sigma(t("gravity.down"), "")],
    ["std_disturbance_east_mgal", sigma(t("gravity.east"), "")],
    ["std_disturbance_north_mgal", sigma(t("gravity.north"), "")],
    ["free_air_anomaly_mgal", t("gravity.free_air")],
    ["classical_mgal", t("gravity.classical")],
    ["eotvos_mgal", t("gravity.eotvos")],
  ];
  const all =
    group === "/attitude"
      ? [...axes.map((a) => ({ name: `${a}_deg`, title: t(a), jumps: true })), ...axes.map((a) => ({ name: `std_${a}_deg`, title: sigma("", t(a)) }))]
      : group === "/gravity"
        ? gravity.map(([name, title]) => ({ name, title }))
        : names
            .filter((n) => n.endsWith("_rms") || /^nees_(?!.*_(low|high)95$)/.test(n))
            .map((name) => ({
              name,
              title: name.startsWith("nees_") ? `NEES: ${ensembleName(name.slice(5)).toLowerCase()}` : `${t("ensemble.error_of", { what: ensembleName(name) })}, rms`,
            }));
  return all.filter((c) => names.includes(c.name));
}

export async function comparePage(ids: string[]): Promise<Page> {
  const runs = await Promise.all(ids.map((id) => api.run(id)));
  const groups: Group[][] = await Promise.all(runs.map((r) => isDocument(r) ? [] : api.channels(r.id).catch(() => [])));
  const stops = groups.flat().map((g) => g.stop_s ?? 0);
  const linked = new Linked(0, Math.max(1, ...stops));
  const spans = runs.flatMap((r) =>
    (r.summary?.outages ?? []).map((o) => ({ from: o.start_s, to: o.start_s + o.duration_s, label: "" })),
  );
  linked.spans = spans.filter((s, i) => spans.findIndex((o) => o.from === s.from && o.to === s.to) === i);
  const lines = runs.map((r, ink) => ({ label: r.title, ink }));
  const errors = groups.map((g) => g.find((x) => x.group === "/errors")).find(Boolean);
  const plots: TimePlot[] = [];
  for (const name of ["position", "velocity", "attitude"])
    for (const column of errors?.columns.filter((c) => c.id.startsWith(`/errors/${name}:`)) ?? [])
      plots.push(
        new TimePlot(
          {
            title: t("view.error_of", { what: t(`view.${name}`), axis: t(column.name) }),
            unit: unit(column.unit),
            lines,
            include: [0],
            load: (from, to, points, signal) => together(runs, groups, column.id, { from, to, points }, signal),
          },
          linked,
        ),
      );
  // attitude runs, campaigns and surveys have tables of their own
  for (const group of ["/attitude", "/gravity", "/ensemble"]) {
    const theirs = groups.map((g) => g.find((x) => x.group === group));
    const columns = theirs.find(Boolean)?.columns ?? [];
    if (theirs.filter(Boolean).length > 1)
      for (const { name, title, jumps } of overlaidColumns(group, columns.map((c) => c.name))) {
        const column = columns.find((c) => c.name === name)!;
        plots.push(
          new TimePlot(
            {
              title,
              unit: unit(column.unit),
              lines,
              robust: true,
              mayBeEmpty: true,
              load: async (from, to, points, signal) => {
                const all = await together(runs, groups, column.id, { from, to, points }, signal);
                return jumps ? { ...all, y: all.y.map(withoutJumps) } : all;
              },
            },
            linked,
          ),
        );
      }
  }
  const base = h(
    "select",
    { "aria-label": t("compare.base"), onChange: () => differ() },
    ...runs.filter((_, i) => groups[i]!.some((g) => g.group === "/solution")).map((r) => h("option", { value: r.id }, r.title)),
  );
  const place = h("div", { class: "plots" });
  let differences: TimePlot[] = [];
  const differ = () => {
    const others = runs.filter((r, i) => r.id !== base.value && groups[i]!.some((g) => g.group === "/solution"));
    const kinds: [string, string, string[]][] = [
      ["position", "m", ["north", "east", "down"]],
      ["velocity", "m/s", ["v_north", "v_east", "v_down"]],
      ["attitude", "°", ["roll", "pitch", "heading"]],
    ];
    differences = others.flatMap((other) =>
      kinds.map(
        ([kind, u, names]) =>
          new TimePlot(
            {
              title: `${other.title} − ${runs.find((r) => r.id === base.value)!.title}: ${t(`view.${kind}`)}`,
              unit: u,
              lines: names.map((n, ink) => ({ label: t(n.replace("v_", "")), ink })),
              include: [0],
              load: async (from, to, points, signal) => {
                const s = await api.difference(other.id, base.value, { from, to, points }, signal);
                return { x: s.time_s, y: names.map((n) => s.columns[`difference:${n}`] as Values) };
              },
            },
            linked,
          ),
      ),
    );
    linkCursors(differences, linked);
    replace(place, ...differences.map((p) => p.element));
  };
  const plan = new PlanView(linked);
  const withTrack = runs.filter((_, i) => groups[i]!.some((g) => g.group === "/solution"));
  const tracks = await Promise.all(
    withTrack.map(async (r) => {
      const ink = runs.indexOf(r);
      const s = await api.series(r.id, ["/solution/local:east", "/solution/local:north"], { points: 1500 }, withTrack[0]!.id);
      return {
        label: r.title,
        ink,
        time: s.time_s,
        east: s.columns["/solution/local:east"]!,
        north: s.columns["/solution/local:north"]!,
      };
    }),
  );
  if (tracks.length > 0) {
    plan.show(tracks);
    void planeOf(withTrack[0]!.id).then((plane) => plane && plan.lie(plane));
  }
  linkCursors(plots, linked);
  differ();
  const element = h(
    "div",
    { class: "compare" },
    h(
      "div",
      { class: "bar" },
      h("h1", null, t("compare.title")),
      ...runs.map((r, i) =>
        h(
          "a",
          { class: "chip", href: `#/run/${encodeURIComponent(r.id)}` },
          h("span", { class: `swatch ink-${i + 1}` }),
          r.title,
        ),
      ),
    ),
    statistics(runs),
    plots.length > 0 && h("h2", null, t(errors ? "compare.overlay" : "compare.columns")),
    h("div", { class: "plots" }, ...plots.map((p) => p.element)),
    withTrack.length > 1 && h("h2", null, t("compare.base"), " ", base),
    withTrack.length > 1 && place,
    tracks.length > 0 && h("h2", null, t("compare.tracks")),
    tracks.length > 0 && plan.element,
  );
  return { title: t("compare.title"), element, redraw: () => [...plots, ...differences, plan].forEach((p) => p.redraw()) };
}
