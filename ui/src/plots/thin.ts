// Fewer rows for drawing, without a change of what is seen.
type Values = (number | null)[];

/** Of each of about `points` intervals the rows with the extremes of every column, the first gap, and the first and last row of all. */
export function thinned(time: number[], columns: Values[], points: number): { time: number[]; columns: Values[] } {
  const n = time.length;
  if (points <= 0 || n <= 2 * points) return { time, columns };
  const kept = new Set([0, n - 1]);
  for (let k = 0; k < points; ++k) {
    const begin = Math.floor((k * n) / points),
      end = Math.floor(((k + 1) * n) / points);
    for (const v of columns) {
      let least = -1,
        most = -1,
        gap = -1;
      for (let i = begin; i < end; ++i) {
        const x = v[i];
        if (x === null || x === undefined) {
          if (gap < 0) gap = i;
          continue;
        }
        if (least < 0 || x < v[least]!) least = i;
        if (most < 0 || x > v[most]!) most = i;
      }
      for (const i of [least, most, gap]) if (i >= 0) kept.add(i);
    }
  }
  const rows = [...kept].sort((a, b) => a - b);
  return { time: rows.map((i) => time[i]!), columns: columns.map((v) => rows.map((i) => v[i] ?? null)) };
}

export function sameTimes(a: number[], b: number[]): boolean {
  return a === b || (a.length === b.length && a.every((t, i) => t === b[i]));
}
