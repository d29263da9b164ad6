// A plot's settings as the drawing library wants them: series, scales, axes.
import type uPlot from "uplot";
import { css } from "../dom";
import { t } from "../i18n";
import { colour, faded } from "./colours";
import { named, powers } from "./scales";
import type { PlotSettings } from "./settings";

const short = (v: number | null) => (v === null || v === undefined ? "–" : Number(v.toPrecision(5)).toString());

export function seriesOf(s: PlotSettings, hidden: Set<number>): { series: uPlot.Series[]; bands: uPlot.Band[] } {
  const along = s.along;
  const series: uPlot.Series[] = [
    {
      label: along?.label ?? t("plot.time"),
      value: (_, v) => (v === null ? "–" : along ? `${short(v)} ${along.unit}` : v.toFixed(2) + " s"),
    },
  ];
  const bands: uPlot.Band[] = [];
  if (s.band) {
    const first = series.length;
    const stroke = faded(css("--band"), 0.9);
    series.push({ label: s.band, stroke, width: 1, points: { show: false }, value: (_, v) => short(v) });
    series.push({ label: "−" + s.band, stroke, width: 1, points: { show: false }, class: "quiet" });
    bands.push({ series: [first, first + 1], fill: faded(css("--band"), 0.28) });
  }
  s.lines.forEach((line, i) => {
    const stroke = colour(line.label, line.ink ?? i, line.paint);
    series.push({
      label: line.label,
      stroke,
      width: line.width ?? 1.4,
      ...(line.dash ? { dash: line.dash } : {}),
      ...(line.dots ? { paths: () => null, points: { show: true, size: 5, fill: stroke, width: 0 } } : { points: { show: false } }),
      show: !hidden.has(i),
      ...(line.right ? { scale: "y2" } : {}),
      value: (_, v) => short(v),
    });
  });
  return { series, bands };
}

/** Limits of y; `robust` may narrow them. */
export function limitsOf(
  s: PlotSettings,
  low: number | null,
  high: number | null,
  robust: (min: number, max: number) => [number, number],
): [number, number] {
  let [min, max] = [low, high];
  if (s.names) return [-0.6, s.names.length - 0.4];
  if (s.logY) return s.along ? [(min ?? 1e-3) / 1.5, (max ?? 1) * 1.5] : [Math.max(min ?? 1e-3, 1e-6) / 1.15, Math.max(max ?? 1, 1e-5) * 1.25];
  for (const v of s.include ?? []) (min = Math.min(min ?? v, v)), (max = Math.max(max ?? v, v));
  if (s.robust && min !== null && max !== null) [min, max] = robust(min, max);
  if (min === null || max === null || !Number.isFinite(min) || !Number.isFinite(max)) return [-1, 1];
  const room = (max - min || Math.abs(max) || 1) * 0.06;
  return [min - room, max + room];
}

export function axesOf(s: PlotSettings): uPlot.Axis[] {
  const grid = css("--grid");
  const axis = {
    stroke: css("--text"),
    grid: { stroke: grid, width: 1 },
    ticks: { stroke: grid, width: 1 },
    font: "12px system-ui, sans-serif",
    labelFont: "12px system-ui, sans-serif",
  };
  const along = s.along ? `${s.along.label}, ${s.along.unit}` : `${t("plot.time")}, s`;
  return [
    s.bare
      ? { ...axis, size: 6, values: (_: uPlot, splits: number[]) => splits.map(() => "") }
      : { ...axis, size: 34, label: along, labelSize: 16, gap: 3, ...(s.along?.log ? powers : {}) },
    { ...axis, size: window.innerWidth < 600 ? 52 : 64, label: s.unit, labelSize: 18, ...(s.logY ? powers : s.names ? named(s.names) : {}) },
    ...(s.lines.some((l) => l.right)
      ? [{ ...axis, scale: "y2", side: 1 as const, size: 58, label: s.rightUnit ?? "", labelSize: 18, grid: { show: false } }]
      : []),
  ];
}
