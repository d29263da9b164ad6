// The first page of a run: is it good, where was it bad, and what is that judged by.
import { api, type Group, type RunDetails } from "../api";
import { h, replace } from "../dom";
import { maybe, number, t } from "../i18n";
import { HealthLine } from "../plots/healthline";
import { Linked } from "../plots/linked";
import { PlanView, type Track2d } from "../plots/plan";
import { TimePlot, linkCursors, stacked } from "../plots/timeplot";
import { attitudePlots } from "./attitude";
import { eventList, type Happening } from "./events";
import { factsCard } from "./facts";
import { overview, statCards } from "./overview";
import type { View } from "./track";
import { said } from "../reasons";
import { loader, unit } from "./views";

type Values = (number | null)[];

/** Of core's fix types: none, autonomous, differential, fixed, float, unknown. */
const fixPaints = ["--fix-none", "--fix-single", "--fix-differential", "--fix-fixed", "--fix-float", "--fix-unknown"];
const fixNames = ["none", "single", "differential", "fixed", "float", "unknown"];

function percent(x: unknown): string {
  return typeof x === "number" ? `${number(100 * x, 3)} %` : "–";
}

function verdictCard(run: RunDetails): HTMLElement | null {
  const v = run.summary?.verdict;
  const c = run.summary?.self_check as Record<string, number | null> | null | undefined;
  if (!v && !c) return null;
  const kind = !v || v.word === "trustworthy" ? "good" : v.word === "care" ? "care" : "poor";
  const sign = { good: "✓", care: "⚠", poor: "✗" }[kind];
  return h(
    "section",
    { class: `card verdict ${kind}` },
    h("h3", null, t("quality.verdict")),
    v && h("p", { class: "verdict-word" }, `${sign} ${maybe(`verdict.${v.word}`, v.word)}`),
    v && v.reasons.length > 0 && h("ul", null, ...v.reasons.map((r) => h("li", null, said(r)))),
    c &&
      h(
        "p",
        null,
        t("quality.check", {
          windows: c["windows"] ?? 0,
          length: number(c["length_s"] ?? null),
          inside: percent(c["inside_3sigma_epochs"]),
          horizontal: percent(c["inside_3sigma_horizontal"]),
          vertical: percent(c["inside_3sigma_vertical"]),
          error: number(c["end_rms_m"] ?? null, 3),
          sigma: number(c["sigma_rms_m"] ?? null, 3),
        }),
      ),
  );
}

/** How errors grow without fixes, as the self-check measured it, beside what the filter said. */
function growthPlot(run: RunDetails): TimePlot | null {
  const growth = (run.summary?.self_check as { growth?: Record<string, number>[] } | null | undefined)?.growth;
  if (!growth || growth.length < 2) return null;
  const x = growth.map((g) => g["since_s"]!);
  return new TimePlot(
    {
      title: t("quality.growth"),
      unit: "m",
      include: [0],
      lines: [
        { label: t("quality.growth_error"), ink: 1, dots: false },
        { label: t("quality.growth_sigma"), ink: 0, dash: [6, 4] },
      ],
      along: { label: t("quality.since"), unit: "s", name: "since_s" },
      load: async () => ({ x, y: [growth.map((g) => g["error_rms_m"] ?? null), growth.map((g) => g["sigma_rms_m"] ?? null)] }),
    },
    new Linked(x[0]!, x.at(-1)!),
  );
}

/** The first position of a run, from which its local columns are counted. */
export async function planeOf(run: string): Promise<{ lat: number; lon: number } | null> {
  const [lat, lon] = ["/solution/position:lat", "/solution/position:lon"];
  const s = await api.series(run, [lat!, lon!], { points: 2 });
  const [a, b] = [s.columns[lat!]?.[0], s.columns[lon!]?.[0]];
  return typeof a === "number" && typeof b === "number" ? { lat: a, lon: b } : null;
}

/** The map, whose tracks come when they are there. */
function map(run: RunDetails, groups: Group[], linked: Linked): PlanView | null {
  if (!groups.some((x) => x.group === "/solution")) return null;
  const plan = new PlanView(linked, 430);
  drawMap(plan, run, groups).catch((e: Error) => replace(plan.element, h("p", { class: "bad", role: "alert" }, e.message)));
  return plan;
}

async function drawMap(plan: PlanView, run: RunDetails, groups: Group[]): Promise<void> {
  const has = (g: string) => groups.some((x) => x.group === g);
  const local = async (group: string, more: string[] = []) => {
    const s = await api.series(run.id, [`${group}/local:east`, `${group}/local:north`, ...more], { points: 2500 });
    return { time: s.time_s, east: s.columns[`${group}/local:east`]!, north: s.columns[`${group}/local:north`]!, columns: s.columns };
  };
  const gnss = groups.find((g) => g.group === "/gnss");
  const quality = "/gnss/quality:fix";
  const known = gnss?.columns.some((c) => c.id === quality) ?? false;
  const [solution, reference, g, plane] = await Promise.all([
    local("/solution"),
    has("/reference") ? local("/reference") : null,
    gnss ? local("/gnss", known ? [quality] : []) : null,
    planeOf(run.id),
  ]);
  const tracks: Track2d[] = [{ label: t("track.solution"), ink: 0, ...solution }];
  if (reference) tracks.push({ label: t("track.reference"), ink: 2, ...reference });
  if (g) {
    const fixes = (g.columns[quality] ?? []) as Values;
    tracks.push({ label: t("track.gnss"), ink: 1, dots: true, ...g, ...(known ? { paints: fixes.map((f) => fixPaints[f ?? 5] ?? "--muted") } : {}) });
    if (known) {
      const count = new Map<number, number>();
      for (const f of fixes) if (f !== null) count.set(f, (count.get(f) ?? 0) + 1);
      plan.element.append(
        h(
          "p",
          { class: "legend fix-legend" },
          ...[...count.keys()].sort().map((f) => h("span", null, h("span", { class: "dot", style: `background:var(${fixPaints[f] ?? "--muted"})` }), t(`fix.${fixNames[f] ?? "unknown"}`))),
        ),
      );
    }
  }
  plan.show(tracks);
  if (plane) void plan.lie(plane);
}

function sigmaPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const g = groups.find((x) => x.group === "/solution");
  if (!g) return [];
  return ["position", "velocity", "attitude"].flatMap((table) => {
    const columns = g.columns.filter((c) => c.id.startsWith(`/solution/std_${table}:`));
    if (columns.length === 0) return [];
    return [
      new TimePlot(
        {
          title: t("view.sigma_of", { what: t(`view.${table}`), axis: "" }).replace(/[ ,:]+$/, ""),
          unit: unit(columns[0]!.unit),
          logY: true,
          height: 165,
          optional: true,
          lines: columns.map((c, ink) => ({ label: t(c.name), ink })),
          load: loader(run, columns.map((c) => c.id), (all) => all.map((v) => v.map((x) => (x !== null && x > 0 ? x : null)))),
        },
        linked,
      ),
    ];
  });
}

/** Carrier phase against a base: how sure the ambiguities are, and what they rest on. */
function carrierPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  if (!groups.some((g) => g.group === "/carrier")) return [];
  const id = (name: string) => `/carrier/table:${name}`;
  const plot = (title: string, u: string, names: [string, string][], more: { logY?: boolean; include?: number[] }) =>
    new TimePlot(
      {
        title,
        unit: u,
        height: 165,
        ...more,
        optional: true,
        lines: names.map(([, label], ink) => ({ label, ink })),
        load: loader(run, names.map(([name]) => id(name)), (all) => all.map((v) => v.map((x) => (more.logY && x !== null && x <= 0 ? null : x)))),
      },
      linked,
    );
  return [
    plot(t("carrier.ratio"), "1", [["ratio", t("carrier.ratio")]], { logY: true }),
    plot(t("carrier.counts"), "1", [["satellites", t("carrier.satellites")], ["ambiguities", t("carrier.ambiguities")], ["fixed", t("carrier.fixed_ambiguities")]], { include: [0] }),
    plot(t("carrier.baseline"), "m", [["north_m", t("north")], ["east_m", t("east")], ["up_m", t("up")]], {}),
  ];
}

/** Forward minus backward inside three sigma. */
export function separationPlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const g = groups.find((x) => x.group === "/separation");
  if (!g) return [];
  return ["position", "velocity", "attitude"]
    .flatMap((table) => g.columns.filter((c) => c.id.includes(`/${table}:`)))
    .map((c, i) => {
      const sigma = c.id.replace(/\/(\w+):/, "/std_$1:");
      return new TimePlot(
        {
          title: `${t("quality.separation")}: ${t(`view.${/\/(\w+):/.exec(c.id)![1]!}`)} ${t(c.name)}`,
          unit: unit(c.unit),
          lines: [{ label: t("quality.separation"), ink: i % 3 }],
          band: t("band"),
          include: [0],
          robust: true,
          stack: `separation ${/\/(\w+):/.exec(c.id)![1]!}`,
          height: 165,
          load: loader(run, [c.id, sigma], ([v, s]) => [v!, s!.map((x) => (x === null ? null : 3 * x)), s!.map((x) => (x === null ? null : -3 * x))]),
        },
        linked,
      );
    });
}

/** Three sigma of the windows one by one: the band does not go from one window to the next. */
export function windowBand(sigma: Values, window: Values): Values {
  return sigma.map((x, i) => (x === null || (i > 0 && window[i] !== window[i - 1]) ? null : 3 * x));
}

/** Solution minus withheld fix, inside three sigma. */
export function outagePlots(run: string, groups: Group[], linked: Linked): TimePlot[] {
  const columns = groups.find((x) => x.group === "/outages")?.columns.filter((c) => c.id.startsWith("/outages/error:")) ?? [];
  return columns.map(
    (c, ink) =>
      new TimePlot(
        {
          title: `${t("quality.outage_errors", { what: t("view.position") })}, ${t(c.name)}`,
          unit: unit(c.unit),
          include: [0],
          height: 165,
          optional: true,
          stack: "outages",
          band: t("band"),
          lines: [{ label: t(c.name), ink, dots: true }],
          load: loader(run, [c.id, c.id.replace("/error:", "/sigma:"), "/outages/outage:outage"], ([v, s, w]) => {
            const band = windowBand(s!, w!);
            return [v!, band, band.map((x) => (x === null ? null : -x))];
          }),
        },
        linked,
      ),
  );
}

export function qualityView(run: RunDetails, groups: Group[], linked: Linked, others: Promise<{ id: string; title: string }[]>, happened: Promise<Happening[]>): View {
  const plan = map(run, groups, linked);
  // every row of every gate is looked at for them: the page does not wait
  const events = h("div", null, plan && h("section", { class: "card" }, h("h3", null, t("event.title")), h("p", { class: "muted" }, t("event.wait"))));
  void happened.then(
    (all) => replace(events, (all.length > 0 || plan) && eventList(all, linked)),
    (e: Error) => replace(events, h("p", { class: "bad", role: "alert" }, e.message)),
  );
  const plots = [
    ...outagePlots(run.id, groups, linked),
    ...separationPlots(run.id, groups, linked),
    ...sigmaPlots(run.id, groups, linked),
    ...carrierPlots(run.id, groups, linked),
    ...attitudePlots(run.id, groups, linked),
  ];
  linkCursors(plots, linked);
  const growth = growthPlot(run);
  if (growth) linkCursors([growth], growth.linked);
  const figures = overview(run);
  const health = (run.summary?.health?.length ?? 0) > 0 ? new HealthLine(run.summary!.health!, linked) : null;
  const element = h(
    "div",
    { class: "quality" },
    statCards(run),
    h(
      "div",
      { class: "quality-grid" },
      h("div", { class: "quality-left" }, verdictCard(run), plan?.element, health?.element, events, !plan && figures),
      h("div", { class: "quality-right" }, growth?.element, ...stacked(plots)),
    ),
    factsCard(run, others),
    plan && figures,
  );
  return { element, redraw: () => [...plots, plan, health, growth].forEach((p) => p?.redraw()) };
}
