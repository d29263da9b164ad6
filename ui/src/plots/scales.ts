// What the axes of a plot show.
import type uPlot from "uplot";
import type { Linked } from "./linked";

/** Powers of ten on a logarithmic axis; where it has less than two of them, 2 and 5 times those too. */
export const powers: Partial<uPlot.Axis> = {
  splits: (_, __, min, max) => {
    const out: number[] = [];
    const steps = Math.log10(max / min) < 2 ? [1, 2, 5] : [1];
    for (let p = Math.floor(Math.log10(min)); p <= Math.log10(max) + 1e-9; ++p)
      for (const k of steps) out.push(k * 10 ** p);
    const inside = out.filter((v) => v >= min * (1 - 1e-9) && v <= max * (1 + 1e-9));
    if (inside.length > 1) return inside;
    // hardly a power of ten is shown: round numbers as on a linear axis
    const raw = (max - min) / 4,
      power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((m) => m >= raw) ?? raw;
    const round: number[] = [];
    for (let v = Math.ceil(min / step) * step; v <= max * (1 + 1e-9); v += step) round.push(Number(v.toPrecision(8)));
    return round;
  },
  filter: (_, splits) => splits,
  values: (_, splits) => splits.map((v) => String(Number(v.toPrecision(3)))),
};

/** A name at each whole number. */
export function named(names: string[]): Partial<uPlot.Axis> {
  return {
    splits: () => names.map((_, i) => i),
    filter: (_, splits) => splits,
    values: () => names,
    size: 24 + 7.5 * Math.max(...names.map((n) => n.length)),
  };
}

/**
 * Limits that leave out one value in a hundred where those are far from the others, and how many of the lines' values (not of the
 * band's) lie outside of them.
 */
export function usualLimits(
  data: { x: number[]; y: (number | null)[][] },
  lines: number,
  { from, to }: Linked,
  min: number,
  max: number,
): { limits: [number, number]; outside: number } {
  const seen = (i: number) => data.x[i]! >= from && data.x[i]! <= to;
  const values: number[] = [];
  for (const y of data.y) y.forEach((v, i) => v !== null && seen(i) && values.push(v));
  if (values.length < 100) return { limits: [min, max], outside: 0 };
  // at every frame of a movement: sorted as numbers, which is ten times as quick as by a function
  const sorted = Float64Array.from(values).sort();
  const low = sorted[Math.floor(0.01 * sorted.length)]!,
    high = sorted[Math.ceil(0.99 * sorted.length) - 1]!;
  const room = 0.6 * (high - low);
  const limits: [number, number] = [Math.max(min, low - room), Math.min(max, high + room)];
  const beyond = (v: number | null) => v !== null && (v < limits[0] || v > limits[1]);
  const outside = data.y.slice(0, lines).reduce((n, y) => n + y.filter((v, i) => beyond(v) && seen(i)).length, 0);
  return { limits, outside };
}
