// Signals made of signals: integral, derivative, low-pass, difference, norm.
type Values = (number | null)[];

export type Operation = "raw" | "integral" | "derivative" | "lowpass" | "mean";

/** `seconds`: of the low-pass. */
export function derived(time: number[], v: Values, operation: Operation, seconds: number): Values {
  switch (operation) {
    case "integral": {
      let sum = 0,
        last = -1;
      return v.map((x, i) => {
        if (x === null) return null;
        if (last >= 0) sum += 0.5 * (x + v[last]!) * (time[i]! - time[last]!);
        last = i;
        return sum;
      });
    }
    case "derivative":
      return v.map((x, i) => {
        const a = v[i - 1],
          dt = time[i]! - (time[i - 1] ?? NaN);
        return x === null || a === null || a === undefined || !(dt > 0) ? null : (x - a) / dt;
      });
    case "lowpass": {
      let y: number | null = null,
        at = 0;
      return v.map((x, i) => {
        if (x === null) return y;
        y = y === null ? x : y + (x - y) * (1 - Math.exp(-(time[i]! - at) / Math.max(seconds, 1e-9)));
        at = time[i]!;
        return y;
      });
    }
    case "mean": {
      const known = v.filter((x): x is number => x !== null);
      const mean = known.reduce((s, x) => s + x, 0) / Math.max(1, known.length);
      return v.map((x) => (x === null ? null : x - mean));
    }
    default:
      return v;
  }
}

export function norm(columns: Values[]): Values {
  return columns[0]!.map((_, i) => {
    let sum = 0;
    for (const c of columns) {
      const x = c[i];
      if (x === null || x === undefined) return null;
      sum += x * x;
    }
    return Math.sqrt(sum);
  });
}
