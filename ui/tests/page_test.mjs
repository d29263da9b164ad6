// The page of `schuler ui` in a real browser on real runs, as a user goes through it.
//   node page_test.mjs --program SCHULER --modules NODE_MODULES [--browser CHROMIUM] [--shots FOLDER] [--only work [--steps batch,carrier]] [--dist UI_BUNDLE] [--wait SECONDS]
// --only work: the steps of page_work.mjs alone, which need no run of the others; --steps: some of them.
// --dist: the page from this folder instead of that in the program; --wait: for a busy machine, default 60.
// Exit status 0 passed, 1 failed, 77 skipped (no browser, or no packages for it).
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { browse, optionsOf, serve, visitTabs } from "./browse.mjs";
import { work } from "./page_work.mjs";

const options = optionsOf(process.argv.slice(2));
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
const { browser, page, require } = await browse(options);
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const folder = mkdtempSync(join(tmpdir(), "schuler_page_"));
const { entrance, address, token, ask, stop } = await serve(options.program, folder);
page.on("pageerror", (e) => check(false, `error on the page: ${e.message}`));
page.on("console", (m) => m.type() === "error" && !/4\d\d \(/.test(m.text()) && check(false, `console: ${m.text()}`));
page.on("request", (r) => check(r.url().startsWith(address) || /^(data|blob):/.test(r.url()), `asks another server: ${r.url()}`));

const shot = async (name) => {
  if (!options.shots) return;
  mkdirSync(options.shots, { recursive: true });
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.waitForTimeout(700);
  await page.screenshot({ path: join(options.shots, `${name}.png`) });
};
const accessible = async (where, of = page) => {
  await of.mouse.move(0, 0);   // a line that the mouse is near fades the others
  await of.evaluate(axe);
  const found = await of.evaluate(() =>
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
  await page.locator('[role="tablist"]').waitFor({ timeout: 120_000 });
  return decodeURIComponent(/#\/run\/([^/]+)/.exec(page.url())[1]);
};

async function start() {
  await page.goto(entrance);
  await page.getByRole("heading", { name: "Integrated inertial-satellite navigation" }).waitFor();
  await page.locator(".drop").waitFor();
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
  await page.locator(".stat strong").nth(2).waitFor();
  await page.locator(".quality .plot canvas").first().waitFor();
  check((await page.locator(".verdict-word").count()) === 1, "the verdict stands on the first page");
  check((await page.locator(".facts tbody tr").count()) > 5, "settings with where they come from");
  await accessible("overview");
  return id;
}

/** Every tab draws something and says no error; of the flight each is accessible too. */
async function tabs(name, id, careful = false) {
  const { tabs: all, wrong } = await visitTabs(page, address, id, {
    shot: careful ? async (tab) => (await accessible(tab), tab === "track" && (await shot("ui-track"))) : null,
  });
  for (const w of wrong) check(false, `${name}: ${w}`);
  check(all.length >= 2, `${name} has its tabs: ${all}`);
}

/** Plots are zoomed by keys and mouse, and what is exported is what is shown. */
async function views(id) {
  await tabs("flight", id, true);
  await page.getByRole("tab", { name: "Errors", exact: true }).click();
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
  // a box zooms both axes
  const limits = () => page.evaluate(() => { const { min, max } = document.querySelector("figure.plot").plot.shown.scales.y; return [min, max]; });
  const [low, high] = await limits();
  const whole = (await plot.locator(".u-over").boundingBox()) ?? box;
  await page.mouse.move(whole.x + 0.2 * whole.width, whole.y + 0.3 * whole.height);
  await page.mouse.down();
  await page.mouse.move(whole.x + 0.7 * whole.width, whole.y + 0.3 * whole.height + 60, { steps: 6 });
  await page.mouse.up();
  await page.waitForTimeout(300);
  const [lowBox, highBox] = await limits();
  check(highBox - lowBox < 0.7 * (high - low), `a box narrows y too: ${[low, high]} to ${[lowBox, highBox]}`);
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

/** Signals: found by words, a second one of another unit on the right axis, a derived one, a layout that is kept. */
async function signals(id) {
  await page.goto(`${address}#/run/${id}/signals`);
  await page.reload();
  await page.locator(".signal-tree").waitFor();
  await page.getByPlaceholder("Find a signal").fill("solution height");
  await page.locator("button.signal").first().click();
  await page.locator(".signal-chip").nth(1).waitFor();
  const shown = () => page.evaluate(() => document.querySelector("figure.plot").plot.data.y.map((y) => y.filter((v) => v !== null).length));
  check(await soon(async () => (await shown()).length === 2 && (await shown()).every((n) => n > 100)), `two signals are drawn: ${await shown()}`);
  check((await page.evaluate(() => document.querySelector("figure.plot").plot.settings.lines.map((l) => Boolean(l.right)))).join() === "false,true", "another unit has the other axis");
  // a box zooms the axis at the right too
  const right = () => page.evaluate(() => { const { min, max } = document.querySelector("figure.plot").plot.shown.scales.y2; return max - min; });
  const area = await page.locator("figure.plot .u-over").first().boundingBox();
  const before = await right();
  await page.mouse.move(area.x + 0.2 * area.width, area.y + 0.3 * area.height);
  await page.mouse.down();
  await page.mouse.move(area.x + 0.7 * area.width, area.y + 0.3 * area.height + 80, { steps: 6 });
  await page.mouse.up();
  check(await soon(async () => (await right()) < 0.6 * before), `a box zooms the right axis: ${before} to ${await right()}`);
  await page.locator("figure.plot").first().getByRole("button", { name: /Show everything/ }).click();
  check(await soon(async () => Math.abs((await right()) - before) < 1e-6 * before), "and back");
  await page.locator(".signal-chip select").first().selectOption("integral");
  check(await soon(async () => /integral/.test(await page.locator(".signal-card .plot-title").innerText())), "a derived signal");
  page.once("dialog", (d) => void d.accept("mine"));
  await page.getByRole("button", { name: "Keep this layout" }).click();
  check(await soon(async () => Array.isArray((await ask("api/layouts"))?.mine)), "the layout is in the workspace");
  await shot("ui-signals");
}

/** The forms of the studies, and what becomes of one: its numbers. */
async function studies() {
  await page.goto(`${address}#/studies`);
  await page.locator(".examples a").first().waitFor();
  check((await page.locator(".examples a").count()) >= 9, "every study has its form");
  await accessible("studies");
  await page.goto(`${address}#/studies/${encodeURIComponent("analyze equator")}`);
  await page.locator(".studies .form").waitFor();
  await page.getByRole("button", { name: /Compute/ }).click();
  await tabs("study", await done());
}

/** Logs without GNSS: navigation is refused with its reason, attitude is offered and made. A folder keeps its subfolders. */
async function attitude() {
  await ask("api/datasets", "POST", { title: "hand" });
  const rows = ["time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"];
  for (let i = 0; i < 3000; ++i) rows.push([i / 100, 0.1 * Math.sin(i / 90), 0.001, 0.002, 0.3 * Math.sin(i / 90), 0.01, -9.81].join(","));
  for (const path of ["a/imu.csv", "b/notes.csv"]) await fetch(`${address}api/datasets/hand/files/${path}`, { method: "PUT", headers: { Authorization: `Bearer ${token}` }, body: path === "a/imu.csv" ? rows.join("\n") : "x\n1\n" });
  const [{ files }] = (await ask("api/datasets")).filter((d) => d.name === "hand");
  check(files.map((f) => f.name).join() === "a/imu.csv,b/notes.csv", `folders are kept: ${JSON.stringify(files)}`);
  await page.goto(`${address}#/data/hand`);
  await page.locator(".tasks").waitFor();
  check(await page.locator('.task input[value="process"]').isDisabled(), "no navigation without GNSS");
  check(/Not possible/.test(await page.locator(".task.off").first().innerText()), "and the reason is told");
  check((await page.locator(".task input:checked").getAttribute("value")) === "ahrs", "attitude is offered");
  await accessible("data set without GNSS");
  await page.getByRole("button", { name: /Process/ }).click();
  await tabs("attitude", await done());
}

/** At 390 px nothing hangs out of the page. */
async function narrow(ids) {
  await page.setViewportSize({ width: 390, height: 844 });
  const wide = () => page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  for (const [where, path] of [["start", ""], ["scenario", "#/scenario?example=demo"], ["studies", "#/studies"], ["data", "#/data/hand"], ["comparison", `#/compare/${ids.join("/")}`]]) {
    await page.goto(address + path);
    await page.waitForTimeout(900);
    check((await wide()) <= 1, `${where}: ${await wide()} px wider than a phone`);
  }
  const { wrong } = await visitTabs(page, address, ids[0], { only: ["overview", "track", "innovations", "signals", "table"] });
  for (const w of wrong) check(false, `phone: ${w}`);
  await shot("ui-phone");
  await page.setViewportSize({ width: 1280, height: 900 });
}

/** GNSS is cut on the time line: the error grows; both runs side by side. */
async function cut(first) {
  await page.goto(`${address}#/run/${first}/errors`);
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
  await page.locator('#view[data-tab="noise"]').waitFor({ timeout: 60_000 });
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
  await page.locator('#view[data-tab="ensemble"]').waitFor();
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
  await page.locator('#view[data-tab="gravity"]').waitFor();
  await page.locator("figure.plot canvas").nth(2).waitFor();
  const shown = await page.evaluate(() => {
    const { data, settings } = document.querySelector("figure.plot").plot;
    return { labels: settings.lines.map((l) => l.label), last: data.y.map((y) => y.at(-1)), km: data.x.at(-1) };
  });
  const { gravity } = (await ask(`api/runs/${id}`)).summary;
  // the summary speaks of up, the page of down
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
  await page.locator(".tasks").waitFor();
  check((await page.locator(".problems .error, .problems .warning").count()) > 0, "problems of the file are shown");
  await accessible("data set");
  const process = page.getByRole("button", { name: /Process/ });
  check((await process.isDisabled()) && /Not possible/.test(await page.locator(".note:not([hidden])").innerText()), "nothing is started where nothing can be done, and the reason is told");
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
  await work({ page, address, ask, check, soon, accessible, shot, tabs, folder, options, done });
  if (options.only !== "work") {
    await page.goto(address);
    const first = await flight();
    await views(first);
    await signals(first);
    const second = await cut(first);
    await studies();
    await attitude();
    await narrow([second, first]);
    await ranges(...(await compare()));
    await noise();
    await campaign();
    await gravity();
    await upload();
    await dress(second);
  }
} catch (e) {
  check(false, String(e.stack ?? e));
  if (options.shots) await page.screenshot({ path: join(options.shots, "failed.png") }).catch(() => undefined);
} finally {
  await browser.close();
  await stop();
  rmSync(folder, { recursive: true, force: true });
}
console.log(`page: ${failures} failures`);
process.exit(failures ? 1 : 0);
