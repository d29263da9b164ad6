// Numbers of the page of `schuler ui`, in headless Chromium: first paint, opening of an hour's run at 100 Hz, frames a second while
// two million rows are panned and zoomed, a thousand runs in the list, size of the bundle. Exit status 1 where one misses its goal.
//   node bench/ui_bench.mjs --program build/bin/schuler --modules build/ui/node_modules --dist ui/bundle
// Measured is the page in the program, as its server sends it; it must be that of --dist.
import { spawn, spawnSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { gzipSync } from "node:zlib";

const options = Object.fromEntries(
  process.argv.slice(2).flatMap((a, i, all) => (a.startsWith("--") ? [[a.slice(2), resolve(all[i + 1])]] : [])),
);
const { chromium } = createRequire(join(options.modules, "x.js"))("playwright-core");
let missed = 0;
/** A measured number with its unit; `goal`: [at most | at least, number], or none. */
const row = (name, value, unit, digits = 0, goal = null) => {
  const good = goal === null || (goal[0] === "at most" ? value <= goal[1] : value >= goal[1]);
  if (!good) ++missed;
  console.log(`${name.padEnd(62)} ${`${value.toFixed(digits)} ${unit}`.padStart(12)}   ${goal ? `${goal.join(" ")}${good ? "" : "   MISSED"}` : ""}`);
};

let bytes = 0;
for (const file of readdirSync(options.dist, { recursive: true, withFileTypes: true }))
  if (file.isFile()) bytes += gzipSync(readFileSync(join(file.parentPath ?? file.path, file.name)), { level: 9 }).length;
row("bundle, compressed", bytes / 1024, "KiB", 0, ["at most", 400]);

const folder = mkdtempSync(join(tmpdir(), "schuler_ui_bench_"));
const work = join(folder, "work");
const scenario = (duration, rate) => `name = "long"
duration_s = ${duration}
reference_rate_hz = ${rate}
[trajectory]
type = "great_circle"
start = { lat_deg = 50.0, lon_deg = 8.0, height_m = 9000.0 }
heading_deg = 80
speed_m_s = 200
[imu]
rate_hz = ${rate}
grade = "tactical"
[gnss]
rate_hz = 1
receiver = "autonomous"
[filter]
initial_error = { level_deg = 0.02, heading_deg = 0.1, velocity_m_s = 0.1, position_m = 5 }
`;
for (const [name, duration] of [
  ["hour", 3600],
  ["million", 20000],
]) {
  const file = join(folder, `${name}.toml`);
  writeFileSync(file, scenario(duration, 100));
  const done = spawnSync(
    options.program,
    ["run", file, "-o", join(work, name), "--output-rate", "100", "--outputs", "summary,h5"],
    { encoding: "utf8" },
  );
  if (done.status !== 0) throw new Error(done.stderr);
}
cpSync(join(work, "hour"), join(work, "hour-2"), { recursive: true });
// a thousand runs: what the list reads of each
for (let i = 0; i < 1000; ++i) {
  const run = join(work, `kept-${i}`);
  mkdirSync(run);
  cpSync(join(work, "hour", "summary.json"), join(run, "summary.json"));
  writeFileSync(join(run, "run.json"), JSON.stringify({ title: `Kept ${i}`, created: 1_700_000_000 + i, kind: "dataset", state: "done" }));
}
const server = spawn(options.program, ["ui", "--port", "0", "--workspace", work], { stdio: ["ignore", "pipe", "inherit"] });
const entrance = await new Promise((r) => server.stdout.on("data", (d) => r(/http:\S+/.exec(String(d))[0])));
const address = new URL("/", entrance).href;
const browser = await chromium.launch({ executablePath: options.browser ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
const token = { headers: { Authorization: `Bearer ${new URL(entrance).searchParams.get("token")}` } };
for (const file of readdirSync(join(options.dist, "assets"))) {
  const sent = Buffer.from(await (await fetch(`${address}assets/${file}`, token)).arrayBuffer());
  if (!sent.equals(readFileSync(join(options.dist, "assets", file)))) throw new Error(`${file} in the program is another one: build the program`);
}
const page = await context.newPage();
const median = (all) => [...all].sort((a, b) => a - b)[all.length >> 1];

const paints = [];
for (let i = 0; i < 5; ++i) {
  await page.goto("about:blank");
  await page.goto(entrance);
  await page.locator("h1").waitFor();
  paints.push(await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime));
}
row("first contentful paint, median of 5", median(paints), "ms", 0, ["at most", 500]);

// the quality control first: it is what a run opens with, and what has it checked by a child process
for (const [what, run, tab, ready] of [
  ["its quality control", "hour", "overview", ".quality figure.plot .u-over"],
  ["plots of errors", "hour-2", "errors", "figure.plot .u-over"],
]) {
  const opened = [];
  for (let i = 0; i < 4; ++i) {
    await page.goto("about:blank");
    const begin = performance.now();
    await page.goto(`${address}#/run/${run}/${tab}`);
    await page.locator(ready).nth(2).waitFor();
    opened.push(performance.now() - begin);
  }
  row(`an hour at 100 Hz: address to ${what}, first time`, opened[0], "ms", 0, ["at most", 1000]);
  row("the same, later", Math.min(...opened.slice(1)), "ms");
}

const lists = [];
for (let i = 0; i < 3; ++i) {
  await page.goto("about:blank");
  const begin = performance.now();
  await page.goto(address);
  await page.locator("table.runs tbody tr").nth(40).waitFor();
  lists.push(performance.now() - begin);
}
row("1000 runs: address to their list, first time", lists[0], "ms", 0, ["at most", 1000]);
row("the same, later", Math.min(...lists.slice(1)), "ms");
const searched = await page.evaluate(async () => {
  const box = document.querySelector('input[type="search"]');
  box.value = "kept 77";
  const begin = performance.now();
  box.dispatchEvent(new Event("input"));
  await new Promise((r) => requestAnimationFrame(() => setTimeout(r, 0)));
  return performance.now() - begin;
});
row("a word is searched among them", searched, "ms", 0, ["at most", 100]);

await page.goto(`${address}#/run/million/errors`);
await page.locator("figure.plot .u-over").nth(2).waitFor();
await page.waitForTimeout(1000);
const shown = await page.evaluate(async () => {
  const groups = await (await fetch("/api/runs/million/channels")).json();
  return groups.find((g) => g.group === "/errors").rows;
});
row("rows of the run that is moved", shown, "", 0, ["at least", 1_990_000]);
const moved = await page.evaluate(
  () =>
    new Promise((done) => {
      const { plot } = document.querySelector("figure.plot");
      const { linked } = plot;
      const frames = [];
      let covered = 0;
      const begin = performance.now();
      linked.set(4000, 8000);
      const step = (now) => {
        frames.push(now);
        if (plot.loaded && plot.loaded[0] <= linked.from && plot.loaded[1] >= linked.to) ++covered;
        const t = (now - begin) / 1000;
        // there and back, and closer and farther, all the time
        const middle = 10000 + 5000 * Math.sin(1.2 * t),
          half = 1800 * (1 + 0.8 * Math.sin(2 * t));
        linked.set(middle - half, middle + half);
        if (t < 8) requestAnimationFrame(step);
        else done({ frames, covered });
      };
      requestAnimationFrame(step);
    }),
);
const { frames, covered } = moved;
const steps = frames.slice(1).map((t, i) => t - frames[i]);
// the display shows 60 a second: 59.5 is every one of them
row("pan and zoom: frames a second, mean over 8 s", 1000 / (steps.reduce((a, b) => a + b) / steps.length), "", 1, ["at least", 59.5]);
row("of them with numbers in the whole range", (100 * covered) / frames.length, "%");
row("longest frame of 95 %", [...steps].sort((a, b) => a - b)[Math.floor(0.95 * steps.length)], "ms");
const asked = [];
for (let i = 0; i < 10; ++i) {
  const begin = performance.now();
  await (
    await fetch(
      `${address}api/runs/million/series?columns=/errors/position:east,/errors/std_position:east&from=${i * 500}&to=${i * 500 + 5000}&points=1200`,
      token,
    )
  ).text();
  asked.push(performance.now() - begin);
}
row("server: 500 000 rows thinned to 1200 points, median of 10", median(asked), "ms", 1);
await browser.close();
server.kill("SIGTERM");
rmSync(folder, { recursive: true, force: true });
console.log(`ui_bench: ${missed} goals missed`);
process.exit(missed ? 1 : 0);
