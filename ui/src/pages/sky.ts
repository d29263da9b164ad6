// Satellites and stations of a run: sky plot, when each is seen and used, residuals of the ranges.
import { api, type Group } from "../api";
import { h } from "../dom";
import { number, t } from "../i18n";
import type { Linked } from "../plots/linked";
import { SkyPlot, type Source } from "../plots/skyplot";
import { TimePlot, linkCursors, type PlotSettings } from "../plots/timeplot";
import { table } from "./overview";
import type { View } from "./track";

type Values = (number | null)[];

async function sourcesOf(run: string, g: Group): Promise<{ sources: Source[]; times: number[] }> {
  const id = (table: string, name: string) => g.columns.find((c) => c.id.startsWith(`/sky/${table}:${name}`))!.id;
  const names = g.columns.find((c) => c.names)?.names ?? [];
  const ids = [
    id("source", "number"),
    id("source", "station"),
    id("direction", "azimuth"),
    id("direction", "elevation"),
    id("range", "status"),
    id("range", "residual"),
    id("range", "sigma"),
  ];
  const s = await api.series(run, ids, { points: 0 });
  const [which, station, azimuth, elevation, status, residual, sigma] = ids.map((i) => s.columns[i]!);
  const sources = new Map<number, Source>();
  s.time_s.forEach((time, i) => {
    const n = which![i] ?? 0;
    if (!sources.has(n)) sources.set(n, { name: names[n] ?? String(n), station: station![i] === 1, seen: [] });
    sources.get(n)!.seen.push({
      time,
      azimuth: azimuth![i] ?? 0,
      elevation: elevation![i] ?? 0,
      status: status![i] ?? 2,
      residual: residual![i] ?? null,
      sigma: sigma![i] ?? null,
    });
  });
  const sorted = [...sources.values()].sort((a, b) => a.name.localeCompare(b.name));
  return { sources: sorted, times: [...new Set(s.time_s)].sort((a, b) => a - b) };
}

/** One value at each time and source, in the order of time; a line for each status. */
function byStatus(sources: Source[], value: (s: Source["seen"][number], row: number) => number | null) {
  const all = sources.flatMap((source, row) => source.seen.map((s) => ({ time: s.time, status: s.status, y: value(s, row) })));
  all.sort((a, b) => a.time - b.time);
  return (statuses: number[]) => ({
    x: all.map((s) => s.time),
    y: statuses.map((k): Values => all.map((s) => (s.status === k ? s.y : null))),
  });
}

function plotsOf(sources: Source[], times: number[], linked: Linked): TimePlot[] {
  const asked = sources.some((s) => s.seen.some((x) => x.status !== 2));
  const dots = [
    { label: t("sky.used"), ink: 0, dots: true },
    { label: t("rejected"), ink: 1, dots: true },
    { label: t("sky.unused"), ink: 6, dots: true },
  ];
  const seen = byStatus(sources, (_, row) => row)([0, 1, 2]);
  const index = new Map(times.map((time, i) => [time, i]));
  const count = (f: (status: number) => boolean): Values => {
    const out = times.map(() => 0);
    for (const { seen } of sources) for (const s of seen) if (f(s.status)) out[index.get(s.time)!]! += 1;
    return out;
  };
  const settings: PlotSettings[] = [
    {
      title: t("sky.visibility"),
      unit: "",
      names: sources.map((s) => s.name),
      height: 70 + 15 * sources.length,
      lines: asked ? dots : dots.slice(2),
      load: async () => (asked ? seen : { x: seen.x, y: seen.y.slice(2) }),
    },
    {
      title: t("sky.count"),
      unit: "1",
      include: [0],
      lines: [{ label: t("sky.seen"), ink: 6 }, ...(asked ? [{ label: t("sky.used"), ink: 0 }] : [])],
      load: async () => ({ x: times, y: [count(() => true), ...(asked ? [count((s) => s === 0)] : [])] }),
    },
  ];
  if (asked) {
    const ratio = byStatus(sources, (s) => (s.residual !== null && s.sigma ? s.residual / s.sigma : null))([0, 1]);
    const limit = (by: number): Values => ratio.x.map(() => by);
    settings.push({
      title: t("sky.ratio"),
      unit: "σ",
      robust: true,
      include: [-3.5, 3.5],
      lines: dots.slice(0, 2),
      band: t("band"),
      load: async () => ({ x: ratio.x, y: [...ratio.y, limit(3), limit(-3)] }),
    });
  }
  return settings.map((s) => new TimePlot(s, linked));
}

function statistics(sources: Source[]): HTMLElement {
  const rows = sources.map((s) => {
    const used = s.seen.filter((x) => x.status === 0 && x.residual !== null);
    const rms = Math.sqrt(used.reduce((sum, x) => sum + x.residual! ** 2, 0) / used.length);
    const up = s.seen.map((x) => x.elevation);
    return [
      s.name,
      t(s.station ? "sky.station" : "sky.satellite"),
      `${number(Math.min(...up), 3)} … ${number(Math.max(...up), 3)}`,
      String(s.seen.length),
      String(used.length),
      String(s.seen.filter((x) => x.status === 1).length),
      used.length > 0 ? number(rms, 3) : "–",
    ];
  });
  const head = ["sky.source", "data.kind", "sky.elevation", "sky.epochs", "sky.used", "rejected", "sky.rms"];
  return table(head.map((x) => t(x)), rows, t("sky.table"));
}

export async function skyView(run: string, groups: Group[], linked: Linked): Promise<View> {
  const { sources, times } = await sourcesOf(run, groups.find((g) => g.group === "/sky")!);
  const spacing = times.length > 1 ? (times.at(-1)! - times[0]!) / (times.length - 1) : 1;
  const plots = plotsOf(sources, times, linked);
  linkCursors(plots, linked);
  const key = (status: number, text: string) => h("span", { class: "sky-key" }, h("span", { class: `swatch status-${status}` }), text);
  const element = h(
    "div",
    { class: "sky-grid-view" },
    h(
      "figure",
      { class: "plot sky-figure" },
      h("figcaption", null, h("span", { class: "plot-title" }, t("sky.title"))),
      new SkyPlot(sources, linked, spacing).element as unknown as HTMLElement,
      h("p", { class: "muted" }, key(0, t("sky.used")), key(1, t("rejected")), key(2, t("sky.unused")), " ", t("sky.hint")),
    ),
    h("div", { class: "plots" }, ...plots.map((p) => p.element)),
    statistics(sources),
  );
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}
