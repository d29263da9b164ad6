// The logs of a data set as they are, before anything is processed.
import { api, type Inspection } from "../api";
import { h, replace } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors } from "../plots/timeplot";

const tables = /imu|gnss|mag|baro|odo|reference|trajectory|heading|range|pos|airspeed/;
const mostPlots = 24;

/** Columns that differ by an axis alone stand in one plot: gyro_x, gyro_y, gyro_z. */
function stem(name: string): string {
  return name.replace(/(^|_)(x|y|z|n|e|d|north|east|down|up|roll|pitch|yaw|heading|vn|ve|vd)(?=_|$)/, "$1*");
}

export function rawCard(dataset: string, found: Inspection): HTMLElement | null {
  const files = found.files.filter((f) => tables.test(f.kind) && f.rows > 1);
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
