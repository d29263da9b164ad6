// Which lines of a plot are drawn, and in which colour.
import { h } from "../dom";
import { t } from "../i18n";
import { chooseColour, colour, hex } from "./colours";
import type { Line } from "./settings";

export function lineChoice(
  lines: Line[],
  hidden: Set<number>,
  show: (line: number, on: boolean) => void,
  redraw: () => void,
): HTMLElement[] {
  const rows: HTMLElement[] = lines.map((line, i) =>
    h(
      "label",
      null,
      h("input", {
        type: "checkbox",
        checked: !hidden.has(i),
        onChange: (e: Event) => show(i, (e.target as HTMLInputElement).checked),
      }),
      h("input", {
        type: "color",
        value: hex(colour(line.label, line.ink ?? i, line.paint)),
        "aria-label": `${t("plot.colour")}: ${line.label}`,
        onInput: (e: Event) => {
          chooseColour(line.label, (e.target as HTMLInputElement).value);
          redraw();
        },
      }),
      line.label,
    ),
  );
  const back = () => (lines.forEach((l) => chooseColour(l.label, null)), redraw());
  return [...rows, h("button", { type: "button", onClick: back }, t("plot.colours_back"))];
}
