// What the plots of one page share: the range of time, the cursor, the outages.
export interface Span {
  from: number;
  to: number;
  label: string;
}

/** Something that happened at a time. */
export interface Mark {
  at: number;
  label: string;
  /** A variable of the style sheet. */
  paint: string;
}

/** The number of the first of ascending times that is not before `at`; their number where there is none. */
export function firstFrom(times: number[], at: number): number {
  let low = 0,
    high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! < at) low = middle + 1;
    else high = middle;
  }
  return low;
}

export class Linked {
  from: number;
  to: number;
  cursor: number | null = null;
  spans: Span[] = [];
  marks: Mark[] = [];
  private readonly rangeListeners = new Set<() => void>();
  private readonly cursorListeners = new Set<() => void>();

  constructor(
    public start: number,
    public stop: number,
  ) {
    this.from = start;
    this.to = stop;
  }

  get zoomed(): boolean {
    return this.from > this.start || this.to < this.stop;
  }

  /** Sets the range that all plots show; kept inside what there is. */
  set(from: number, to: number): void {
    const all = Math.max(this.stop - this.start, 1e-9);
    let span = Math.min(Math.max(to - from, all * 1e-7), all);
    if (!(span > 0)) span = all;
    const left = Math.min(Math.max(from, this.start), this.stop - span);
    if (left === this.from && left + span === this.to) return;
    this.from = left;
    this.to = left + span;
    for (const each of this.rangeListeners) each();
  }

  /** There is more now, or what was first is gone; a range that showed everything goes on doing so. */
  extend(start: number, stop: number): void {
    const everything = !this.zoomed;
    this.start = start;
    this.stop = stop;
    if (!everything) return this.set(this.from, this.to);
    this.from = start;
    this.to = stop;
    for (const each of this.rangeListeners) each();
  }

  reset(): void {
    this.set(this.start, this.stop);
  }

  /** Zooms about a time; factor below 1 comes closer. */
  zoom(factor: number, about = this.cursor ?? (this.from + this.to) / 2): void {
    const at = Math.min(Math.max(about, this.from), this.to);
    this.set(at - (at - this.from) * factor, at + (this.to - at) * factor);
  }

  /** Moves by a part of what is shown. */
  pan(part: number): void {
    const by = (this.to - this.from) * part;
    const left = Math.min(Math.max(this.from + by, this.start), this.stop - (this.to - this.from));
    this.set(left, left + this.to - this.from);
  }

  point(time: number | null): void {
    if (time === this.cursor) return;
    this.cursor = time;
    for (const each of this.cursorListeners) each();
  }

  onRange(f: () => void): void {
    this.rangeListeners.add(f);
  }

  onCursor(f: () => void): void {
    this.cursorListeners.add(f);
  }

  /** One frame at a time, however often it is asked for. */
  static perFrame(f: () => void): () => void {
    let asked = false;
    return () => {
      if (asked) return;
      asked = true;
      requestAnimationFrame(() => {
        asked = false;
        f();
      });
    };
  }
}
