// Where a run went: from above, in space, and the horizon, at a time that is chosen or played.
import { api, type Group } from "../api";
import { h } from "../dom";
import { t } from "../i18n";
import { HorizonView } from "../plots/horizon";
import { Linked } from "../plots/linked";
import { PlanView } from "../plots/plan";
import { planeOf } from "./quality";
import type { Track3d } from "../plots/space";

export interface View {
  element: HTMLElement;
  redraw: () => void;
}

async function trackData(run: string): Promise<Track3d> {
  const names = ["local:north", "local:east", "local:up", "attitude:roll", "attitude:pitch", "attitude:heading"].map(
    (n) => `/solution/${n}`,
  );
  const s = await api.series(run, names, { points: 1500 });
  const [north, east, up, roll, pitch, heading] = names.map((n) => s.columns[n]!);
  return { time: s.time_s, north: north!, east: east!, up: up!, roll: roll!, pitch: pitch!, heading: heading! };
}

export async function trackView(run: string, groups: Group[], linked: Linked): Promise<View> {
  const track = await trackData(run);
  const plan = new PlanView(linked, window.innerWidth < 1700 ? 640 : 420);
  const local = async (group: string) => {
    const s = await api.series(run, [`${group}/local:east`, `${group}/local:north`], { points: 1500 });
    return { time: s.time_s, east: s.columns[`${group}/local:east`]!, north: s.columns[`${group}/local:north`]! };
  };
  const tracks = [{ label: t("track.solution"), ink: 0, ...track }];
  if (groups.some((g) => g.group === "/reference"))
    tracks.push({ label: t("track.reference"), ink: 2, ...(await local("/reference")) } as never);
  if (groups.some((g) => g.group === "/gnss"))
    tracks.push({ label: t("track.gnss"), ink: 1, dots: true, ...(await local("/gnss")) } as never);
  plan.show(tracks);
  void planeOf(run).then((plane) => plane && plan.lie(plane));
  const { SpaceView, nearest } = await import("../plots/space");
  const space = new SpaceView(track, linked);
  const horizon = new HorizonView((time) => {
    const i = nearest(track.time, time);
    return track.roll[i] === undefined
      ? null
      : { roll: track.roll[i] ?? 0, pitch: track.pitch[i] ?? 0, heading: track.heading[i] ?? 0 };
  }, linked);
  const slider = h("input", {
    type: "range",
    min: String(linked.start),
    max: String(linked.stop),
    step: "any",
    value: String(linked.start),
    "aria-label": t("time.at"),
    onInput: () => linked.point(Number(slider.value)),
  });
  const shown = h("output", null, "0 s");
  linked.onCursor(() => {
    if (linked.cursor === null) return;
    slider.value = String(linked.cursor);
    shown.textContent = `${linked.cursor.toFixed(1)} s`;
  });
  let playing = 0;
  const play = h(
    "button",
    {
      type: "button",
      onClick: () => {
        window.clearInterval(playing);
        if (play.textContent === t("space.stop")) return (play.textContent = t("space.play"));
        play.textContent = t("space.stop");
        const step = (linked.stop - linked.start) / 900;
        playing = window.setInterval(() => {
          const next = Number(slider.value) + step;
          linked.point(next > linked.stop ? linked.start : next);
          if (!play.isConnected) window.clearInterval(playing);
        }, 33);
        return undefined;
      },
    },
    t("space.play"),
  );
  const element = h(
    "div",
    null,
    h("div", { class: "time-bar" }, play, slider, shown),
    h("div", { class: "track-grid" }, plan.element, space.element, horizon.element),
  );
  return { element, redraw: () => (plan.redraw(), space.redraw(), horizon.redraw()) };
}
