// Any JSON document of the program as tables and plots: what studies and comparisons print.
import type { Json } from "../api";
import { h } from "../dom";
import { maybe, number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { table } from "./overview";
import type { View } from "./track";

type Row = Record<string, Json>;
const isObject = (x: unknown): x is Row => typeof x === "object" && x !== null && !Array.isArray(x);
const isScalar = (x: unknown) => x === null || ["number", "string", "boolean"].includes(typeof x);
const isNumbers = (x: unknown): x is (number | null)[] => Array.isArray(x) && x.length > 0 && x.every((v) => v === null || typeof v === "number");
const isRows = (x: unknown): x is Row[] => Array.isArray(x) && x.length > 0 && x.every(isObject);

const units: [RegExp, string][] = [
  [/_m_s2$/, "m/s²"], [/_m_s$/, "m/s"], [/_deg_h$/, "°/h"], [/_deg_s$/, "°/s"], [/_mgal$/, "mGal"], [/_db_hz$/, "dB-Hz"],
  [/_arcsec$/, "″"], [/_deg$/, "°"], [/_km$/, "km"], [/_min$/, "min"], [/_hz$/, "Hz"], [/_m$/, "m"], [/_s$/, "s"], [/_h$/, "h"],
];

function unitOf(key: string): string {
  return units.find(([mark]) => mark.test(key))?.[1] ?? "";
}

export function nameOf(key: string): string {
  const mark = units.find(([m]) => m.test(key));
  const words = (mark ? key.replace(mark[0], "") : key).replaceAll("_", " ");
  return `${maybe(`word.${words}`, words)}${mark ? `, ${mark[1]}` : ""}`;
}

function said(v: Json | undefined): string {
  if (v === null || v === undefined) return "–";
  if (typeof v === "number") return number(v, 4);
  if (typeof v === "boolean") return t(v ? "yes" : "no");
  if (Array.isArray(v)) return v.every(isScalar) ? v.slice(0, 12).map((x) => said(x)).join(", ") + (v.length > 12 ? " …" : "") : `${v.length}`;
  if (isObject(v)) return Object.entries(v).filter(([, x]) => isScalar(x)).map(([k, x]) => `${k.replaceAll("_", " ")} ${said(x)}`).join(", ");
  return String(v);
}

const quiet = new Set(["timing", "version", "warnings", "facts", "command", "name", "seed"]);

export function documentView(doc: Row): View {
  const box = h("div", { class: "document" });
  const plots: TimePlot[] = [];
  const draw = (title: string, x: number[], xName: string, columns: [string, (number | null)[]][]) => {
    const linked = new Linked(Math.min(...x), Math.max(...x));
    const byUnit = new Map<string, [string, (number | null)[]][]>();
    for (const c of columns) byUnit.set(unitOf(c[0]), [...(byUnit.get(unitOf(c[0])) ?? []), c]);
    const made: TimePlot[] = [];
    for (const [unit, some] of byUnit)
      for (let i = 0; i < some.length; i += 6) {
        const part = some.slice(i, i + 6);
        made.push(
          new TimePlot(
            {
              title,
              unit,
              lines: part.map(([k], ink) => ({ label: nameOf(k).replace(/, [^,]*$/, ""), ink })),
              along: { label: nameOf(xName).replace(/, [^,]*$/, ""), unit: unitOf(xName) || "1", name: xName },
              load: async () => ({ x, y: part.map(([, v]) => v) }),
            },
            linked,
          ),
        );
      }
    linkCursors(made, linked);
    plots.push(...made);
    box.append(h("div", { class: "plots" }, ...made.map((p) => p.element)));
  };
  const increasing = (x: (number | null)[]): x is number[] => x.every((v, i) => v !== null && (i === 0 || v > (x[i - 1] ?? Infinity)));
  const rows = (title: string, list: Row[]) => {
    const keys = [...new Set(list.flatMap((r) => Object.keys(r)))].filter((k) => list.some((r) => r[k] !== null && !isRows(r[k]) && !(isNumbers(r[k]) && (r[k] as Json[]).length > 12)));
    if (keys.length === 0) return;
    const first = list.map((r) => r[keys[0]!] ?? null) as (number | null)[];
    if (list.length >= 8 && first.every((v) => typeof v === "number") && increasing(first)) {
      const numeric = keys.slice(1).filter((k) => list.every((r) => r[k] === null || typeof r[k] === "number"));
      if (numeric.length > 0) draw(title, first, keys[0]!, numeric.map((k) => [k, list.map((r) => r[k] as number | null)]));
    }
    box.append(table(keys.map(nameOf), list.slice(0, 500).map((r) => keys.map((k) => said(r[k]))), title));
    // lists inside the rows, each row of them with the name of the row that it belongs to
    for (const k of new Set(list.flatMap((r) => Object.keys(r).filter((key) => isRows(r[key])))))
      rows(
        `${title}: ${nameOf(k)}`,
        list.flatMap((r) => (isRows(r[k]) ? (r[k] as Row[]).map((inner) => ({ [keys[0]!]: r[keys[0]!]!, ...inner, ...(keys[0]! in inner ? { [`${keys[0]!} `]: r[keys[0]!]! } : {}) })) : [])),
      );
  };
  const object = (title: string, o: Row, depth: number) => {
    const entries = Object.entries(o).filter(([k]) => depth > 0 || !quiet.has(k));
    const plain = entries.filter(([, v]) => v !== null && (isScalar(v) || (Array.isArray(v) && v.every(isScalar) && v.length > 0 && v.length <= 12)));
    for (const [k, v] of plain) if (typeof v === "string" && v.length > 60) box.append(h("p", null, depth === 0 ? v : `${nameOf(k)}: ${v}`));
    const short = plain.filter(([, v]) => !(typeof v === "string" && v.length > 60));
    if (short.length > 0) box.append(table([t("table.quantity"), t("data.value")], short.map(([k, v]) => [nameOf(k), said(v)]), title));
    const long = entries.filter((e): e is [string, (number | null)[]] => isNumbers(e[1]) && (e[1] as Json[]).length > 12);
    const x = long.find(([, v]) => increasing(v));
    if (x) {
      const same = long.filter(([k, v]) => k !== x[0] && v.length === x[1].length);
      if (same.length > 0) draw(title, x[1] as number[], x[0], same);
    }
    // objects of one shape are rows of one table
    const inner = entries.filter((e): e is [string, Row] => isObject(e[1]) && Object.keys(e[1]).length > 0);
    const flat = inner.filter(([, v]) => Object.values(v).every((y) => isScalar(y) || isNumbers(y)) && !Object.values(v).some((y) => isNumbers(y) && y.length > 12));
    const shape = (v: Row) => Object.keys(v).join();
    const alike = flat.filter(([, v]) => flat.filter(([, w]) => shape(w) === shape(v)).length > 1);
    for (const s of new Set(alike.map(([, v]) => shape(v))))
      rows(title, alike.filter(([, v]) => shape(v) === s).map(([k, v]) => ({ name: k.replaceAll("_", " "), ...v })));
    for (const [k, v] of entries) {
      if (isRows(v)) rows(depth === 0 ? nameOf(k) : `${title}: ${nameOf(k)}`, v);
      else if (isObject(v) && !alike.some(([a]) => a === k) && depth < 5) object(depth === 0 ? nameOf(k) : `${title}: ${nameOf(k)}`, v, depth + 1);
    }
  };
  object(String(doc["name"] ?? doc["command"] ?? t("tab.document")), doc, 0);
  if (box.children.length === 0) box.append(h("p", { class: "muted" }, t("plot.empty")));
  return { element: box, redraw: () => plots.forEach((p) => p.redraw()) };
}
