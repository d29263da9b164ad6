// Noise of the inertial sensors: Allan deviations, the coefficients read from them, spectra.
import { api, type AxisNoise, type Figure, type Noise } from "../api";
import { h } from "../dom";
import { number, t } from "../i18n";
import { Linked } from "../plots/linked";
import { TimePlot, linkCursors, type Along } from "../plots/timeplot";
import { table } from "./overview";
import type { View } from "./track";

/** As it is printed: "deg/h/sqrt(Hz)" as "°/h/√Hz". */
const printed = (unit: string) => unit.replace(/sqrt\((\w+)\)/, "√$1").replace("deg", "°");

type Curve = (a: AxisNoise) => { x: number[]; y: number[] };

function curves(axes: AxisNoise[], title: string, unit: string, along: Along, curve: Curve): TimePlot {
  const all = axes.map(curve);
  // the axes of one sensor share their abscissae
  const x = all[0]!.x;
  const linked = new Linked(x[0] ?? 1e-3, x.at(-1) ?? 1);
  return new TimePlot(
    {
      title,
      unit: printed(unit),
      height: 300,
      logY: true,
      along: { ...along, log: true },
      lines: axes.map((a, ink) => ({ label: a.axis, ink })),
      load: async (from, to) => {
        const inside = x.flatMap((v, i) => (v >= (from ?? 0) && v <= (to ?? Infinity) ? [i] : []));
        return { x: inside.map((i) => x[i]!), y: all.map((c) => inside.map((i) => c.y[i]! || null)) };
      },
    },
    linked,
  );
}

function coefficients(noise: Noise): HTMLElement {
  const names = ["quantization", "white", "bias_instability", "random_walk", "ramp"] as const;
  const said = (f: Figure) => (f.value ? `${number(f.value, 3)} ${printed(f.unit)}` : "–");
  return table(
    [t("noise.axis"), ...names.map((n) => t(`noise.${n}`))],
    noise.axes.map((a) => [`${t(`noise.${a.sensor}`)} ${a.axis}`, ...names.map((n) => said(a[n]))]),
    t("noise.table"),
  );
}

export async function noiseView(of: "runs" | "datasets", name: string): Promise<View> {
  const noise = await api.noise(of, name);
  const tau: Along = { label: t("noise.tau"), unit: "s", name: "tau_s" },
    frequency: Along = { label: t("noise.frequency"), unit: "Hz", name: "frequency_hz" };
  const plots = (["gyro", "accel"] as const).flatMap((sensor) => {
    const axes = noise.axes.filter((a) => a.sensor === sensor);
    if (axes.length === 0) return [];
    return [
      curves(axes, `${t("noise.allan")}: ${t(`noise.${sensor}`)}`, axes[0]!.unit, tau, ({ allan }) => ({
        x: allan.tau_s,
        y: allan.deviation,
      })),
      curves(axes, `${t("noise.spectrum")}: ${t(`noise.${sensor}`)}`, axes[0]!.density_unit, frequency, ({ spectrum }) => ({
        x: spectrum.frequency_hz,
        y: spectrum.density,
      })),
    ];
  });
  for (const plot of plots) linkCursors([plot], plot.linked);
  const element = h(
    "div",
    null,
    h(
      "p",
      { class: "muted" },
      t("noise.lead", { s: number(noise.duration_s), rate: number(noise.rate_hz), gaps: noise.gaps }),
      " ",
      t("noise.rest"),
    ),
    h("div", { class: "plots wide-plots" }, ...plots.map((p) => p.element)),
    coefficients(noise),
  );
  return { element, redraw: () => plots.forEach((p) => p.redraw()) };
}
