// Every column of a run as numbers.
import { api, type Group } from "../api";
import { h, replace } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { table } from "./overview";
import type { View } from "./track";
import { unit } from "./views";

export function tableView(run: string, groups: Group[], linked: Linked): View {
  const chooser = h(
    "select",
    { "aria-label": t("table.group"), onChange: () => void fill() },
    ...groups.map((g) => h("option", { value: g.group }, g.group.slice(1))),
  );
  const from = h("input", {
    type: "number",
    step: "any",
    value: String(linked.cursor ?? linked.from),
    "aria-label": t("table.from_row"),
    onChange: () => void fill(),
  });
  const place = h("div");
  const fill = async () => {
    const g = groups.find((x) => x.group === chooser.value)!;
    const rate = g.stop_s !== null && g.start_s !== null && g.rows > 1 ? (g.stop_s - g.start_s) / (g.rows - 1) : 1;
    const start = Math.max(Number(from.value), g.start_s ?? 0);
    const ids = g.columns.slice(0, 64).map((c) => c.id);
    const s = await api.series(run, ids, { from: start, to: start + 200 * rate, points: 0 });
    const head = [
      `${t("plot.time")}, s`,
      ...g.columns.slice(0, 64).map(
        (c) =>
          `${c.id
            .slice(g.group.length + 1)
            .replace(":", " ")
            .replace(/^std_/, "σ ")
            .replaceAll("_", " ")}${unit(c.unit) ? `, ${unit(c.unit)}` : ""}`,
      ),
    ];
    replace(
      place,
      table(
        head,
        s.time_s.map((x, i) => [
          number(x, 9),
          ...g.columns.slice(0, 64).map((c) => number(s.columns[c.id]![i], c.id.includes("/position:l") ? 11 : 6)),
        ]),
        `${g.group.slice(1)} (${g.rows})`,
      ),
    );
  };
  void fill();
  return {
    element: h(
      "div",
      null,
      h(
        "p",
        { class: "form-tools" },
        h("label", null, t("table.group"), " ", chooser),
        h("label", null, t("table.from_row"), " ", from, " s"),
      ),
      place,
    ),
    redraw: () => undefined,
  };
}
