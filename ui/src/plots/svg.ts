// A plot as a picture: PNG as it is seen, SVG of the lines that the chart holds, for papers and drawing programs.
import type uPlot from "uplot";
import { css, h } from "../dom";
import type { Span } from "./linked";

export interface Shown {
  label: string;
  colour: string;
  dots: boolean;
  dash: number[] | undefined;
  /** On the axis at the right. */
  right: boolean;
  hidden: boolean;
}

const escaped = (text: string) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]!);

export interface Words {
  title: string;
  unit: string;
  /** Of the axis at the right, where there is one. */
  rightUnit: string;
  /** Of the x axis, with its unit. */
  along: string;
}

export function svgOf(u: uPlot, words: Words, lines: Shown[], band: string | null, spans: Span[]): string {
  const first = band ? 3 : 1;
  const left = 70,
    top = 34,
    width = 900,
    height = 300;
  const { min: x0, max: x1 } = u.scales.x as { min: number; max: number };
  const { min: y0, max: y1 } = u.scales.y as { min: number; max: number };
  const second = lines.some((l) => l.right) ? (u.scales.y2 as { min: number; max: number } | undefined) : undefined;
  const log = u.scales.y!.distr === 3;
  const logX = u.scales.x!.distr === 3;
  const power = (v: number, by: boolean) => (by ? Math.log10(Math.max(v, 1e-12)) : v);
  const px = (v: number) => left + ((power(v, logX) - power(x0, logX)) / (power(x1, logX) - power(x0, logX))) * width;
  const scaled = (v: number) => power(v, log);
  const py = (v: number) => top + (1 - (scaled(v) - scaled(y0)) / (scaled(y1) - scaled(y0))) * height;
  // the axis at the right is never logarithmic
  const py2 = (v: number) => top + (1 - (v - second!.min) / (second!.max - second!.min)) * height;
  const x = u.data[0] as number[];
  const seen: number[] = [];
  x.forEach((v, i) => {
    if ((x[i + 1] ?? v) >= x0 && (x[i - 1] ?? v) <= x1) seen.push(i);
  });
  const out: string[] = [];
  const text = (at: [number, number], words: string, more = "") =>
    out.push(`<text x="${at[0].toFixed(1)}" y="${at[1].toFixed(1)}" ${more}>${escaped(words)}</text>`);
  const path = (column: number, place = py) => {
    const values = u.data[column] as (number | null)[];
    let pen = false;
    return seen
      .map((i) => {
        const v = values[i];
        if (v === null || v === undefined) return (pen = false), "";
        const point = `${pen ? "L" : "M"}${px(x[i]!).toFixed(2)},${place(v).toFixed(2)}`;
        pen = true;
        return point;
      })
      .join("");
  };
  out.push(`<rect width="100%" height="100%" fill="${css("--surface")}"/>`);
  for (const s of spans) {
    const a = Math.max(px(s.from), left),
      b = Math.min(px(s.to), left + width);
    if (b > a)
      out.push(
        `<rect x="${a.toFixed(1)}" y="${top}" width="${(b - a).toFixed(1)}" height="${height}" fill="${css("--outage")}"/>`,
      );
  }
  const ticks = (a: number, b: number) => {
    const raw = (b - a) / 6,
      power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((m) => m >= raw)!;
    const all: number[] = [];
    for (let v = Math.ceil(a / step) * step; v <= b + 1e-9 * step; v += step) all.push(Number(v.toPrecision(10)));
    return all;
  };
  const line = (a: [number, number], b: [number, number]) =>
    out.push(
      `<path d="M${a[0].toFixed(1)},${a[1].toFixed(1)}L${b[0].toFixed(1)},${b[1].toFixed(1)}" stroke="${css("--grid")}"/>`,
    );
  const marks = (a: number, b: number, by: boolean) =>
    by
      ? ticks(power(a, true), power(b, true))
          .filter(Number.isInteger)
          .map((p) => 10 ** p)
      : ticks(a, b);
  for (const v of marks(x0, x1, logX)) {
    line([px(v), top], [px(v), top + height]);
    text([px(v), top + height + 16], String(v), 'text-anchor="middle"');
  }
  for (const v of marks(y0, y1, log)) {
    line([left, py(v)], [left + width, py(v)]);
    text([left - 6, py(v) + 4], String(v), 'text-anchor="end"');
  }
  if (second)
    for (const v of ticks(second.min, second.max)) text([left + width + 6, py2(v) + 4], String(v));
  out.push(
    `<clipPath id="c"><rect x="${left}" y="${top}" width="${width}" height="${height}"/></clipPath><g clip-path="url(#c)" fill="none">`,
  );
  if (band) for (const k of [1, 2]) out.push(`<path d="${path(k)}" stroke="${band}"/>`);
  lines.forEach((l, i) => {
    if (l.hidden) return;
    const place = l.right && second ? py2 : py;
    if (!l.dots)
      out.push(
        `<path d="${path(i + first, place)}" stroke="${l.colour}" stroke-width="1.4"${l.dash ? ` stroke-dasharray="${l.dash.join(" ")}"` : ""}/>`,
      );
    else
      for (const k of seen) {
        const v = u.data[i + first]![k];
        if (v !== null && v !== undefined)
          out.push(`<circle cx="${px(x[k]!).toFixed(2)}" cy="${place(v).toFixed(2)}" r="2" fill="${l.colour}"/>`);
      }
  });
  out.push("</g>");
  text([left, 20], `${words.title}, ${words.unit}`, 'font-weight="600" font-size="14"');
  if (second && words.rightUnit) text([left + width + 6, top - 4], words.rightUnit);
  text([left + width / 2, top + height + 34], words.along, 'text-anchor="middle"');
  let at = left + width;
  for (const l of [...lines].reverse()) {
    if (l.hidden) continue;
    at -= 9 * l.label.length + 30;
    out.push(`<path d="M${at},16h18" stroke="${l.colour}" stroke-width="2"/>`);
    text([at + 22, 20], l.label);
  }
  const wide = left + width + (second ? 70 : 20);
  const whole = `viewBox="0 0 ${wide} ${top + height + 44}" width="${wide}" height="${top + height + 44}"`;
  return `<svg xmlns="http://www.w3.org/2000/svg" ${whole} font-family="sans-serif" font-size="12" fill="${css("--text")}">${out.join("\n")}</svg>\n`;
}

/** What is seen, with title and legend above it. */
export function pictureOf(u: uPlot, title: string, lines: { label: string; colour: string }[]): HTMLCanvasElement {
  const from = u.ctx.canvas;
  const canvas = h("canvas", { width: from.width, height: from.height + 40 * devicePixelRatio });
  const g = canvas.getContext("2d")!;
  g.fillStyle = css("--surface");
  g.fillRect(0, 0, canvas.width, canvas.height);
  g.drawImage(from, 0, 40 * devicePixelRatio);
  g.scale(devicePixelRatio, devicePixelRatio);
  g.font = "600 14px system-ui, sans-serif";
  g.fillStyle = css("--text");
  g.fillText(title, 10, 18);
  g.font = "12px system-ui, sans-serif";
  let x = 10;
  for (const line of lines) {
    g.fillStyle = line.colour;
    g.fillRect(x, 30, 16, 3);
    g.fillStyle = css("--text");
    g.fillText(line.label, x + 20, 35);
    x += 34 + g.measureText(line.label).width;
  }
  return canvas;
}
