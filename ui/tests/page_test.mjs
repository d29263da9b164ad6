// The page of `schuler ui` in a real browser on real runs, as a user goes through it.
//   node page_test.mjs --program SCHULER --modules NODE_MODULES [--browser CHROMIUM] [--shots FOLDER]
// Exit status 0 passed, 1 failed, 77 skipped (no browser, or no packages for it).
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

const options = Object.fromEntries(
  process.argv.slice(2).flatMap((a, i, all) => (a.startsWith("--") ? [[a.slice(2), all[i + 1]]] : [])),
);
const skip = (why) => {
  console.log(`SKIPPED: ${why}`);
  process.exit(77);
};
const browserPath = options.browser ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
if (!browserPath || !existsSync(browserPath)) skip("there is no Chromium");
if (!existsSync(join(options.modules, "playwright-core"))) skip("there is no playwright-core; scripts/build_ui.sh installs it where npm reaches a registry");
const require = createRequire(join(options.modules, "x.js"));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

// the example flight, and where GNSS is cut in it, s
const duration = 600,
  cutFrom = 350,
  cutTo = 420;
let failures = 0;
const check = (condition, text) => {
  if (condition) return;
  ++failures;
  console.error(`FAILED: ${text}`);
};
const folder = mkdtempSync(join(tmpdir(), "schuler_page_"));
const server = spawn(options.program, ["ui", "--port", "0", "--workspace", join(folder, "work")], {
  cwd: folder,
  stdio: ["ignore", "pipe", "inherit"],
});
const entrance = await new Promise((resolve, reject) => {
  server.stdout.on("data", (d) => {
    const found = /http:\S+/.exec(String(d));
    if (found) resolve(found[0]);
  });
  server.on("exit", () => reject(new Error("the server ended")));
});
// The token of the entrance becomes a cookie; from then on the page asks without it.
const address = new URL("/", entrance).href, token = new URL(entrance).searchParams.get("token");
const browser = await chromium.launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, acceptDownloads: true, colorScheme: "light" });
await context.addInitScript(() => {
  if (window.top === window) localStorage.getItem("schuler.language") ?? localStorage.setItem("schuler.language", "en");
});
const page = await context.newPage();
page.setDefaultTimeout(30_000);
page.on("pageerror", (e) => check(false, `error on the page: ${e.message}`));
page.on("console", (m) => m.type() === "error" && !/4\d\d \(/.test(m.text()) && check(false, `console: ${m.text()}`));
page.on("request", (r) => check(r.url().startsWith(address) || /^(data|blob):/.test(r.url()), `asks another server: ${r.url()}`));

const ask = async (path) => (await fetch(address + path, { headers: { Authorization: `Bearer ${token}` } })).json();
const shot = async (name) => {
  if (!options.shots) return;
  mkdirSync(options.shots, { recursive: true });
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.waitForTimeout(700);
  await page.screenshot({ path: join(options.shots, `${name}.png`) });
};
const accessible = async (where) => {
  await page.evaluate(axe);
  const found = await page.evaluate(() =>
    globalThis.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] }),
  );
  for (const v of found.violations)
    check(
      false,
      `${where}: ${v.id} (${v.impact}): ${v.help}: ${v.nodes
        .slice(0, 2)
        .map((n) => n.html.slice(0, 160))
        .join(" | ")}`,
    );
};
/** The page allows no evaluation of texts, so conditions are asked for from here. */
const soon = async (condition) => {
  for (let i = 0; i < 50; ++i) {
    if (await condition()) return true;
    await page.waitForTimeout(100);
  }
  return false;
};
const done = async () => {
  await page.getByRole("tab", { name: "Overview" }).waitFor({ timeout: 120_000 });
  return decodeURIComponent(/#\/run\/([^/]+)/.exec(page.url())[1]);
};

async function start() {
  await page.goto(entrance);
  await page.getByRole("heading", { name: "Integrated inertial-satellite navigation" }).waitFor();
  await accessible("start");
}

/** The example flight: its form, a wrong entry, the run with its progress. */
async function flight() {
  await page.locator('a[href="#/scenario?example=uav-mems"]').click();
  await page.getByRole("heading", { name: "Scenario", exact: true }).waitFor();
  const track = page.getByText(/km, up to/);
  await track.waitFor();
  const whole = await track.innerText();
  const length = page.locator("#option-duration_s");
  check((await length.inputValue()) === String(duration), "the form carries the scenario");
  await length.fill("ten");
  check(
    /Expected: a number/.test(await page.locator("#option-duration_s-wrong").innerText()),
    "a wrong entry is explained beside the field",
  );
  await length.fill(String(duration / 2));
  check(await soon(async () => parseFloat(await track.innerText()) < 0.9 * parseFloat(whole)), "the track follows what is typed");
  await length.fill(String(duration));
  check(await soon(async () => (await track.innerText()) === whole), "and back");
  await accessible("scenario");
  await shot("ui-scenario");
  // without the outages of the example
  const removes = page.locator(".outage button");
  while ((await removes.count()) > 0) await removes.first().click();
  await page.getByLabel("Name", { exact: true }).fill("Flight");
  await page.waitForTimeout(400);
  await page.getByRole("button", { name: /Run/ }).click();
  const id = await done();
  check((await page.locator(".stat strong").count()) >= 3, "the overview has its figures");
  await accessible("overview");
  return id;
}

/** Every view draws, plots are zoomed by keys and mouse, and what is exported is what is shown. */
async function views(id) {
  for (const tab of ["Track", "Sensor errors", "Innovations", "Motion", "Table", "Report", "Log", "Errors"]) {
    await page.getByRole("tab", { name: tab, exact: true }).click();
    await page.waitForTimeout(tab === "Track" ? 1500 : 500);
    check((await page.locator("#view > *").count()) > 0, `${tab} shows something`);
    await accessible(tab);
    if (tab === "Track") await shot("ui-track");
  }
  const plot = page.locator("figure.plot").first();
  await plot.locator("canvas").waitFor();
  const range = () =>
    page.evaluate(() => {
      const p = document.querySelector("figure.plot").plot;
      return [p.linked.from, p.linked.to];
    });
  const before = await range();
  await plot.focus();
  await page.keyboard.press("+");
  await page.keyboard.press("+");
  await page.keyboard.press("ArrowRight");
  const zoomed = await range();
  check(zoomed[1] - zoomed[0] < 0.5 * (before[1] - before[0]), `keys zoom: ${before} to ${zoomed}`);
  await page.keyboard.press("0");
  const box = await plot.locator(".u-over").boundingBox();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 50);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 52, { steps: 5 });
  await page.mouse.up();
  const boxed = await range();
  check(
    Math.abs(boxed[0] - 0.4 * before[1]) < 10 && Math.abs(boxed[1] - 0.6 * before[1]) < 10,
    `a drag zooms into the range: ${boxed}`,
  );
  const save = async (name) => {
    const [file] = await Promise.all([page.waitForEvent("download"), plot.getByRole("button", { name }).click()]);
    return readFileSync(await file.path());
  };
  const rows = String(await save(/Save as CSV/))
    .trim()
    .split("\n");
  const times = rows.slice(1).map((r) => Number(r.split(",")[0]));
  check(
    rows[0].startsWith("time_s,") && times.length > 100 && times[0] >= boxed[0] - 1 && times.at(-1) <= boxed[1] + 1,
    `CSV of what is shown: ${rows[0]} ${times.length}`,
  );
  const truth = await ask(`api/runs/${id}/series?columns=/errors/position:east&from=${boxed[0]}&to=${boxed[1]}&points=0`);
  check(
    Number(rows[5].split(",")[1]) === truth.columns["/errors/position:east"][4],
    "the numbers of the CSV are those of the run",
  );
  check(/<svg[^]*<path/.test(String(await save(/Save as SVG/))), "SVG");
  check((await save(/Save as PNG/)).subarray(1, 4).toString() === "PNG", "PNG");
  await plot.getByRole("button", { name: /Show everything/ }).click();
  check((await range())[1] === before[1], "and back to everything");
  await shot("ui-errors");
  await page.reload();
  await page.locator("figure.plot canvas").first().waitFor();
  check(
    (await page.getByRole("tab", { name: "Errors", exact: true }).getAttribute("aria-selected")) === "true",
    "a reload shows the same view",
  );
}

/** GNSS is cut on the time line: the error grows; both runs side by side. */
async function cut(first) {
  await page.getByRole("link", { name: "Change and run again" }).click();
  const line = page.locator("canvas.timeline");
  await line.scrollIntoViewIfNeeded();
  await page.waitForTimeout(500);
  const box = await line.boundingBox();
  const at = (s) => box.x + 10 + (s / duration) * (box.width - 20);
  await page.mouse.move(at(cutFrom), box.y + 20);
  await page.mouse.down();
  await page.mouse.move(at(cutTo), box.y + 20, { steps: 8 });
  await page.mouse.up();
  await page.getByLabel("Name", { exact: true }).fill("Flight with GNSS cut");
  await page.waitForTimeout(500);
  await page.getByRole("button", { name: /Run/ }).click();
  const second = await done();
  const worst = async (run) => {
    const s = await ask(
      `api/runs/${run}/series?columns=/errors/position:east,/errors/position:north&from=${cutFrom + 5}&to=${cutTo - 5}&points=0`,
    );
    return Math.max(...Object.values(s.columns).flat().map(Math.abs));
  };
  const [with_, without] = [await worst(first), await worst(second)];
  check(without > 2 * with_, `without GNSS the error grows: ${with_} m to ${without} m`);
  const run = await ask(`api/runs/${second}`);
  const [outage] = run.summary.outages;
  check(
    Math.abs(outage.start_s - cutFrom) < 5 && Math.abs(outage.duration_s - (cutTo - cutFrom)) < 5,
    `the outage is that of the time line: ${JSON.stringify(outage)}`,
  );
  return second;
}

/** Two satellites are left: ranges one by one steer on, fixes end. Both schemes compared. */
async function compare() {
  const ids = [];
  for (const scheme of ["tight", "loose"]) {
    await page.goto(`${address}#/scenario?example=triad-2sv`);
    await page.getByText(/km, up to/).waitFor();
    await page.getByPlaceholder("Find an option").fill("filter.scheme");
    await page.locator("#option-filter-scheme").selectOption(scheme);
    await page.getByLabel("Name", { exact: true }).fill(`Two satellites, ${scheme}`);
    await page.waitForTimeout(500);
    await page.getByRole("button", { name: /Run/ }).click();
    ids.push(await done());
    check((await ask(`api/runs/${ids.at(-1)}`)).summary.scheme === scheme, `the scheme is ${scheme}`);
  }
  await page.goto(address);
  for (const scheme of ["tight", "loose"])
    await page.getByRole("checkbox", { name: `Choose Two satellites, ${scheme}`, exact: true }).check();
  await page.getByRole("button", { name: "Compare" }).click();
  await page.getByRole("heading", { name: "Comparison" }).waitFor();
  await page.locator("figure.plot canvas").first().waitFor();
  const heads = await page.locator("thead th").allInnerTexts();
  check(
    ["Two satellites, tight", "Two satellites, loose"].every((name) => heads.includes(name)),
    `the table of statistics has the runs: ${heads}`,
  );
  const rms = async (id) => (await ask(`api/runs/${id}`)).summary.errors.position_m.horizontal.rms;
  const [tight, loose] = [await rms(ids[0]), await rms(ids[1])];
  check(tight < 0.8 * loose, `two ranges hold the position: tight ${tight} m, loose ${loose} m`);
  const row = await page.locator("tr", { has: page.getByRole("rowheader", { name: /horizontal/ }) }).first().innerText();
  check(row.includes(String(Number(tight.toPrecision(3)))) || row.includes(String(Number(tight.toPrecision(4)))), `the table shows ${tight}: ${row}`);
  const overlaid = page.locator("figure.plot:has(.u-legend)").first().locator(".u-legend .u-series");
  await overlaid.nth(2).waitFor().catch(() => {});   // a run's errors are drawn as they arrive
  check((await overlaid.count()) === 3, `errors are overlaid: ${await overlaid.allInnerTexts()}`);
  await page.waitForTimeout(800);
  await accessible("comparison");
  await shot("ui-compare");
  return ids;
}

/** Satellites, sensor noise: what is drawn is what the run says. */
async function ranges(tight, loose) {
  await page.goto(`${address}#/run/${tight}/sky`);
  await page.locator(".sky-now").first().waitFor();
  await page.locator("figure.plot canvas").nth(2).waitFor();
  const names = (await ask(`api/runs/${tight}/channels`)).find((g) => g.group === "/sky").columns.find((c) => c.names).names;
  check(names.every((n) => /^G\d\d$/.test(n)), `sources have their names: ${names}`);
  check((await page.locator(".sky-name").allTextContents()).sort().join() === [...names].sort().join(), "each satellite stands in the sky");
  check((await page.locator(".sky-now.status-0").count()) === 2, "two of them are still there at the end");
  check((await page.locator(".table-block tbody tr").count()) === names.length, "the table has the sources");
  await accessible("satellites");
  await shot("ui-sky");
  await page.goto(`${address}#/run/${loose}/sky`);
  await page.reload();
  await page.locator(".sky-name").first().waitFor();
  check((await page.locator(".sky-now.status-0").count()) === 0, "a scheme that uses fixes uses no ranges");
}

/** Ten minutes at rest: the noise that the scenario has is read from the log. */
async function noise() {
  await page.goto(`${address}#/scenario?example=static`);
  await page.getByText(/km, up to/).waitFor();
  await page.getByLabel("Name", { exact: true }).fill("At rest");
  await page.waitForTimeout(400);
  await page.getByRole("button", { name: /Run/ }).click();
  const id = await done();
  await page.getByRole("tab", { name: "Noise" }).click();
  await page.locator(".table-block tbody tr").nth(5).waitFor({ timeout: 60_000 });
  await page.locator("figure.plot canvas").nth(1).waitFor();
  const settings = await ask(`api/runs/${id}/settings`);
  const set = settings.used["imu.gyro_noise_deg_sqrt_h"];
  const told = (await ask(`api/runs/${id}/noise`)).axes[0].white.value;
  check(Math.abs(told / set - 1) < 0.05, `white noise of the gyro is that of the scenario: ${told}, ${set} deg/sqrt(h)`);
  const row = await page.locator(".table-block tbody tr").first().innerText();
  check(row.includes(String(Number(told.toPrecision(3)))), `the table says so: ${row}`);
  await accessible("noise");
  await shot("ui-noise");
}

/** Monte Carlo: how many runs, progress, cancel; then a short campaign with its table and plots. */
async function campaign() {
  const order = async (name, runs) => {
    await page.goto(address);
    await page.goto(`${address}#/scenario?example=triad-2sv`);
    await page.getByText(/km, up to/).waitFor();
    await page.getByLabel("What to do").selectOption("montecarlo");
    await page.getByLabel("Number of runs").fill(String(runs));
    await page.getByLabel("Name", { exact: true }).fill(name);
    await page.waitForTimeout(400);
    await page.getByRole("button", { name: /Run/ }).click();
  };
  await order("Long campaign", 500);
  const told = async () => Number(await page.locator("progress").getAttribute("value")) > 0;
  check((await soon(told)) || (await soon(told)) || (await soon(told)), "progress is told");
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByText("cancelled", { exact: false }).first().waitFor();
  await order("Campaign", 4);
  const id = await done();
  await page.getByRole("tab", { name: "Ensemble" }).click();
  await page.locator("figure.plot canvas").first().waitFor();
  check((await page.locator(".table-block tbody tr").count()) === 4, "a row a run");
  const run = await ask(`api/runs/${id}`);
  check(run.summary.montecarlo.runs === 4 && run.summary.montecarlo.failed === 0, "four runs went through");
  await accessible("campaign");
  await shot("ui-ensemble");
}

/** Gravity along the track. */
async function gravity() {
  await page.goto(`${address}#/scenario?example=gravity-flight`);
  await page.getByText(/km, up to/).waitFor();
  check((await page.getByLabel("What to do").inputValue()) === "gravity", "a survey is suggested where the scenario has one");
  await page.getByLabel("Name", { exact: true }).fill("Survey");
  await page.waitForTimeout(400);
  await page.getByRole("button", { name: /Run/ }).click();
  const id = await done();
  await page.getByRole("tab", { name: "Gravity" }).click();
  await page.locator("figure.plot canvas").nth(2).waitFor();
  const shown = await page.evaluate(() => {
    const { data, settings } = document.querySelector("figure.plot").plot;
    return { labels: settings.lines.map((l) => l.label), last: data.y.map((y) => y.at(-1)), km: data.x.at(-1) };
  });
  const { gravity } = (await ask(`api/runs/${id}`)).summary;
  // the summary speaks of up, the plot of down
  check(Math.abs(shown.last[0] + gravity.vertical_mgal.estimate) < 0.01, `the last estimate: ${shown.last} ${shown.labels}`);
  const truth = shown.last[shown.labels.indexOf("truth")];
  check(Math.abs(shown.last[0] - truth + gravity.vertical_mgal.final) < 0.01, `and the truth: ${truth}`);
  check(shown.km > 100, `along ${shown.km} km`);
  await accessible("gravity");
  await shot("ui-gravity");
}

/** Files that are no logs: what is wrong is said. */
async function upload() {
  const bad = join(folder, "imu.csv");
  writeFileSync(bad, "time_s,gyro_x_rad_s\n1,x\n2,y\n");
  await page.goto(address);
  const [chooser] = await Promise.all([
    page.waitForEvent("filechooser"),
    page.getByRole("button", { name: "Choose files" }).click(),
  ]);
  await chooser.setFiles(bad);
  await page.getByRole("heading", { name: /Data set/ }).waitFor();
  check((await page.locator(".problems .error, .problems .warning").count()) > 0, "problems of the file are shown");
  await accessible("data set");
  await page.getByRole("button", { name: /Process/ }).click();
  await page.getByText(/The run failed/).waitFor({ timeout: 60_000 });
}

/** Dark, Ukrainian, and wide. */
async function dress(id) {
  const text = async () => page.evaluate(() => document.body.innerText);
  await page.emulateMedia({ colorScheme: "dark" });
  await page.goto(`${address}#/run/${id}/overview`);
  await page.locator(".stat").first().waitFor();
  await accessible("dark");
  await page.getByLabel("Language").selectOption("uk");
  await page.getByRole("tab", { name: "Похибки", exact: true }).click();
  await page.locator("figure.plot canvas").first().waitFor();
  check(!/\b(plot|tab|table|view|run|editor|start|aid)\.[a-z_]+/.test(await text()), "no text is missing in Ukrainian");
  await accessible("dark, Ukrainian");
  await shot("ui-errors-dark-uk");
  await page.setViewportSize({ width: 3840, height: 2000 });
  await page.waitForTimeout(1200);
  check(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "nothing hangs out of a wide page");
  await shot("ui-wide");
}

try {
  await start();
  const first = await flight();
  await views(first);
  const second = await cut(first);
  await ranges(...(await compare()));
  await noise();
  await campaign();
  await gravity();
  await upload();
  await dress(second);
} catch (e) {
  check(false, String(e.stack ?? e));
  if (options.shots) await page.screenshot({ path: join(options.shots, "failed.png") }).catch(() => undefined);
} finally {
  await browser.close();
  server.removeAllListeners("exit");
  server.kill("SIGTERM");
  await new Promise((r) => server.once("exit", r));
  rmSync(folder, { recursive: true, force: true });
}
console.log(`page: ${failures} failures`);
process.exit(failures ? 1 : 0);
