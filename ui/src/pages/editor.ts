// The scenario editor: the option table as a form, the track as one types, outages on a time line, TOML in and out.
import { api, type Json, type Settings, type Understood } from "../api";
import { h, replace, saveAs, tell } from "../dom";
import { OptionForm } from "../form";
import { number, t } from "../i18n";
import { mainOptions } from "../labels";
import type { Page } from "../page";
import { Linked } from "../plots/linked";
import { PlanView } from "../plots/plan";
import { TimePlot, linkCursors } from "../plots/timeplot";
import { OutageLine, type Outage } from "../plots/timeline";
import { Desk } from "./desk";
import { CommandChoice, runButton } from "./runbutton";

function gnssOutages(settings: Settings): Outage[] {
  const list = settings["outage"];
  if (!Array.isArray(list)) return [];
  return list.flatMap((o) => {
    const x = o as Record<string, Json>;
    if (x["sensor"] !== undefined && x["sensor"] !== "gnss") return [];
    return typeof x["start_s"] === "number" && typeof x["duration_s"] === "number"
      ? [{ start_s: x["start_s"], duration_s: x["duration_s"] }]
      : [];
  });
}

function otherOutages(settings: Settings): Json[] {
  const list = settings["outage"];
  return Array.isArray(list) ? list.filter((o) => ((o as Record<string, Json>)["sensor"] ?? "gnss") !== "gnss") : [];
}

export async function editorPage(query: URLSearchParams): Promise<Page> {
  const [options, first] = await Promise.all([
    api.options("scenario"),
    (async (): Promise<Understood> => {
      const run = query.get("run");
      if (run) return api.runSettings(run);
      const name = query.get("example") ?? "demo";
      const example = (await api.examples()).find((e) => e.name === name);
      return api.settings("scenario", example ? { toml: example.toml } : { settings: {} });
    })(),
  ]);
  const again = query.get("run") ? await api.run(query.get("run")!) : null;
  let now = first;
  let linked = new Linked(0, 1);
  const desk = new Desk();
  const profile = h("div");
  const toml = h("textarea", { class: "toml", rows: 24, spellcheck: false, "aria-label": "TOML" });
  const title = h("input", {
    type: "text",
    class: "run-name",
    value: "",
    "aria-label": t("run.title"),
    placeholder: t("editor.name"),
  });
  const plan = new PlanView(null, 340);
  const outages = new OutageLine((list) => {
    const spans = list.map((o) => ({ ...o, sensor: "gnss" }) as Json);
    form.put("outage", [...spans, ...otherOutages(form.settings)]);
  });
  let plots: TimePlot[] = [];

  const drawn = () => {
    const track = now.track;
    if (track) {
      plan.show([{ label: t("track.true"), ink: 0, time: track.time_s, east: track.east_m, north: track.north_m }]);
      const start = (key: string) => Number(now.settings[`trajectory.start.${key}`] ?? now.used[`trajectory.start.${key}`] ?? NaN);
      void plan.lie({ lat: start("lat_deg"), lon: start("lon_deg") });
      linked = new Linked(0, track.time_s.at(-1) ?? 1);
      linked.spans = gnssOutages(form.settings).map((o) => ({ from: o.start_s, to: o.start_s + o.duration_s, label: "GNSS" }));
      const of = (name: string, unit: string, lines: [string, number[]][]) =>
        new TimePlot(
          {
            title: name,
            unit,
            height: 150,
            lines: lines.map(([label]) => ({ label })),
            load: async () => ({ x: track.time_s, y: lines.map(([, y]) => y) }),
          },
          linked,
        );
      plots = [
        of(t("editor.height"), "m", [[t("editor.height"), track.height_m]]),
        of(t("editor.speed"), "m/s", [[t("editor.speed"), track.speed_m_s]]),
        of(t("view.attitude"), "°", [
          [t("roll"), track.roll_deg],
          [t("pitch"), track.pitch_deg],
          [t("heading"), track.heading_deg],
        ]),
      ];
      linkCursors(plots, linked);
      const length = track.east_m.reduce(
        (sum, e, i) => (i === 0 ? 0 : sum + Math.hypot(e - track.east_m[i - 1]!, track.north_m[i]! - track.north_m[i - 1]!)),
        0,
      );
      replace(
        profile,
        h(
          "p",
          { class: "muted" },
          t("editor.track", { km: number(length / 1000), top: number(Math.max(...track.speed_m_s)) }),
          track.cut ? ` ${t("editor.cut")}` : "",
        ),
        ...plots.map((p) => p.element),
      );
    }
    outages.show(gnssOutages(form.settings), Number(form.settings["duration_s"] ?? now.used["duration_s"] ?? 1));
    toml.value = now.toml;
    const keys = Object.keys(form.settings);
    const runs = form.settings["montecarlo.runs"];
    if (keys.some((k) => k.startsWith("gravity.") || k.startsWith("anomaly"))) command.suggest("gravity");
    else if (typeof runs === "number") command.suggest("montecarlo", runs);
  };
  const command = new CommandChoice(["run", "montecarlo", "gravity"], () => desk.changed());
  const form = new OptionForm(options, () => desk.changed(), (key) => key === "outage", [], mainOptions.scenario);
  desk.follow(form);

  const load = async (text: string) => {
    try {
      now = await api.settings("scenario", { toml: text });
      form.load(now);
      desk.show(now);
      desk.keep();
      drawn();
      tell(t("editor.loaded"));
    } catch (e) {
      tell((e as Error).message, "error");
    }
  };
  const start = runButton(t("editor.run"), () => ({
    kind: "scenario",
    title: title.value.trim() || String(form.settings["name"] ?? "scenario"),
    settings: form.settings,
    ...command.order,
  }), () => desk.forget());
  const file = () => {
    const input = h("input", { type: "file", accept: ".toml" });
    input.onchange = () => void input.files?.[0]?.text().then(load);
    input.click();
  };
  const element = h(
    "div",
    { class: "editor" },
    h(
      "div",
      { class: "bar" },
      h("h1", null, t("editor.title")),
      title,
      command.element,
      start,
      h("button", { type: "button", onClick: file }, t("editor.load")),
      h(
        "button",
        {
          type: "button",
          onClick: () =>
            saveAs(new Blob([now.toml], { type: "text/plain" }), `${String(form.settings["name"] ?? "scenario")}.toml`),
        },
        t("editor.save"),
      ),
    ),
    desk.problem,
    desk.obstacle,
    h(
      "div",
      { class: "split" },
      h("div", { class: "left" }, form.element),
      h(
        "div",
        { class: "right" },
        plan.element,
        outages.element,
        profile,
        h(
          "details",
          { class: "card" },
          h("summary", null, t("editor.toml")),
          h("p", { class: "muted" }, t("editor.toml_hint")),
          toml,
          h("button", { type: "button", onClick: () => void load(toml.value) }, t("editor.apply")),
        ),
      ),
    ),
  );
  form.load(now);
  if (again) {
    title.value = again.title;
    const order = again.order;
    if (order && order.command !== "run") command.suggest(order.command as never, order.runs || undefined);
  }
  drawn();
  desk.begin({
    form,
    title,
    start,
    of: "scenario",
    more: () => command.choice,
    understood: (next) => {
      now = next;
      drawn();
    },
  });
  desk.show(now);
  const draft = desk.draft;
  if (draft)
    try {
      now = await api.settings("scenario", { settings: draft.settings });
      form.load(now);
      title.value = draft.title;
      command.take(draft.more);
      desk.show(now);
      drawn();
      element.insertBefore(desk.restored(), desk.problem);
    } catch {
      desk.forget();
    }
  return {
    title: t("editor.title"),
    element,
    redraw: () => {
      plan.redraw();
      outages.draw();
      plots.forEach((p) => p.redraw());
    },
  };
}
