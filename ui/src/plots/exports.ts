// What a plot gives away: its numbers as text, its picture.
import type uPlot from "uplot";
import { css, saveAs } from "../dom";
import { t } from "../i18n";
import { colour } from "./colours";
import type { Linked } from "./linked";
import type { PlotSettings } from "./settings";
import { pictureOf, svgOf } from "./svg";

export function fileName(title: string, ending: string): string {
  return `${title.replace(/[^\p{L}\p{N}]+/gu, "_")}.${ending}`;
}

/** Everything in the range as comma separated text; every row where they are not too many. */
export async function rowsOf(s: PlotSettings, { from, to }: Linked): Promise<string> {
  const data = await s.load(from, to, 0, new AbortController().signal);
  const names = [s.along?.name ?? "time_s", ...s.lines.map((l) => `${l.label} (${s.unit})`)];
  if (s.band) names.push(`${s.band}`, `-${s.band}`);
  const quoted = names.map((n) => (/[",]/.test(n) ? `"${n.replaceAll('"', '""')}"` : n));
  const out = [quoted.join(",")];
  data.x.forEach((x, i) => out.push([x, ...data.y.map((y) => y[i] ?? "")].join(",")));
  return out.join("\n") + "\n";
}

export function savePng(chart: uPlot, s: PlotSettings): void {
  const lines = s.lines.map((l, i) => ({ label: l.label, colour: colour(l.label, l.ink ?? i) }));
  pictureOf(chart, `${s.title}, ${s.unit}`, lines).toBlob((blob) => blob && saveAs(blob, fileName(s.title, "png")));
}

export function saveSvg(chart: uPlot, s: PlotSettings, hidden: Set<number>, linked: Linked): void {
  const shown = s.lines.map((l, i) => ({
    label: l.label,
    colour: colour(l.label, l.ink ?? i),
    dots: l.dots ?? false,
    dash: l.dash,
    hidden: hidden.has(i),
  }));
  const along = s.along ? `${s.along.label}, ${s.along.unit}` : `${t("plot.time")}, s`;
  const text = svgOf(chart, { title: s.title, unit: s.unit, along }, shown, s.band ? css("--band") : null, linked.spans);
  saveAs(new Blob([text], { type: "image/svg+xml" }), fileName(s.title, "svg"));
}
