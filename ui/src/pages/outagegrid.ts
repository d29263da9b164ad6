// Windows without GNSS at regular intervals: how the errors grow, all along a log.

export interface Grid {
  /** Of each window, s. */
  length: number;
  /** From the beginning of one window to that of the next, s. */
  spacing: number;
  /** The first window begins that long after the start: the filter has to settle. */
  clear: number;
}

/** Windows as `--outage` takes them, T:DUR; all of them end before the log does. */
export function outageGrid(duration: number, { length, spacing, clear }: Grid): string[] {
  if (!(length > 0) || !(spacing > length) || !(clear >= 0)) return [];
  const most = 2000;
  const short = (x: number) => Number(x.toFixed(3));
  const out: string[] = [];
  for (let i = 0; out.length < most && clear + i * spacing + length <= duration; ++i) out.push(`${short(clear + i * spacing)}:${short(length)}`);
  return out;
}

/** The grid that a list of windows was made of; null where it is none. */
export function gridOf(windows: unknown): Grid | null {
  if (!Array.isArray(windows)) return null;
  const parts = windows.flatMap((w) => String(w).split(",")).map((w) => w.split(":").map(Number));
  if (parts.length < 2 || parts.some((p) => p.length !== 2 || !p.every(Number.isFinite))) return null;
  const [[clear, length], [second]] = parts as [[number, number], [number]];
  const spacing = Number((second - clear).toFixed(3));
  const regular = parts.every(([at, long], i) => long === length && Math.abs(at! - clear - i * spacing) < 2e-3 * (i + 1));
  return regular ? { length, spacing, clear } : null;
}

/** What a log of this length is offered: half a minute every three minutes, less where that would be few windows. */
export function usualGrid(duration: number): Grid {
  const part = Math.min(1, duration / 900);
  const round = (x: number) => Math.max(1, Math.round(x / 5) * 5);
  return { length: round(30 * part), spacing: round(180 * part), clear: round(120 * part) };
}
