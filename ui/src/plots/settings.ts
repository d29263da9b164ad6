// What a plot is made of.
export interface Along {
  label: string;
  unit: string;
  /** Of the column in CSV. */
  name: string;
  log?: boolean;
}

export interface Line {
  label: string;
  ink?: number;
  dash?: number[];
  width?: number;
  /** Only points, no line: measurements. */
  dots?: boolean;
  /** A variable of the style sheet instead of a colour of the series: what has a fixed meaning. */
  paint?: string;
  /** On the axis at the right. */
  right?: boolean;
}

export interface Data {
  x: number[];
  /** One for each line, in order; then, for a band, its half width. */
  y: (number | null)[][];
  /** Every row was asked for, and they were too many. */
  thinned?: boolean;
}

export interface PlotSettings {
  title: string;
  unit: string;
  lines: Line[];
  /** Name of the band; the loader then gives lower and upper edge after the lines. */
  band?: string;
  height?: number;
  logY?: boolean;
  /** The range of y is that of nearly all values, not of the few largest ones; the plot says how many lie outside. */
  robust?: boolean;
  /** Not shown where it has no value at all: a solution without attitude has none of its sigmas. */
  optional?: boolean;
  /** Nothing in a range is no fault: measurements that were all withheld. */
  mayBeEmpty?: boolean;
  /** Of the axis at the right. */
  rightUnit?: string;
  /** Plots that follow one another with the same name here stand in one card over one axis of time. */
  stack?: string;
  /** Without an axis of time of its own: the plot below in the card has it. */
  bare?: boolean;
  /** Always inside the range of y. */
  include?: number[];
  /** Names that stand for 0, 1, 2 … along y. */
  names?: string[];
  /** What stands along x where that is not time. */
  along?: Along;
  load: (from: number | undefined, to: number | undefined, points: number, signal: AbortSignal) => Promise<Data>;
}
