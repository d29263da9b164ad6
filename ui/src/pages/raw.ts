// The logs of a data set as they are, before anything is processed.
import { api, type Group, type Inspection, type Range, type Raw } from "../api";
import { h, replace } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { signalsView } from "./signals";
import { unit } from "./views";

const mostPlots = 24;

const isTable = (f: Inspection["files"][number]) => f.kind !== "unknown" && f.columns.length > 0 && f.rows > 1;

/** Columns that differ by an axis alone stand in one plot: gyro_x, gyro_y, gyro_z. */
function stem(name: string): string {
  return name.replace(/(^|_)(x|y|z|n|e|d|north|east|down|up|roll|pitch|yaw|heading|vn|ve|vd)(?=_|$)/, "$1*");
}

/** A log by ranges. Each range is read from the file anew: the plots of a card share what is read, one reading at a time. */
class RawLog {
  private readonly kept = new Map<string, { answer: Promise<Raw>; waiting: Set<AbortSignal> }>();
  private queue: Promise<unknown> = Promise.resolve();

  private constructor(
    private readonly dataset: string,
    private readonly file: string,
    readonly whole: Raw,
  ) {}

  static async of(dataset: string, file: string): Promise<RawLog> {
    return new RawLog(dataset, file, await api.raw(dataset, file));
  }

  rows(range: Range, signal: AbortSignal): Promise<Raw> {
    if (!this.whole.thinned || (range.from === undefined && range.points !== 0)) return Promise.resolve(this.whole);
    const key = [range.from, range.to, range.points].join();
    const known = this.kept.get(key);
    if (known) {
      known.waiting.add(signal);
      return known.answer;
    }
    const waiting = new Set([signal]);
    const answer = this.queue.then(() => {
      if ([...waiting].every((s) => s.aborted)) throw new DOMException("", "AbortError");
      // of all columns together
      const points = range.points === 0 ? 0 : Math.min(20_000, 8 * (range.points ?? 1000));
      return api.raw(this.dataset, this.file, { ...range, points });
    });
    this.queue = answer.catch(() => undefined);
    answer.catch(() => this.kept.delete(key));
    if (this.kept.size >= 8) this.kept.delete([...this.kept.keys()][0]!);
    this.kept.set(key, { answer, waiting });
    return answer;
  }
}

const timesOf = (raw: Raw, shift = 0) => raw.time_s.map((v, i) => (v ?? i) + shift);

/** Signals of all logs on one axis of time: logs that begin within a day of the first are shifted by their own times. */
export function rawSignals(dataset: string, found: Inspection): HTMLElement | null {
  const most = 12,
    day = 86_400;
  const files = found.files.filter(isTable).slice(0, most);
  if (files.length === 0) return null;
  const place = h("div");
  const show = async () => {
    replace(place, h("p", { class: "muted" }, t("raw.wait")));
    try {
      const of = new Map<string, { log: RawLog; shift: number }>();
      const groups: Group[] = [];
      let first: number | null = null;
      for (const f of files) {
        const log = await RawLog.of(dataset, f.path);
        const raw = log.whole;
        first ??= raw.zero;
        const shift = Math.abs(raw.zero - first) < day ? raw.zero - first : 0;
        const time_s = timesOf(raw, shift);
        const group = `/${f.path}`;
        of.set(group, { log, shift });
        groups.push({
          group,
          rows: raw.rows,
          start_s: time_s[0] ?? 0,
          stop_s: time_s.at(-1) ?? 0,
          columns: Object.entries(raw.columns)
            .filter(([, v]) => v.some((y) => y !== null))
            .map(([name]) => ({ id: `${group}/table:${name}`, name, unit: raw.units[name] ?? "" })),
        } as Group);
      }
      const start = Math.min(...groups.map((g) => g.start_s!));
      const linked = new Linked(start, Math.max(start + 1e-6, ...groups.map((g) => g.stop_s!)));
      const view = await signalsView(dataset, groups, linked, async (ids, range, signal) => {
        const [group = "", ...names] = [ids[0]!.slice(0, ids[0]!.lastIndexOf("/table:")), ...ids.map((id) => id.slice(id.lastIndexOf("/table:") + 7))];
        const { log, shift } = of.get(group)!;
        const moved = range.from === undefined || range.to === undefined ? range : { ...range, from: range.from - shift, to: range.to - shift };
        const raw = await log.rows(moved, signal);
        return { time_s: timesOf(raw, shift), columns: Object.fromEntries(ids.map((id, i) => [id, raw.columns[names[i]!]!])), thinned: raw.thinned };
      });
      replace(place, view.element);
    } catch (e) {
      replace(place, h("p", { class: "bad", role: "alert" }, (e as Error).message));
    }
  };
  const card: HTMLElement = h("details", { class: "card raw-signals" }, h("summary", null, t("raw.signals")), place);
  card.addEventListener("toggle", () => place.children.length === 0 && void show());
  return card;
}

export function rawCard(dataset: string, found: Inspection): HTMLElement | null {
  const files = found.files.filter(isTable);
  if (files.length === 0) return null;
  const place = h("div");
  const choice = h("select", { "aria-label": t("data.file"), onChange: () => void show() }, ...files.map((f) => h("option", { value: f.path }, `${f.path} (${f.kind})`)));
  const show = async () => {
    replace(place, h("p", { class: "muted" }, t("raw.wait")));
    try {
      const log = await RawLog.of(dataset, choice.value);
      const raw = log.whole;
      const x = timesOf(raw);
      const linked = new Linked(x[0] ?? 0, Math.max(x.at(-1) ?? 1, (x[0] ?? 0) + 1e-6));
      const groups = new Map<string, string[]>();
      for (const [name, v] of Object.entries(raw.columns))
        if (v.some((y) => y !== null)) groups.set(stem(name), [...(groups.get(stem(name)) ?? []), name]);
      const plots = [...groups].slice(0, mostPlots).map(
        ([title, names]) =>
          new TimePlot(
            {
              title: names.length > 1 ? title.replace(/_?\*_?/, "_").replace(/^_|_$/g, "") : names[0]!,
              unit: [...new Set(names.map((n) => unit(raw.units[n] ?? "")))].join(", "),
              height: 150,
              lines: names.map((label, ink) => ({ label, ink })),
              load: async (from, to, points, signal) => {
                const now = await log.rows({ from, to, points }, signal);
                return { x: timesOf(now), y: names.map((n) => now.columns[n]!), thinned: points === 0 && now.thinned };
              },
            },
            linked,
          ),
      );
      linkCursors(plots, linked);
      replace(place, h("p", { class: "muted" }, t("raw.lead", { n: raw.rows, time: raw.time, zero: number(raw.zero, 10) })), h("div", { class: "plots" }, ...plots.map((p) => p.element)));
    } catch (e) {
      replace(place, h("p", { class: "bad", role: "alert" }, (e as Error).message));
    }
  };
  const card: HTMLElement = h("details", { class: "card" }, h("summary", null, t("raw.title")), h("p", { class: "form-tools" }, choice), place);
  card.addEventListener("toggle", () => place.children.length === 0 && void show());
  return card;
}
