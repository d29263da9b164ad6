// What happened in a run: fixes refused and excluded, gaps, restarts, outages, rests and wheels that were recognised. A list, and marks on
// every time axis.
import { api, type Group, type Health, type RunDetails, type Series } from "../api";
import { h } from "../dom";
import { maybe, number, t } from "../i18n";
import { sourceName } from "../plots/healthline";
import type { Linked, Mark } from "../plots/linked";

export interface Happening {
  from: number;
  to: number;
  what: string;
  note: string;
  paint: string;
}

type Values = (number | null)[];

/** Times that follow one another closer than `gap`, as spans. */
export function spansOf(times: number[], gap: number): { from: number; to: number; n: number }[] {
  const out: { from: number; to: number; n: number }[] = [];
  for (const time of times) {
    const last = out.at(-1);
    if (last && time - last.to <= gap) (last.to = time), ++last.n;
    else out.push({ from: time, to: time, n: 1 });
  }
  return out;
}

export function usualStep(times: number[]): number {
  const steps = times.slice(1).map((v, i) => v - times[i]!).filter((d) => d > 0).sort((a, b) => a - b);
  return steps[Math.floor(steps.length / 2)] ?? 1;
}

async function gates(run: string, g: Group): Promise<{ times: number[]; status: Values } | null> {
  const id = g.columns.find((c) => c.id.startsWith(`${g.group}/gate:status`))?.id;
  if (!id) return null;
  const s: Series = await api.series(run, [id], { points: 0 });
  return { times: s.time_s, status: s.columns[id]! };
}

/** Kinds that say something about the vehicle by being used at all. */
const recognised = ["zero_velocity", "zero_rate", "nonholonomic"];

/** What a finding about a receiver's channel means for its use. */
function findingText(test: string, channel: string): string {
  if (test === "readmitted") return t("event.readmitted", { channel });
  if (test === "unjudged") return t("event.unjudged", { channel });
  return t("event.alert", { channel });
}

/** Gaps, and what was left out before the run; what gates and the integrity monitor did is in their own records. */
export function ofHealth(health: Health[]): Happening[] {
  const of = (x: Health): Pick<Happening, "what" | "paint"> | null => {
    if (x.source === "imu" && x.state === "silent") return { what: t("event.imu_gap"), paint: "--warn" };
    if (x.state === "silent") return { what: x.source === "gnss_position" ? t("event.gap") : t("event.silent", { name: sourceName(x.source) }), paint: "--warn" };
    if (x.state === "hanging") return { what: t("event.hanging", { name: sourceName(x.source) }), paint: "--warn" };
    if (x.state === "left out") return { what: t("event.left_out", { name: sourceName(x.source) }), paint: "--ink-4" };
    return null;
  };
  return health.flatMap((x) => {
    const what = of(x);
    return what ? [{ from: x.from_s, to: x.to_s, note: x.samples > 0 ? t("event.n", { n: x.samples }) : "", ...what }] : [];
  });
}

/** Where the navigation began anew: after a pause of the log, or after it had diverged. */
async function restarts(run: string, groups: Group[]): Promise<Happening[]> {
  const leg = groups.find((g) => g.group === "/solution")?.columns.find((c) => c.id.startsWith("/solution/leg:"));
  if (!leg) return [];
  const s = await api.series(run, [leg.id], { points: 0 });
  const legs = s.columns[leg.id]!;
  return s.time_s.filter((_, i) => i > 0 && legs[i] !== legs[i - 1]).map((at) => ({ from: at, to: at, what: t("event.restart"), note: "", paint: "--warn" }));
}

export async function happenings(run: RunDetails, groups: Group[]): Promise<Happening[]> {
  const out: Happening[] = [];
  const s = run.summary;
  const aligned = s?.findings?.["aligned_at_s"];
  const alignment = s?.findings?.["alignment"];
  if (typeof aligned === "number")
    out.push({ from: aligned, to: aligned, what: t("event.aligned"), note: typeof alignment === "string" ? alignment : "", paint: "--good" });
  out.push(...ofHealth(s?.health ?? []), ...(await restarts(run.id, groups)));
  for (const o of s?.outages ?? [])
    out.push({
      from: o.start_s,
      to: o.start_s + o.duration_s,
      what: t("event.outage"),
      note: o.max_horizontal_m === null ? "" : `${t("table.max_h")} ${number(o.max_horizontal_m, 3)} m`,
      paint: "--warn",
    });
  for (const a of s?.integrity?.alerts ?? [])
    out.push({
      from: a.time_s,
      to: a.time_s,
      what: findingText(a.test, maybe(`aid.${a.channel}`, a.channel)),
      note: a.size === null ? a.test : `${a.test}, ${number(a.size, 3)}`,
      paint: a.test === "readmitted" ? "--good" : a.test === "unjudged" ? "--warn" : "--rejected",
    });
  await Promise.all(
    groups
      .filter((g) => g.group.startsWith("/innovations/"))
      .map(async (g) => {
        const kind = g.group.split("/")[2]!;
        const found = await gates(run.id, g);
        if (!found) return;
        const name = maybe(`aid.${kind}`, kind.replaceAll("_", " "));
        const step = usualStep(found.times);
        const at = (status: number) => found.times.filter((_, i) => found.status[i] === status);
        for (const span of spansOf(at(3), 3 * step + 0.01))
          out.push({ ...span, what: t("event.excluded", { name }), note: t("event.n", { n: span.n }), paint: "--excluded" });
        for (const span of spansOf(at(1), 3 * step + 0.01))
          out.push({ ...span, what: t("event.rejected", { name }), note: t("event.n", { n: span.n }), paint: "--rejected" });
        if (recognised.includes(kind))
          for (const span of spansOf(at(0), Math.max(2.5, 3 * step)))
            if (kind !== "zero_rate") out.push({ ...span, what: name, note: t("event.n", { n: span.n }), paint: "--good" });
      }),
  );
  // runs without health: from the fixes themselves
  if (!s?.health && groups.some((g) => g.group === "/gnss")) {
    const { time_s } = await api.series(run.id, ["/gnss/position:height"], { points: 0 });
    const step = usualStep(time_s);
    time_s.slice(1).forEach((time, i) => {
      if (time - time_s[i]! > Math.max(2.5, 3.5 * step)) out.push({ from: time_s[i]!, to: time, what: t("event.gap"), note: "", paint: "--warn" });
    });
  }
  return out.sort((a, b) => a.from - b.from);
}

/** The most that is marked: more would cover one another. */
export const mostMarks = 600;

/** The beginnings of what happened; of too many, rests and wheels are left out first. */
export function marksOf(all: Happening[], most = mostMarks): Mark[] {
  const grave = all.filter((e) => e.paint !== "--good");
  return (all.length <= most ? all : grave.slice(0, most)).map((e) => ({ at: e.from, label: e.what, paint: e.paint }));
}

export function eventList(all: Happening[], linked: Linked): HTMLElement {
  const most = 300;
  const row = (e: Happening) => {
    const go = () => {
      const room = Math.max(5, 0.5 * (e.to - e.from), 0.01 * (linked.stop - linked.start));
      linked.set(e.from - room, e.to + room);
      linked.point(e.from);
    };
    return h(
      "tr",
      null,
      h("td", { class: "figure" }, h("button", { type: "button", class: "link", title: t("event.show"), onClick: go }, number(e.from, 6))),
      h("td", { class: "figure" }, e.to > e.from ? number(e.to - e.from, 3) : ""),
      h("td", null, h("span", { class: "dot", style: `background:var(${e.paint})` }), e.what),
      h("td", { class: "muted" }, e.note),
    );
  };
  const body = h("tbody", null, ...all.slice(0, most).map(row));
  const cut: HTMLElement = h(
    "p",
    { class: "muted cut", hidden: all.length <= most },
    `${t("event.cut", { n: most, all: all.length })} `,
    h("button", { type: "button", onClick: () => (body.append(...all.slice(most).map(row)), (cut.hidden = true)) }, t("event.all", { n: all.length })),
  );
  const marked = marksOf(all).length;
  return h(
    "section",
    { class: "card" },
    h("h3", null, `${t("event.title")} (${all.length})`),
    marked < all.length && h("p", { class: "muted" }, t("event.marks_cut", { n: marked, all: all.length })),
    cut,
    all.length === 0
      ? h("p", { class: "muted" }, t("event.none"))
      : h(
          "div",
          { class: "scroll event-list", tabIndex: 0 },
          h(
            "table",
            null,
            h("thead", null, h("tr", null, ...[`${t("table.at")}`, `${t("table.length")}`, t("event.what"), ""].map((x, i) => h("th", { scope: "col", class: i < 2 ? "figure" : "" }, x || h("span", { class: "hidden" }, t("event.note")))))),
            body,
          ),
        ),
  );
}
