// The numbers of signals: columns as the server has them, and what is computed of them. What is computed is computed of every row: of
// the extremes of intervals a derivative or a mean would be another number.
import type { Range } from "../api";
import { derived, norm, type Operation } from "../plots/derive";
import { firstFrom } from "../plots/linked";
import type { Data } from "../plots/settings";
import { sameTimes, thinned } from "../plots/thin";
import { withoutJumps } from "./attitude";
import { resampled } from "./views";

type Values = (number | null)[];

export interface Signal {
  /** Of /channels; "norm:/group/table" for the length of a vector. */
  id: string;
  right?: boolean;
  operation?: Operation;
  seconds?: number;
  /** What is subtracted from it. */
  minus?: string;
}

/** Where the numbers of signals come from: of a run, or of raw logs. `points` 0: every row, if they are not too many. */
export type Source = (ids: string[], range: Range, signal: AbortSignal) => Promise<{ time_s: number[]; columns: Record<string, Values>; thinned?: boolean }>;

/** They pass from one end of their range to the other, which is no line across the plot. */
const angles = /:(roll|yaw|heading|lon|course)(_deg)?$/;

/** Whether a signal is computed, or a column as it is. */
export function isComputed(s: Signal, columns: number): boolean {
  return columns > 1 || s.minus !== undefined || (s.operation ?? "raw") !== "raw";
}

/** The rows that the signal in a range depends on: an integral and a mean on all, a low-pass on those of some time constants before. */
export function neededRange(s: Signal, from: number | undefined, to: number | undefined): Range {
  if (from === undefined || to === undefined || s.operation === "integral" || s.operation === "mean") return {};
  const decayed = 8; // e^-8 of what was before is left
  return s.operation === "lowpass" ? { from: from - decayed * (s.seconds ?? 1), to } : { from, to };
}

interface Computed {
  time: number[];
  values: Values;
  /** It was computed of extremes: there are too many rows. */
  thinned: boolean;
}

/** What draws signals: `parts` tells the columns of an id. */
export function signalLoader(source: Source, parts: (id: string) => string[]) {
  // an integral asks for the whole log again and again while one zooms
  const whole = new Map<string, ReturnType<Source>>();
  const ask = (ids: string[], range: Range, signal: AbortSignal): ReturnType<Source> => {
    if (range.from !== undefined || range.points !== 0) return source(ids, range, signal);
    const key = ids.join();
    const known = whole.get(key);
    if (known) return known;
    // not ended with the plot that asked first: others wait for it too
    const asked = source(ids, range, new AbortController().signal);
    asked.catch(() => whole.delete(key));
    if (whole.size >= 6) whole.delete([...whole.keys()][0]!);
    whole.set(key, asked);
    return asked;
  };
  const column = async (id: string, range: Range, signal: AbortSignal): Promise<Computed> => {
    const ids = parts(id);
    const s = await ask(ids, range, signal);
    const columns = ids.map((p) => s.columns[p]!);
    const v = columns.length > 1 ? norm(columns) : columns[0]!;
    return { time: s.time_s, values: angles.test(id) ? withoutJumps(v) : v, thinned: s.thinned ?? false };
  };
  const one = async (s: Signal, from: number | undefined, to: number | undefined, points: number, signal: AbortSignal): Promise<Computed> => {
    if (!isComputed(s, parts(s.id).length)) {
      const plain = await column(s.id, { from, to, points }, signal);
      return { ...plain, thinned: points === 0 && plain.thinned };
    }
    const range = { ...neededRange(s, from, to), points: 0 };
    const a = await column(s.id, range, signal);
    let v = a.values,
      few = a.thinned;
    if (s.minus) {
      const b = await column(s.minus, range, signal);
      const other = resampled(b.time, b.values, a.time);
      v = v.map((x, i) => (x === null || other[i] === null || other[i] === undefined ? null : x - other[i]!));
      few ||= b.thinned;
    }
    const made = derived(a.time, v, s.operation ?? "raw", s.seconds ?? 1);
    // one row beyond each end: the line reaches the edges of the plot
    const first = from === undefined ? 0 : Math.max(0, firstFrom(a.time, from) - 1);
    const last = to === undefined ? a.time.length : firstFrom(a.time, to) + 1;
    return { time: a.time.slice(first, last), values: made.slice(first, last), thinned: few };
  };
  return (signals: Signal[]) =>
    async (from: number | undefined, to: number | undefined, points: number, signal: AbortSignal): Promise<Data> => {
      const all = await Promise.all(signals.map((s) => one(s, from, to, points, signal)));
      if (all.length === 0) return { x: [], y: [] };
      const few = all.some((a) => a.thinned);
      if (all.every((a) => sameTimes(a.time, all[0]!.time))) {
        const { time, columns } = thinned(all[0]!.time, all.map((a) => a.values), points);
        return { x: time, y: columns, thinned: few };
      }
      const each = all.map((a) => thinned(a.time, [a.values], points));
      const x = [...new Set(each.flatMap((a) => a.time))].sort((a, b) => a - b);
      return { x, y: each.map((a) => resampled(a.time, a.columns[0]!, x)), thinned: few };
    };
}
