// Every signal of a run: searched in a tree, several in one plot with two axes, derived ones, layouts that are kept.
import { api, type Group } from "../api";
import { h, replace, tell } from "../dom";
import { number, t } from "../i18n";
import type { Operation } from "../plots/derive";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { signalLoader, type Signal, type Source } from "./signaldata";
import type { View } from "./track";
import { unit } from "./views";

type Layout = Signal[][];

interface Known {
  id: string;
  group: string;
  label: string;
  unit: string;
  parts: string[];
}

/** Columns that are the components of one vector: x, y, z of a table, or gyro_x_rad_s and its like among others. */
export function vectorsOf<C extends { name: string }>(columns: C[]): { stem: string; parts: C[] }[] {
  const axes = /^(x,y,z|north,east,down|east,north,up|north,east,up|n,e,d|e,n,u)$/;
  const by = new Map<string, { axis: string; column: C }[]>();
  for (const column of columns) {
    const found = /(^|_)(x|y|z|north|east|down|up|n|e|d|u)(?=_|$)/.exec(column.name);
    if (!found) continue;
    const stem = `${column.name.slice(0, found.index)}${found[1]}${column.name.slice(found.index + found[0].length)}`.replace(/__+/, "_").replace(/^_|_$/g, "");
    by.set(stem, [...(by.get(stem) ?? []), { axis: found[2]!, column }]);
  }
  return [...by].filter(([, all]) => axes.test(all.map((a) => a.axis).join())).map(([stem, all]) => ({ stem, parts: all.map((a) => a.column) }));
}

function catalogue(groups: Group[]): Map<string, Known> {
  const out = new Map<string, Known>();
  for (const g of groups) {
    const tables = new Map<string, { id: string; name: string; unit: string }[]>();
    for (const c of g.columns) {
      const [path = "", name = ""] = [c.id.slice(0, c.id.lastIndexOf(":")), c.id.slice(c.id.lastIndexOf(":") + 1)];
      const table = path.slice(g.group.length + 1);
      const words = table === "table" ? name.replaceAll("_", " ") : `${table.replace(/^std_/, "σ ").replaceAll("_", " ")} ${name}`;
      out.set(c.id, { id: c.id, group: g.group, label: words, unit: unit(c.unit), parts: [c.id] });
      tables.set(path, [...(tables.get(path) ?? []), { id: c.id, name, unit: c.unit }]);
    }
    for (const [path, columns] of tables)
      for (const { stem, parts } of vectorsOf(columns)) {
        const id = `norm:${path}${stem}`;
        const words = `${path.slice(g.group.length + 1).replace(/^table$/, "")} ${stem}`.replaceAll("_", " ").trim();
        out.set(id, { id, group: g.group, label: `|${words}|`, unit: unit(parts[0]!.unit), parts: parts.map((c) => c.id) });
      }
  }
  return out;
}

const operations: Operation[] = ["raw", "mean", "integral", "derivative", "lowpass"];

function derivedUnit(u: string, operation: Operation | undefined): string {
  if (operation === "integral") return `${u}·s`;
  return operation === "derivative" ? `${u}/s` : u;
}

/** What is drawn before anything is chosen: the first usual signal that has values. A solution by phases alone has no velocity. */
async function firstOf(known: Map<string, unknown>, source: Source): Promise<string | undefined> {
  const usual = ["/solution/velocity:north", "/solution/position:height", "/attitude/table:roll_deg", "/gravity/table:gravity_disturbance_mgal"].filter((id) => known.has(id));
  for (const id of usual) {
    const rows = await source([id], { points: 100 }, new AbortController().signal).catch(() => null);
    if (rows && Object.values(rows.columns).some((v) => v.some((x) => x !== null))) return id;
  }
  return usual[0] ?? [...known.keys()][0];
}

export async function signalsView(
  run: string,
  groups: Group[],
  linked: Linked,
  source: Source = (ids, range, signal) => api.series(run, ids, range, undefined, signal),
): Promise<View> {
  const known = catalogue(groups);
  let layouts: Record<string, unknown> = await api.layouts().catch(() => ({}));
  const first = await firstOf(known, source);
  let layout: Layout = [first ? [{ id: first }] : []];
  const remembered = sessionStorage.getItem("schuler.signals");
  if (remembered) {
    const kept = (JSON.parse(remembered) as Layout).map((p) => p.filter((s) => known.has(s.id)));
    if (kept.some((p) => p.length > 0)) layout = kept;
  }
  let active = 0;
  let plots: TimePlot[] = [];

  const labelOf = (s: Signal) => {
    const k = known.get(s.id);
    const name = `${k?.group.slice(1) ?? ""} ${k?.label ?? s.id}`;
    const of = s.operation && s.operation !== "raw" ? `${t(`signals.${s.operation}`)} ${name}` : name;
    return s.minus ? `${of} − ${known.get(s.minus)?.label ?? s.minus}` : of;
  };

  const load = signalLoader(source, (id) => {
    const k = known.get(id);
    if (!k) throw new Error(id);
    return k.parts;
  });

  const list = h("div", { class: "signal-plots" });
  const changed = () => {
    sessionStorage.setItem("schuler.signals", JSON.stringify(layout));
    draw();
  };

  const chip = (plot: Signal[], s: Signal, i: number) => {
    const choice = h(
      "select",
      {
        "aria-label": `${t("signals.derived")}: ${labelOf(s)}`,
        onChange: () => {
          const value = choice.value;
          if (value.startsWith("minus:")) s.minus = value.slice(6);
          else {
            s.operation = value as Operation;
            delete s.minus;
            if (s.operation === "lowpass") {
              const typed = Number(prompt(t("signals.seconds"), String(s.seconds ?? 1)) ?? "1");
              s.seconds = typed > 0 ? typed : 1;
            }
          }
          changed();
        },
      },
      ...operations.map((o) => h("option", { value: o }, t(`signals.${o}`))),
      ...plot.filter((other) => other !== s).map((other) => h("option", { value: `minus:${other.id}` }, `− ${known.get(other.id)?.label ?? other.id}`)),
    );
    choice.value = s.minus && plot.some((o) => o.id === s.minus) ? `minus:${s.minus}` : (s.operation ?? "raw");
    return h(
      "span",
      { class: "signal-chip" },
      h("span", { class: `swatch ink-${(i % 9) + 1}` }),
      labelOf(s),
      choice,
      h("button", { type: "button", class: "icon", title: t("signals.axis"), "aria-label": `${t("signals.axis")}: ${labelOf(s)}`, onClick: () => ((s.right = !s.right), changed()) }, s.right ? "R" : "L"),
      h("button", { type: "button", class: "icon", "aria-label": `${t("remove")} ${labelOf(s)}`, onClick: () => (plot.splice(i, 1), changed()) }, "✕"),
    );
  };

  function draw(): void {
    const bothUnits = (plot: Signal[], right: boolean) =>
      [...new Set(plot.filter((s) => Boolean(s.right) === right).map((s) => derivedUnit(known.get(s.id)?.unit ?? "", s.operation)))].join(", ");
    plots = [];
    const cards = layout.map((plot, at) => {
      const head = h(
        "div",
        { class: "signal-head" },
        h("label", { class: "signal-active" }, h("input", { type: "radio", name: "signal-plot", checked: at === active, onChange: () => (active = at) }), ` ${t("signals.plot", { n: at + 1 })}`),
        ...plot.map((s, i) => chip(plot, s, i)),
        h("button", { type: "button", class: "icon", "aria-label": `${t("remove")} ${t("signals.plot", { n: at + 1 })}`, onClick: () => (layout.splice(at, 1), layout.length || layout.push([]), (active = Math.min(active, layout.length - 1)), changed()) }, "✕"),
      );
      const card = h("section", { class: "signal-card" }, head);
      if (plot.length > 0) {
        const p = new TimePlot(
          {
            title: plot.map((s) => labelOf(s)).join("; "),
            unit: bothUnits(plot, false),
            rightUnit: bothUnits(plot, true),
            height: layout.length > 1 ? 190 : 330,
            lines: plot.map((s, ink) => ({ label: labelOf(s), ink, ...(s.right ? { right: true } : {}) })),
            load: load(plot),
          },
          linked,
        );
        plots.push(p);
        card.append(p.element);
      } else card.append(h("p", { class: "muted" }, t("signals.empty")));
      card.addEventListener("dragover", (e) => e.preventDefault());
      card.addEventListener("drop", (e) => {
        e.preventDefault();
        const id = e.dataTransfer?.getData("text/plain") ?? "";
        if (known.has(id)) (active = at), add(id, plot.length > 0 && e.clientX > card.getBoundingClientRect().left + 0.7 * card.clientWidth);
      });
      return card;
    });
    linkCursors(plots, linked);
    replace(list, ...cards);
  }

  function add(id: string, right = false): void {
    const plot = layout[active] ?? (layout[active] = []);
    const at = plot.findIndex((s) => s.id === id && !s.operation && !s.minus);
    if (at >= 0) plot.splice(at, 1);
    else {
      const units = new Set(plot.filter((s) => !s.right).map((s) => known.get(s.id)?.unit));
      // another unit goes to the other axis
      plot.push({ id, ...(right || (units.size > 0 && !units.has(known.get(id)?.unit)) ? { right: true } : {}) });
    }
    changed();
  }

  const tree = h("div", { class: "signal-tree" });
  const search = h("input", { type: "search", placeholder: t("signals.search"), "aria-label": t("signals.search"), onInput: () => fill() });
  const fill = () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const hits = [...known.values()].filter((k) => words.every((w) => `${k.group} ${k.label} ${k.unit}`.toLowerCase().includes(w)));
    const byGroup = new Map<string, Known[]>();
    for (const k of hits) byGroup.set(k.group, [...(byGroup.get(k.group) ?? []), k]);
    replace(
      tree,
      ...[...byGroup].map(([group, all], i) =>
        h(
          "details",
          { open: words.length > 0 || i === 0 },
          h("summary", null, `${group.slice(1)} (${all.length})`),
          ...all.map((k) => {
            const button = h("button", { type: "button", class: "signal", draggable: true, onClick: () => add(k.id) }, k.label, h("span", { class: "muted" }, ` ${k.unit}`));
            button.addEventListener("dragstart", (e) => e.dataTransfer?.setData("text/plain", k.id));
            return button;
          }),
        ),
      ),
      hits.length === 0 && h("p", { class: "muted" }, t("signals.none")),
    );
  };
  const chooser = h("select", {
    "aria-label": t("signals.layouts"),
    onChange: () => {
      const kept = layouts[chooser.value];
      if (!Array.isArray(kept)) return;
      layout = (structuredClone(kept) as Layout).map((p) => p.filter((s) => known.has(s.id)));
      active = 0;
      changed();
    },
  });
  const choices = () => replace(chooser, h("option", { value: "" }, `${t("signals.layouts")} …`), ...Object.keys(layouts).map((n) => h("option", { value: n }, n)));
  choices();
  const keep = async (all: Record<string, unknown>) => {
    try {
      await api.keepLayouts(all);
      layouts = all;
      choices();
    } catch (e) {
      tell((e as Error).message, "error");
    }
  };
  const element = h(
    "div",
    { class: "signals" },
    h("aside", { class: "card" }, search, tree),
    h(
      "div",
      null,
      h(
        "p",
        { class: "form-tools" },
        h("button", { type: "button", onClick: () => (layout.push([]), (active = layout.length - 1), changed()) }, `+ ${t("signals.add_plot")}`),
        chooser,
        h(
          "button",
          {
            type: "button",
            onClick: () => {
              const name = prompt(t("signals.name"), chooser.value || "");
              if (name) void keep({ ...layouts, [name]: layout });
            },
          },
          t("signals.keep"),
        ),
        h("button", { type: "button", onClick: () => { const { [chooser.value]: _, ...rest } = layouts; void keep(rest); } }, t("signals.forget")),
        h("span", { class: "muted" }, t("signals.hint", { n: number(known.size) })),
      ),
      list,
    ),
  );
  fill();
  draw();
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}
