// What the page computes by itself: exports, derived signals, grids of outages. No browser, no program.
//   node unit_test.mjs --modules NODE_MODULES
// Exit status 0 passed, 1 failed, 77 skipped.
import { readFileSync } from "node:fs";
import { optionsOf } from "./browse.mjs";
import { modules, pretend } from "./unit.mjs";
import { contrast, distance, visions } from "./vision.mjs";

const options = optionsOf(process.argv.slice(2));
let failures = 0;
const check = (condition, text) => {
  if (condition) return;
  ++failures;
  console.error(`FAILED: ${text}`);
};
pretend({ "--ink-1": "#000001", "--ink-2": "#000002", "--ink-3": "#000003", "--rejected": "#ff0000", "--excluded": "#00ff00" });

/** CSV, SVG and PNG have the colours, axes and units of the plot. */
async function exports_() {
  const [{ csvOf, shownLines }, { svgOf }, { innovationLines }] = await modules(options.modules, "plots/exports", "plots/svg", "pages/views");
  const settings = {
    title: "t",
    unit: "m",
    rightUnit: "m/s",
    lines: [{ label: "a" }, { label: "r", paint: "--rejected", dots: true }, { label: "b", right: true }],
    load: null,
  };
  const data = { x: [0, 10], y: [[0, 1], [null, 1], [100, 200]] };
  const rows = csvOf(settings, data).split("\n");
  check(rows[0] === "time_s,a (m),r (m),b (m/s)", `each column of the CSV has the unit of its axis: ${rows[0]}`);
  check(rows[2] === "10,1,1,200", `and its numbers: ${rows[2]}`);
  const lines = shownLines(settings, new Set([0]));
  check(lines[1].colour === "#ff0000" && lines[0].hidden && lines[2].right, `lines in the colours of the plot: ${JSON.stringify(lines)}`);
  const chart = { data: [data.x, ...data.y], scales: { x: { min: 0, max: 10 }, y: { min: 0, max: 1 }, y2: { min: 100, max: 200 } } };
  const svg = svgOf(chart, { title: "t", unit: "m", rightUnit: "m/s", along: "time, s" }, shownLines(settings, new Set()), null, []);
  const drawn = [...svg.matchAll(/<path d="(M[^"]+)" stroke="(#[0-9a-f]+)" stroke-width="1.4"/g)];
  check(drawn.length === 2 && drawn[0][1] === drawn[1][1], `a line on the right axis has the scale of that axis: ${drawn.map((d) => d[1])}`);
  check(/<circle[^>]*fill="#ff0000"/.test(svg), "rejected ones have their own colour in the SVG");
  check(svg.includes(">m/s</text>") && svg.includes(">200</text>"), "the right axis has its numbers and its unit");

  const parts = innovationLines([1, 2, 3, 4], [1, 1, 1, 1], [0, 1, 2, 3]);
  check(JSON.stringify(parts.slice(0, 3)) === "[[1,null,null,null],[null,2,null,null],[null,null,null,4]]", `accepted, rejected, excluded: ${JSON.stringify(parts)}`);
  check(JSON.stringify(parts[3]) === "[3,3,null,3]", `the band leaves out what is withheld: ${JSON.stringify(parts[3])}`);
}

const near = (a, b, by) => Math.abs(a - b) <= by;

/** Signals made of signals, against what is known in closed form. */
async function derivedSignals() {
  const [{ derived, norm }, { thinned, sameTimes }, { signalLoader, neededRange }] = await modules(options.modules, "plots/derive", "plots/thin", "pages/signaldata");
  const uneven = [0, 1, 3, 4];
  check(derived(uneven, [0, 1, 3, 4], "integral", 1).join() === "0,0.5,4.5,8", `the integral of t is t^2/2 at uneven times: ${derived(uneven, [0, 1, 3, 4], "integral", 1)}`);
  check(derived(uneven, [5, 7, 11, 13], "derivative", 1).slice(1).join() === "2,2,2", "the slope of a line");
  check(derived([0, 1, 2], [1, null, 3], "derivative", 1).every((v) => v === null), "no slope across a gap");
  check(derived(uneven, [1, 2, null, 3], "mean", 1).join() === "-1,0,,1", "without its mean");
  const time = Array.from({ length: 1001 }, (_, i) => i / 100);
  const step = derived(time, time.map((x) => (x < 1 ? 0 : 1)), "lowpass", 2);
  check(near(step[300], 1 - Math.exp(-1), 0.005), `a step after one time constant: ${step[300]}`);
  check(norm([[3, null], [4, 1]]).join() === "5,", "the length of a vector");

  // a fast wave in many rows: of the extremes of intervals its derivative and mean would be others
  const n = 120_000,
    rate = 100,
    times = Array.from({ length: n }, (_, i) => i / rate),
    wave = times.map((x) => Math.sin(2 * Math.PI * 5 * x) + 0.1 * x),
    flat = times.map(() => 1);
  const asked = [];
  const most = 500_000;
  const source = (limit) => async (ids, range) => {
    asked.push(range);
    const first = range.from === undefined ? 0 : Math.max(0, times.findIndex((x) => x >= range.from) - 1),
      last = range.to === undefined ? n : times.findIndex((x) => x > range.to) + 1 || n;
    const all = { time: times.slice(first, last), columns: ids.map((id) => (id === "flat" ? flat : wave).slice(first, last)) };
    const few = range.points === 0 ? all.time.length > limit : all.time.length > 2 * range.points;
    const { time, columns } = few ? thinned(all.time, all.columns, range.points || 1000) : all;
    return { time_s: time, columns: Object.fromEntries(ids.map((id, i) => [id, columns[i]])), thinned: few };
  };
  const load = async (signal, from, to, limit = most) => signalLoader(source(limit), (id) => [id])(Array.isArray(signal) ? signal : [signal])(from, to, 600, new AbortController().signal);
  const top = (v) => v.reduce((a, x) => (x !== null && x > a ? x : a), -Infinity);
  const slope = await load({ id: "wave", operation: "derivative" });
  const steepest = 2 * Math.PI * 5 * (Math.sin((Math.PI * 5) / rate) / ((Math.PI * 5) / rate)) * Math.cos((Math.PI * 5) / rate) + 0.1; // of samples 18 degrees of phase apart
  check(near(top(slope.y[0]), steepest, 0.01) && !slope.thinned, `the steepest slope of 120 000 rows: ${top(slope.y[0])}, ${steepest}`);
  check(slope.x.length < 5000, `and few points are drawn: ${slope.x.length}`);
  const sum = await load({ id: "wave", operation: "integral" }, 600, 610);
  const at = sum.x.findIndex((x) => x >= 600);
  check(near(sum.y[0][at], 0.05 * 600 ** 2, 0.1), `an integral starts with the log, whatever is shown: ${sum.y[0][at]}`);
  check(sum.x.length < 1010 && sum.x[0] >= 599.9, `and only what is shown is drawn: ${sum.x[0]}, ${sum.x.length}`);
  const less = await load({ id: "wave", minus: "flat" }, 100, 200);
  check(near(top(less.y[0]), 20, 0.05), `a difference of every row: ${top(less.y[0])}`);
  const smooth = await load({ id: "wave", operation: "lowpass", seconds: 10 }, 600, 620);
  const first = smooth.x.findIndex((x) => x >= 600);
  check(near(smooth.y[0][first], 0.1 * (600 - 10), 0.1), `a low-pass has settled where the picture begins: ${smooth.y[0][first]}`);
  check(neededRange({ id: "a", operation: "mean" }, 1, 2).from === undefined, "a mean is that of everything");
  check((await load({ id: "wave", operation: "derivative" }, undefined, undefined, 1000)).thinned, "too many rows are told");
  check(!(await load({ id: "wave" })).thinned && asked.at(-1).points === 600, "a column as it is needs no more than the picture");

  check(!sameTimes([0, 1, 3], [0, 2, 3]) && sameTimes([0, 1], [0, 1]), "times are the same if each of them is");
  const other = async (ids) => (ids[0] === "a" ? { time_s: [0, 1, 3], columns: { a: [0, 1, 3] } } : { time_s: [0, 2, 3], columns: { b: [0, 2, 3] } });
  const both = await signalLoader(other, (id) => [id])([{ id: "a" }, { id: "b" }])(undefined, undefined, 100, new AbortController().signal);
  check(both.x.join() === "0,1,2,3" && both.y[0].join() === "0,1,2,3" && both.y[1].join() === "0,1,2,3", `signals of different times: ${JSON.stringify(both)}`);

  const spike = flat.map((v, i) => (i === 77_777 ? 50 : i === 50_000 ? null : v));
  const drawn = thinned(times, [spike], 300);
  check(drawn.columns[0].includes(50) && drawn.columns[0].includes(null) && drawn.time.length < 1300, `extremes and gaps stay: ${drawn.time.length}`);
}

/** Limits of nearly all values: ten thousand of them, and a few that are far away. */
async function limits() {
  const [{ usualLimits }] = await modules(options.modules, "plots/scales");
  const x = Array.from({ length: 10_000 }, (_, i) => i),
    y = x.map((i) => (i % 1000 === 500 ? 900 : Math.sin(i)));
  const { limits, outside } = usualLimits({ x, y: [y] }, 1, { from: 0, to: 9999 }, -1, 900);
  check(limits[0] === -1 && limits[1] < 3 && outside === 10, `${limits}, ${outside} outside`);
}

/** Which columns are the components of a vector. */
async function vectors() {
  const [{ vectorsOf }] = await modules(options.modules, "pages/signals");
  const of = (...names) => vectorsOf(names.map((name) => ({ name }))).map((v) => `${v.stem}:${v.parts.map((p) => p.name)}`).join("; ");
  check(of("x", "y", "z") === ":x,y,z" && of("north", "east", "down") === ":north,east,down", `of a table: ${of("x", "y", "z")}`);
  check(of("gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2", "temp_c") === "gyro_rad_s:gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s; accel_m_s2:accel_x_m_s2,accel_y_m_s2,accel_z_m_s2", `of a log: ${of("gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s")}`);
  check(of("lat_deg", "lon_deg", "height_m") === "" && of("x", "y") === "", "others are none");
}

/** Colours of lines are told apart by every reader, and from the surface that they are drawn on. */
async function palette() {
  check(Math.abs(distance("#ff0000", "#00ff00", "normal") - 170.6) < 0.1, "the distance of red and green");
  check(distance("#d55e00", "#8f8f00", "deuteranopia") < 0.5 * distance("#d55e00", "#8f8f00", "normal"), "orange and olive come near in deuteranopia");
  const css = readFileSync(new URL("../src/style.css", import.meta.url), "utf8");
  const least = 10,
    leastContrast = 3;
  for (const theme of [":root", '[data-theme="dark"]']) {
    const at = css.indexOf(`${theme} {`);
    const paints = Object.fromEntries([...css.slice(at, css.indexOf("}", at)).matchAll(/--([\w-]+): (#[0-9a-f]{6});/g)].map((m) => [m[1], m[2]]));
    paints.surface ??= "#ffffff";
    const series = Array.from({ length: 9 }, (_, i) => `ink-${i + 1}`);
    const told = ["rejected", "excluded"];
    const meant = ["fix-none", "fix-single", "fix-differential", "fix-float", "fix-fixed", "fix-unknown", "warn", ...told];
    const health = ["ink-1", "ink-4", "ink-6", "ink-7", "fix-none", ...told];
    for (const [what, names] of [["series", [...series, ...told]], ["meanings", meant], ["health", health]])
      for (const vision of Object.keys(visions)) {
        let worst = [Infinity, ""];
        names.forEach((a, i) => names.slice(0, i).forEach((b) => {
          const d = distance(paints[a], paints[b], vision);
          if (d < worst[0]) worst = [d, `${a} and ${b}`];
        }));
        check(worst[0] >= least, `${theme}, ${what}, ${vision}: ${worst[1]} differ by ${worst[0].toFixed(1)}`);
      }
    for (const name of [...series, ...meant]) check(contrast(paints[name], paints.surface) >= leastContrast, `${theme}: ${name} has ${contrast(paints[name], paints.surface).toFixed(2)} : 1`);
  }
}

/** What happened, from the health of the sources; marks that are too many. */
async function events() {
  const [{ ofHealth, marksOf }, { stateAt }] = await modules(options.modules, "pages/events", "plots/healthline");
  const health = [
    { source: "imu", state: "used", from_s: 0, to_s: 50, samples: 5000, used: 5000 },
    { source: "imu", state: "silent", from_s: 50, to_s: 53, samples: 0, used: 0 },
    { source: "imu", state: "used", from_s: 53, to_s: 100, samples: 4700, used: 4700 },
    { source: "gnss_position", state: "left out", from_s: 20, to_s: 25, samples: 6, used: 0 },
    { source: "gnss_position", state: "silent", from_s: 60, to_s: 70, samples: 0, used: 0 },
    { source: "baro", state: "refused", from_s: 60, to_s: 70, samples: 3, used: 0 },
  ];
  const found = ofHealth(health);
  check(found.map((e) => `${e.from}-${e.to} ${e.what}`).join("; ") === "50-53 gap of the inertial unit; 20-25 GNSS position: left out before the run; 60-70 no GNSS", `events of health: ${JSON.stringify(found)}`);
  check(stateAt(health, "imu", 51) === "silent" && stateAt(health, "imu", 99) === "used" && stateAt(health, "baro", 1) === null, "the state at a time");
  const many = Array.from({ length: 900 }, (_, i) => ({ from: i, to: i, what: "", note: "", paint: i % 3 === 0 ? "--rejected" : "--good" }));
  check(marksOf(many).length === 300 && marksOf(many).every((m) => m.at % 3 === 0), `of too many marks those of rests are left out: ${marksOf(many).length}`);
  check(marksOf(many.slice(0, 90)).length === 90, "everything is marked, rests too");
}

/** Windows without GNSS: clear of the start, inside the log, and found again in the order of a run. */
async function grids() {
  const [{ outageGrid, gridOf, usualGrid }] = await modules(options.modules, "pages/outagegrid");
  const grid = { length: 30, spacing: 100, clear: 120 };
  check(outageGrid(400, grid).join() === "120:30,220:30,320:30", `windows: ${outageGrid(400, grid)}`);
  check(outageGrid(350, grid).join() === "120:30,220:30,320:30" && outageGrid(349, grid).length === 2, "the last one ends with the log");
  check(outageGrid(1000, { ...grid, spacing: 30 }).length === 0 && outageGrid(100, grid).length === 0 && outageGrid(1000, { ...grid, length: NaN }).length === 0, "windows that touch, or have no room, are none");
  check(JSON.stringify(gridOf(outageGrid(400, grid))) === JSON.stringify(grid), "a run tells its grid");
  check(JSON.stringify(gridOf(["120:30,220:30"])) === JSON.stringify(grid), "also in one word");
  check(gridOf(["120:30", "220:30", "330:30"]) === null && gridOf(["1:2"]) === null && gridOf(undefined) === null, "other windows are none");
  for (const duration of [120, 240, 600, 3600]) check(outageGrid(duration, usualGrid(duration)).length > 1, `a log of ${duration} s has windows: ${outageGrid(duration, usualGrid(duration))}`);
}

/** Time left counts from the start of the process, and is told only where it is known how far the work is. */
async function progress() {
  const [{ timeLeft, partDone, progressWords }] = await modules(options.modules, "pages/progress");
  const at = (more) => ({ id: "a", state: "running", progress: 0.25, stage: "filtering", spent_s: 30, message: "", ...more });
  check(timeLeft(at({})) === 90, `a quarter in 30 s: ${timeLeft(at({}))}`);
  check(timeLeft(at({ stage: "checking", progress: 0.99 })) === null && partDone(at({ stage: "checking", progress: 0.99 })) === null, "the end of the filter is not that of the run");
  check(timeLeft(at({ progress: 0.01 })) === null && timeLeft(at({ spent_s: 0 })) === null, "the first moments say nothing");
  check(progressWords(at({})) === "filtering and smoothing · 25 % · about 90 s left", progressWords(at({})));
  check(progressWords(at({ stage: "reading", progress: 0 })) === "reading the logs", progressWords(at({ stage: "reading", progress: 0 })));
}

/** Distances and sizes of letters are those of the scales; texts of drawings are in the units of the drawing. */
async function scales() {
  const css = readFileSync(new URL("../src/style.css", import.meta.url), "utf8").replace(/\/\*[^]*?\*\//g, "");
  for (const scale of ["space", "font"]) check([...css.matchAll(new RegExp(`--${scale}-\\d:`, "g"))].length >= 6, `a scale of six: ${scale}`);
  const rules = [...css.matchAll(/([^{}]+)\{([^{}]*)\}/g)].flatMap(([, selector, body]) => body.split(";").map((line) => [selector.trim(), ...line.split(/:(.*)/s).map((x) => x?.trim())]));
  for (const [selector, property, value] of rules) {
    if (/^(padding|margin|gap|row-gap|column-gap)/.test(property ?? "")) check(/^((var\(--space-\d\)|calc\(2 \* var\(--space-6\)\)|0|auto|[1-6]px|!important)\s*)+$/.test(value), `${selector}: ${property}: ${value}`);
    if (property === "font-size" && !/^\.sky-/.test(selector)) check(/^var\(--font-\d\)$/.test(value), `${selector}: ${property}: ${value}`);
  }
}

for (const step of [scales, exports_, derivedSignals, limits, vectors, palette, events, grids, progress])
  try {
    await step();
  } catch (e) {
    check(false, `${step.name}: ${e.stack ?? e}`);
  }
console.log(`unit: ${failures} failures`);
process.exit(failures ? 1 : 0);
