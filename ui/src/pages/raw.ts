// The logs of a data set as they are, before anything is processed.
import { api, type Group, type Inspection } from "../api";
import { h, replace } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { signalsView } from "./signals";

const mostPlots = 24;

const isTable = (f: Inspection["files"][number]) => f.kind !== "unknown" && f.columns.length > 0 && f.rows > 1;

/** Columns that differ by an axis alone stand in one plot: gyro_x, gyro_y, gyro_z. */
function stem(name: string): string {
  return name.replace(/(^|_)(x|y|z|n|e|d|north|east|down|up|roll|pitch|yaw|heading|vn|ve|vd)(?=_|$)/, "$1*");
}

/** Signals of all logs on one axis of time: logs that begin within a day of the first are shifted by their own times. */
export function rawSignals(dataset: string, found: Inspection): HTMLElement | null {
  const most = 12,
    day = 86_400;
  const files = found.files.filter(isTable).slice(0, most);
  if (files.length === 0) return null;
  const place = h("div");
  const show = async () => {
    replace(place, h("p", { class: "muted" }, t("raw.wait")));
    try {
      const of = new Map<string, { time_s: number[]; columns: Record<string, (number | null)[]> }>();
      const groups: Group[] = [];
      let first: number | null = null;
      for (const f of files) {
        const raw = await api.raw(dataset, f.path);
        first ??= raw.zero;
        const shift = Math.abs(raw.zero - first) < day ? raw.zero - first : 0;
        const time_s = raw.time_s.map((v, i) => (v ?? i) + shift);
        const group = `/${f.path}`;
        const columns = Object.fromEntries(Object.entries(raw.columns).map(([name, v]) => [`${group}/table:${name}`, v]));
        of.set(group, { time_s, columns });
        groups.push({
          group,
          rows: raw.rows,
          start_s: time_s[0] ?? 0,
          stop_s: time_s.at(-1) ?? 0,
          columns: Object.entries(raw.columns)
            .filter(([, v]) => v.some((y) => y !== null))
            .map(([name]) => ({ id: `${group}/table:${name}`, name, unit: "" })),
        } as Group);
      }
      const start = Math.min(...groups.map((g) => g.start_s!));
      const linked = new Linked(start, Math.max(start + 1e-6, ...groups.map((g) => g.stop_s!)));
      const view = await signalsView(dataset, groups, linked, async (ids) => of.get(ids[0]!.slice(0, ids[0]!.lastIndexOf("/table:")))!);
      replace(place, view.element);
    } catch (e) {
      replace(place, h("p", { class: "bad", role: "alert" }, (e as Error).message));
    }
  };
  const card: HTMLElement = h("details", { class: "card raw-signals" }, h("summary", null, t("raw.signals")), place);
  card.addEventListener("toggle", () => place.children.length === 0 && void show());
  return card;
}

export function rawCard(dataset: string, found: Inspection): HTMLElement | null {
  const files = found.files.filter(isTable);
  if (files.length === 0) return null;
  const place = h("div");
  const choice = h("select", { "aria-label": t("data.file"), onChange: () => void show() }, ...files.map((f) => h("option", { value: f.path }, `${f.path} (${f.kind})`)));
  const show = async () => {
    replace(place, h("p", { class: "muted" }, t("raw.wait")));
    try {
      const raw = await api.raw(dataset, choice.value);
      const x = raw.time_s.map((v, i) => v ?? i);
      const linked = new Linked(x[0] ?? 0, Math.max(x.at(-1) ?? 1, (x[0] ?? 0) + 1e-6));
      const groups = new Map<string, string[]>();
      for (const [name, v] of Object.entries(raw.columns))
        if (v.some((y) => y !== null)) groups.set(stem(name), [...(groups.get(stem(name)) ?? []), name]);
      const plots = [...groups].slice(0, mostPlots).map(
        ([title, names]) =>
          new TimePlot(
            {
              title: names.length > 1 ? title.replace(/_?\*_?/, "_").replace(/^_|_$/g, "") : names[0]!,
              unit: "",
              height: 150,
              lines: names.map((label, ink) => ({ label, ink })),
              load: async () => ({ x, y: names.map((n) => raw.columns[n]!) }),
            },
            linked,
          ),
      );
      linkCursors(plots, linked);
      replace(place, h("p", { class: "muted" }, t("raw.lead", { n: raw.rows, time: raw.time, zero: number(raw.zero, 10) })), h("div", { class: "plots" }, ...plots.map((p) => p.element)));
    } catch (e) {
      replace(place, h("p", { class: "bad", role: "alert" }, (e as Error).message));
    }
  };
  const card: HTMLElement = h("details", { class: "card" }, h("summary", null, t("raw.title")), h("p", { class: "form-tools" }, choice), place);
  card.addEventListener("toggle", () => place.children.length === 0 && void show());
  return card;
}
