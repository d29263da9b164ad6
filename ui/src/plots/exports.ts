// What a plot gives away: its numbers as text, its picture.
import type uPlot from "uplot";
import { css, saveAs, tell } from "../dom";
import { t } from "../i18n";
import { colour } from "./colours";
import type { Linked } from "./linked";
import type { Data, PlotSettings } from "./settings";
import { pictureOf, svgOf, type Shown } from "./svg";

export function fileName(title: string, ending: string): string {
  return `${title.replace(/[^\p{L}\p{N}]+/gu, "_")}.${ending}`;
}

/** Numbers as comma separated text; each column has the unit of its own axis. */
export function csvOf(s: PlotSettings, data: Data): string {
  const names = [s.along?.name ?? "time_s", ...s.lines.map((l) => `${l.label} (${l.right ? (s.rightUnit ?? "") : s.unit})`)];
  if (s.band) names.push(`${s.band}`, `-${s.band}`);
  const quoted = names.map((n) => (/[",]/.test(n) ? `"${n.replaceAll('"', '""')}"` : n));
  const out = [quoted.join(",")];
  data.x.forEach((x, i) => out.push([x, ...data.y.map((y) => y[i] ?? "")].join(",")));
  return out.join("\n") + "\n";
}

/** Everything in the range; every row where they are not too many, and a word where they are. */
export async function rowsOf(s: PlotSettings, { from, to }: Linked): Promise<string> {
  const data = await s.load(from, to, 0, new AbortController().signal);
  if (data.thinned) tell(t("plot.rows_thinned"));
  return csvOf(s, data);
}

/** Lines as a picture shows them: in the colours of the plot, without those that are hidden. */
export function shownLines(s: PlotSettings, hidden: Set<number>): Shown[] {
  return s.lines.map((l, i) => ({
    label: l.label,
    colour: colour(l.label, l.ink ?? i, l.paint),
    dots: l.dots ?? false,
    dash: l.dash,
    right: l.right ?? false,
    hidden: hidden.has(i),
  }));
}

export function savePng(chart: uPlot, s: PlotSettings, hidden: Set<number>): void {
  const lines = shownLines(s, hidden).filter((l) => !l.hidden);
  const right = lines.some((l) => l.right) && s.rightUnit ? `; ${s.rightUnit}` : "";
  pictureOf(chart, `${s.title}, ${s.unit}${right}`, lines).toBlob((blob) => blob && saveAs(blob, fileName(s.title, "png")));
}

export function saveSvg(chart: uPlot, s: PlotSettings, hidden: Set<number>, linked: Linked): void {
  const along = s.along ? `${s.along.label}, ${s.along.unit}` : `${t("plot.time")}, s`;
  const words = { title: s.title, unit: s.unit, rightUnit: s.rightUnit ?? "", along };
  const text = svgOf(chart, words, shownLines(s, hidden), s.band ? css("--band") : null, linked.spans);
  saveAs(new Blob([text], { type: "image/svg+xml" }), fileName(s.title, "svg"));
}
