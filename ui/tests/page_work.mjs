// Steps of page_test.mjs that need no run of the others: several data sets together, notes, removal, comparisons of couplings and of
// attitude, carrier phase, a server that ends and is started anew.
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { createServer } from "node:net";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";
import { serve } from "./browse.mjs";
import * as quality from "./page_quality.mjs";

export const drive = (seed) => `name = "drive"
duration_s = 240
seed = ${seed}
[trajectory]
type = "car"
start = { lat_deg = 50.0, lon_deg = 8.0, height_m = 100.0 }
speed_m_s = 12
[imu]
rate_hz = 100
grade = "tactical"
[gnss]
rate_hz = 2
receiver = "rtk"
`;

export const ended = async ({ ask, page }, ids) => {
  const runs = [];
  for (const id of ids)
    for (;;) {
      const run = await ask(`api/runs/${id}`);
      if (run.state !== "waiting" && run.state !== "running") {
        runs.push(run);
        break;
      }
      await page.waitForTimeout(200);
    }
  return runs;
};

/** The widest words of the frame, on a phone. */
async function frame(t) {
  const { page, address, check } = t;
  await page.setViewportSize({ width: 390, height: 844 });
  for (const language of ["uk", "ru", "en"]) {
    for (const path of ["", "#/batch", "#/live"]) {
      await page.goto(address + path);
      await page.getByRole("combobox").first().waitFor();
      await page.locator("header select").selectOption(language);
      await page.waitForTimeout(400);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      check(wide <= 1, `${language} ${path}: ${wide} px wider than a phone`);
    }
  }
  await page.setViewportSize({ width: 1280, height: 900 });
}

/** Two drives and a folder that is none: one profile, one table with the failed one first, all of it removed together. */
async function batch(t) {
  const { page, address, ask, check, soon, accessible, shot, folder, options } = t;
  const data = join(folder, "work", "data");
  for (const [name, seed] of [["drive-a", 1], ["drive-b", 2]]) {
    writeFileSync(join(folder, `${name}.toml`), drive(seed));
    execFileSync(options.program, ["simulate", join(folder, `${name}.toml`), "-o", join(data, name)], { stdio: "ignore" });
  }
  mkdirSync(join(data, "empty"), { recursive: true });
  writeFileSync(join(data, "empty", "notes.txt"), "nothing\n");
  // the logs as they are: signals of several files on one axis of time
  await page.goto(`${address}#/data/drive-a`);
  await page.locator(".raw-signals > summary").click();
  const signal = (name) => page.locator(".raw-signals button.signal", { hasText: name }).first();
  await page.locator(".raw-signals").getByPlaceholder("Find a signal").fill("imu.csv z");
  await signal(" z").click();
  await page.locator(".raw-signals").getByPlaceholder("Find a signal").fill("gnss height");
  await signal("height").click();
  const raw = () => page.evaluate(() => document.querySelector(".raw-signals figure.plot")?.plot.data.y.map((y) => y.filter((v) => v !== null).length) ?? []);
  check(await soon(async () => (await raw()).length >= 2 && (await raw()).every((n) => n > 100)), `raw logs are drawn together: ${await raw()}`);
  await page.goto(address);
  await page.getByRole("link", { name: "Process several together" }).click();
  const start = page.locator("button.primary.run");
  await start.waitFor();
  check((await page.locator(".batch-sets input:checked").count()) === 3, "all data sets are chosen");
  await page.getByRole("button", { name: "None", exact: true }).click();
  check(await start.isDisabled(), "nothing is started of no data set");
  await page.getByRole("button", { name: "All", exact: true }).click();
  check((await page.locator('.form [data-key="imu.file"]').count()) === 0, "a profile names no files");
  await page.getByPlaceholder("Find an option").last().fill("filter.scheme");
  await page.locator("#option-filter-scheme").selectOption("separate");
  await page.getByLabel("Name of the batch").fill("Two drives");
  await accessible("batch");
  await page.reload();
  await start.waitFor();
  check((await page.locator("#option-filter-scheme").inputValue()) === "separate", "a reload keeps the profile");
  await start.click();
  await page.waitForURL(/#\/batch\/Two%20drives$/);
  const mine = async () => (await ask("api/runs")).filter((r) => r.batch === "Two drives");
  const runs = await ended(t, (await mine()).map((r) => r.id));
  check(runs.length === 3, `a run of each: ${runs.map((r) => r.title)}`);
  const rows = page.locator(".batch-table tbody tr");
  check(await soon(async () => (await page.locator(".batch-table .badge.done").count()) === 2), "two are done");
  check(/^empty/.test(await rows.first().innerText()), `the failed one stands first: ${await rows.allInnerTexts()}`);
  const failed = runs.find((r) => r.dataset === "empty");
  check(failed.state === "failed" && (await rows.first().innerText()).includes(failed.message.slice(0, 30)), `with its reason: ${failed.message}`);
  for (const run of runs.filter((r) => r.state === "done")) {
    check(run.summary.scheme === "separate", `the profile holds for ${run.title}: ${run.summary.scheme}`);
    const { rms } = run.summary.errors.position_m.horizontal;
    const row = await rows.filter({ hasText: run.dataset }).innerText();
    check(row.includes(String(Number(rms.toPrecision(3)))), `the table has ${rms} of ${run.title}: ${row}`);
  }
  await accessible("table of a batch");
  await shot("ui-batch");
  await reasons(t, runs.find((r) => r.state === "done").id);
  // what the server says of a data set that cannot be processed, and the counts, in the language of the page
  for (const [language, state, why] of [["uk", /3 набори: .*невдалих 1/, /розпізнано/], ["ru", /3 набора: .*неудачных 1/, /распознано/]]) {
    await page.locator("header select").selectOption(language);
    await page.locator(".lead", { hasText: state }).waitFor();
    const told = await page.locator(`tr[data-run="${failed.id}"] td.why`).first().innerText();
    check(why.test(told) && !/recognised|name the|give /.test(told), `${language}: why it failed: ${told}`);
  }
  await page.locator("header select").selectOption("en");
  await page.locator(".lead", { hasText: "3 data sets" }).waitFor();
  // a note is kept with the run
  await rows.last().getByRole("link").click();
  await page.locator('[role="tablist"]').waitFor();
  page.once("dialog", (d) => void d.accept("wet road"));
  await page.getByRole("button", { name: /^Note/ }).click();
  check(await soon(async () => (await page.locator("p.run-note").innerText()) === "wet road"), "a note stands with the run");
  await page.goto(`${address}#/batch/${encodeURIComponent("Two drives")}`);
  await page.locator(".batch-table", { hasText: "wet road" }).waitFor();
  await page.goto(address);
  await page.locator("table.runs .run-note", { hasText: "wet road" }).waitFor();
  const tools = await page.locator("table.runs tbody tr").first().locator("td.tools").boundingBox();
  const card = await page.locator(".start .card").nth(1).boundingBox();
  check(tools.x + tools.width <= card.x + card.width, `the tools of a run are in sight: ${JSON.stringify(tools)}`);
  // one removed by its mark in the list, the others with the batch
  await page.locator(`tr[data-run="${failed.id}"] input[type="checkbox"]`).check();
  check(await page.getByRole("button", { name: "Compare", exact: true }).isDisabled(), "a failed run is not compared");
  page.once("dialog", (d) => void d.accept());
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  check(await soon(async () => (await mine()).length === 2), "a marked run is removed");
  await page.goto(`${address}#/batch/${encodeURIComponent("Two drives")}`);
  page.once("dialog", (d) => void d.accept());
  await page.getByRole("button", { name: "Remove the batch" }).click();
  check(await soon(async () => (await mine()).length === 0), "the batch is removed");
}

/** Reasons of a verdict are told in the language of the page, with their numbers, also within each other. */
async function reasons({ page, address, ask, check, options }, id) {
  const told = [
    "only 93.2 % of 60 withheld fixes, judged with wider noise, are inside three sigma (horizontal 95.0 %, vertical 98.3 %; 3.21 m at sigma 1.5 m after 10 s)",
    "12 of 480 fixes were refused",
    "the receiver's positions jumped 2 times, by 35.2 m at most, without the IMU feeling it",
    "a sentence that nobody knows",
  ];
  await page.route("**/api/runs", async (route) => {
    const reply = await route.fetch();
    await route.fulfill({ response: reply, json: (await reply.json()).map((r) => (r.id === id ? { ...r, verdict: "do not use" } : r)) });
  });
  await page.route(`**/api/runs/${id}`, async (route) => {
    const reply = await route.fetch();
    const run = await reply.json();
    run.verdict = "do not use";
    run.summary.verdict = { word: "do not use", reasons: told };
    run.summary.warnings = [`${told[1]} (3 times)`];
    await route.fulfill({ response: reply, json: run });
  });
  const expected = {
    uk: [/^лише 93\.2 % з 60 .*із ширшим шумом, лежать .*95\.0 %.*98\.3 %; 3\.21 м .* 1\.5 м .*10 с/, /^відхилено 12 із 480 /, /стрибнуло 2 рази, .*35\.2 м/, /^відхилено 12 із 480 .*\(3 рази\)$/],
    ru: [/^лишь 93\.2 % из 60 .*с более широким шумом, лежат .*95\.0 %.*98\.3 %; 3\.21 м .* 1\.5 м .*10 с/, /^отклонено 12 из 480 /, /изменилось 2 раза, .*35\.2 м/, /^отклонено 12 из 480 .*\(3 раза\)$/],
    en: [/^only 93\.2 % of 60/, /^12 of 480 fixes were refused$/, /jumped 2 times/, /12 of 480 fixes were refused \(3 times\)$/],
  };
  for (const [language, [first, second, third, warning]] of Object.entries(expected)) {
    await page.evaluate((l) => localStorage.setItem("schuler.language", l), language);
    await page.goto(`${address}#/batch/${encodeURIComponent("Two drives")}`);
    await page.reload();
    const why = page.locator(`tr[data-run="${id}"] td.why`).first();
    await why.waitFor();
    check(first.test(await why.innerText()), `${language}: why in the table: ${await why.innerText()}`);
    if (options.shots && language === "uk") await page.screenshot({ path: join(options.shots, "ui-batch-uk.png") });
    await page.goto(`${address}#/run/${id}/overview`);
    const list = page.locator(".verdict li");
    await list.nth(3).waitFor();
    const all = await list.allInnerTexts();
    check(first.test(all[0]) && second.test(all[1]) && third.test(all[2]) && all[3] === told[3], `${language}: verdict: ${all}`);
    const warnings = await page.locator(".problems .warning").allInnerTexts();
    check(warnings.some((w) => warning.test(w.replace("⚠ ", ""))), `${language}: warnings: ${warnings}`);
  }
  await page.unrouteAll({ behavior: "wait" });
  await page.goto(`${address}#/batch/${encodeURIComponent("Two drives")}`);
  await page.locator(".batch-table tbody tr").first().waitFor();
}

/** Comparisons of couplings side by side: a table a quantity; of attitude: no empty plot, angles do not cross the plot. */
async function comparisons(t) {
  const { page, address, ask, check, soon, tabs } = t;
  const toml = (await ask("api/examples")).find((e) => e.name === "schemes").toml.replace(/duration_s = .*/, "duration_s = 200").replace(/\[\[outage\]\][^[]*/g, "");
  const order = (title) => ask("api/runs", "POST", { kind: "scenario", title, toml });
  const ids = (await Promise.all([order("Couplings A"), order("Couplings B")])).map((r) => r.id);
  const [run] = await ended(t, ids);
  check(run.state === "done", `the couplings: ${run.message}`);
  await tabs("couplings", ids[0]);
  await page.goto(`${address}#/compare/${ids.join("/")}`);
  const table = page.locator(".coupling-tables .table-block").first();
  await table.waitFor();
  const loose = run.summary.schemes.find((s) => s.scheme === "loose");
  const row = await table.locator("tbody tr", { has: page.getByRole("rowheader", { name: "loose", exact: true }) }).innerText();
  const [alone] = await ended(t, [(await ask("api/runs", "POST", { kind: "scenario", title: "Alone", toml: drive(7) })).id]);
  const refused = [];
  const listen = (r) => r.status() >= 400 && refused.push(r.url());
  page.on("response", listen);
  await page.goto(`${address}#/compare/${alone.id}/${ids[0]}`);
  await page.locator("figure.plot .u-over").first().waitFor();
  await page.waitForTimeout(500);
  page.off("response", listen);
  check(refused.length === 0, `nothing is asked of a run that does not have it: ${refused}`);
  await page.goto(`${address}#/compare/${ids.join("/")}`);
  await table.waitFor();
  check(/^horizontal/.test(await table.innerText()) && row.includes(String(Number(loose.horizontal_m.toPrecision(4)))), `couplings are compared by quantity: ${row}`);

  const data = join(t.folder, "work", "data", "turning");
  mkdirSync(data, { recursive: true });
  const rows = ["time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"];
  for (let i = 0; i < 6000; ++i) rows.push([i / 100, 0.001, 0.001, i < 500 ? 0 : 0.5, 0.02, 0.01, -9.81].join(","));
  writeFileSync(join(data, "imu.csv"), rows.join("\n"));
  const turn = (title) => ask("api/runs", "POST", { kind: "dataset", dataset: "turning", command: "ahrs", title, settings: {} });
  const turns = (await Promise.all([turn("Turn A"), turn("Turn B")])).map((r) => r.id);
  for (const r of await ended(t, turns)) check(r.state === "done", `attitude: ${r.message}`);
  await page.goto(`${address}#/compare/${turns.join("/")}`);
  const plots = page.locator("figure.plot");
  await plots.first().waitFor();
  const titles = await page.locator(".plot-title").allInnerTexts();
  check(titles.slice(0, 3).join() === "roll,pitch,heading", `attitudes are overlaid under their names: ${titles}`);
  for (let i = 0; i < (await plots.count()); ++i) await plots.nth(i).scrollIntoViewIfNeeded(), await page.waitForTimeout(150);
  const drawn = () =>
    page.evaluate(() =>
      [...document.querySelectorAll("figure.plot")].map((f) => {
        const ys = f.plot.data.y;
        const jump = Math.max(0, ...ys.flatMap((y) => y.map((v, i) => (i > 0 && v !== null && y[i - 1] !== null ? Math.abs(v - y[i - 1]) : 0))));
        return { title: f.querySelector(".plot-title").textContent, points: ys.flat().filter((v) => v !== null).length, jump };
      }),
    );
  check(await soon(async () => (await drawn()).every((p) => p.points > 50)), `no plot is empty: ${JSON.stringify(await drawn())}`);
  const heading = (await drawn()).find((p) => p.title === "heading");
  check(heading && heading.jump <= 180, `the heading does not jump across its plot: ${JSON.stringify(heading)}`);
}

/** Positions by carrier phase: how many epochs are fixed, the ratio, and a track of centimetres that fills its plane. */
async function carrier(t) {
  const { page, address, ask, check } = t;
  const root = process.env.SCHULER_DATA ?? join(dirname(fileURLToPath(import.meta.url)), "../../../shared/data");
  const pair = join(root, "rtklib_geonet_pair");
  if (!existsSync(pair)) return console.log(`carrier phase not looked at: ${pair} is not there (SCHULER_DATA)`);
  cpSync(pair, join(t.folder, "work", "data", "pair"), { recursive: true });
  await page.goto(`${address}#/data/pair`);
  await page.locator('.task input[value="ppk"]').check();
  await page.getByLabel("Name", { exact: true }).fill("Pair");
  await page.getByRole("button", { name: /Process/ }).click();
  const id = await t.done();
  await page.locator(".stat").first().waitFor();
  const { summary } = await ask(`api/runs/${id}`);
  const stats = await page.locator(".stats").innerText();
  check(summary.carrier.fixed > 100 && stats.includes(`${summary.carrier.fixed} fixed`), `fixed epochs are told: ${stats}`);
  check(!/Inertial unit/.test(stats), "there is no inertial unit to speak of");
  const { time_s } = await ask(`api/runs/${id}/series?columns=/carrier/table:ratio&points=0`);
  check(time_s.length === summary.carrier.epochs && Math.abs(time_s[0]) < 1 && Math.abs(time_s.at(-1) - summary.duration_s) < 1, `on the axis of the run: ${time_s[0]} to ${time_s.at(-1)}`);
  await t.tabs("carrier phase", id);
}

/** A PNG of one pixel. */
function pixel(...rgb) {
  const crc = (bytes) => {
    let c = ~0;
    for (const b of bytes) for (let k = 0, x = (c ^= b); k < 8; ++k) c = x = x & 1 ? (x >>> 1) ^ 0xedb88320 : x >>> 1;
    return ~c >>> 0;
  };
  const chunk = (name, data) => {
    const body = Buffer.concat([Buffer.from(name), data]),
      out = Buffer.alloc(body.length + 8);
    out.writeUInt32BE(data.length, 0), body.copy(out, 4), out.writeUInt32BE(crc(body), body.length + 4);
    return out;
  };
  const head = Buffer.from([0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
  return Buffer.concat([Buffer.from("89504e470d0a1a0a", "hex"), chunk("IHDR", head), chunk("IDAT", deflateSync(Buffer.from([0, ...rgb]))), chunk("IEND", Buffer.alloc(0))]);
}

/** Lines of latitude and longitude lie under a track, at round steps and where a table of the ellipsoid has them. */
async function graticule(t) {
  const { page, address, ask, check, soon, options } = t;
  const { id } = await ask("api/runs", "POST", { kind: "scenario", title: "Lines", toml: drive(6) });
  await ended(t, [id]);
  await page.goto(`${address}#/run/${id}/overview`);
  await page.locator(`.run[data-run="${id}"] .plan-canvas`).waitFor();
  const drawn = (scale) =>
    page.evaluate((scale) => {
      const { plan } = document.querySelector(".run figure.plan");
      plan.centre = { east: 0, north: 0 };
      plan.scale = scale;
      plan.fitted = true;
      plan.draw();
      return plan.lines;
    }, scale);
  check(await soon(async () => /″/.test((await drawn(1)).parallels[0]?.label ?? "")), "lines of degrees");
  const { parallels, meridians } = await drawn(1);
  const line = (all, label) => all.find((l) => l.label === label)?.at ?? NaN;
  const near = (x, y, by) => Math.abs(x - y) < by;
  // the drive begins at 50 deg north, 8 deg east; there a degree has 111 229 m northward and 71 696 m eastward
  check(near(line(parallels, "50°00′00″N"), 0, 3) && near(line(meridians, "8°00′00″E"), 0, 3), `the start lies on them: ${JSON.stringify([parallels, meridians])}`);
  check(near(line(parallels, "50°00′05″N") - line(parallels, "49°59′55″N"), (2 * 5 * 111229) / 3600, 0.1), `parallels: ${JSON.stringify(parallels)}`);
  check(near(line(meridians, "8°00′10″E") - line(meridians, "7°59′50″E"), (2 * 10 * 71696) / 3600, 0.1), `meridians: ${JSON.stringify(meridians)}`);
  const shapes = [[0.01, /^\d+°\d\d′[NE]$/], [0.001, /^\d+°(\d\d′)?[NE]$/], [100, /^\d+°\d\d′\d\d\.\d{1,2}″[NE]$/], [1e-5, /^-?\d+$/]];
  for (const [scale, shape] of shapes) {
    for (const all of Object.values(await drawn(scale)).map((lines) => lines.map((l) => l.label)))
      check(all.length > 1 && all.length < 30 && all.every((x) => shape.test(x)) && new Set(all).size === all.length, `lines at ${scale} pixels a metre: ${all}`);
  }
  const beyond = await page.evaluate(() => {
    const { plan } = document.querySelector(".run figure.plan");
    const of = (plane, scale) => ((plan.plane = plane), (plan.scale = scale), plan.draw(), Object.values(plan.lines).map((all) => all.map((l) => l.label)));
    return [of({ lat: -0.001, lon: 179.999 }, 0.5), of({ lat: 89.99, lon: 0 }, 1)];
  });
  check(beyond[0][0].includes("180°00′00″W") || beyond[0][0].includes("180°00′00″E"), `the date line: ${beyond[0][0]}`);
  check(beyond[0][0].some((x) => /^179°59′\d\d″W$/.test(x)) && beyond[0][0].some((x) => /^179°59′\d\d″E$/.test(x)), `and beyond: ${beyond[0][0]}`);
  check(beyond[0][1].includes("0°00′00″") && beyond[0][1].some((x) => /S$/.test(x)) && beyond[0][1].some((x) => /N$/.test(x)), `the equator: ${beyond[0][1]}`);
  check(beyond[1].flat().length === 0, `none at the pole: ${beyond[1]}`);
  await page.reload();
  await page.locator(`.run[data-run="${id}"] .plan-canvas`).waitFor();
  await page.waitForTimeout(600);
  if (options.shots) await page.locator("figure.plan").screenshot({ path: join(options.shots, "ui-graticule.png") });
}

/** Tiles of a folder lie under the track where they belong: the edge of two of them is 140 m west of the start at 8 degrees east. */
async function tiles(t) {
  const { page, check, options } = t;
  const folder = mkdtempSync(join(tmpdir(), "schuler_tiles_"));
  for (let x = 8553; x < 8560; ++x)
    for (let y = 5545; y < 5560; ++y) {
      mkdirSync(join(folder, "tiles", "14", String(x)), { recursive: true });
      writeFileSync(join(folder, "tiles", "14", String(x), `${y}.png`), x < 8556 ? pixel(0, 0, 255) : pixel(255, 0, 0));
    }
  const server = await serve(options.program, folder, ["--tiles", join(folder, "tiles")]);
  const tab = await page.context().newPage();
  const complaints = [];
  tab.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  try {
    await tab.goto(server.entrance);
    const { id } = await server.ask("api/runs", "POST", { kind: "scenario", title: "Over a map", toml: drive(5) });
    await ended({ ask: server.ask, page }, [id]);
    await tab.goto(`${server.address}#/run/${id}/overview`);
    await tab.locator(".plan-canvas").waitFor();
    const seen = () =>
      tab.evaluate(() => {
        const { plan } = document.querySelector("figure.plan"),
          { canvas } = plan;
        const at = (east, north) => [...canvas.getContext("2d").getImageData(...plan.place(east, north).map((v) => Math.round(v * devicePixelRatio)), 1, 1).data];
        const edge = -((8 - ((8556 / 16384) * 360 - 180)) * Math.PI / 180) * 6378137 / Math.sqrt(1 - 0.00669437999014 * Math.sin(50 * Math.PI / 180) ** 2) * Math.cos(50 * Math.PI / 180);
        plan.centre = { east: edge, north: 40 };   // the edge of the tiles in the middle
        plan.scale = 1;
        plan.fitted = true;
        plan.paint();
        return { drawn: plan.tiles?.drawn ?? 0, edge, west: at(edge - 6, 60), east: at(edge + 6, 60) };
      });
    const right = ({ drawn, west, east }) => drawn >= 2 && west[2] > west[0] + 80 && east[0] > east[2] + 80;
    for (let i = 0; i < 50 && !right(await seen()); ++i) await tab.waitForTimeout(100);
    const last = await seen(),
      { drawn, edge, west, east } = last;
    check(right(last), `the map lies under the track: ${drawn} tiles, the edge ${edge} m, west of it ${west}, east ${east}`);
    check(complaints.length === 0, `a tile that is not there is no fault: ${complaints}`);
    const outside = await fetch(`${server.address}api/tiles/14/../x`, { headers: { Authorization: `Bearer ${server.token}` } });
    check(outside.status >= 400, `names that are no numbers: ${outside.status}`);
    if (options.shots) await tab.screenshot({ path: join(options.shots, "ui-tiles.png") });
  } finally {
    await tab.close();
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
}

/** The server ends: the page says so. It is started anew, with another token: that too; and all is well with the new address. */
async function restart(t) {
  const { page, check, options } = t;
  const folder = mkdtempSync(join(tmpdir(), "schuler_anew_"));
  const before = await serve(options.program, folder);
  const tab = await page.context().newPage();
  let after = null;
  try {
    await tab.goto(before.entrance);
    await tab.locator("h1").waitFor();
    const banner = tab.locator(".banner");
    check(await banner.isHidden(), "no banner while the server answers");
    await before.stop();
    await banner.waitFor({ timeout: 20_000 });
    check(/does not answer/.test(await banner.innerText()), "a server that ended is noticed");
    after = await serve(options.program, folder, [], new URL(before.address).port);
    await tab.locator(".banner", { hasText: "started anew" }).waitFor({ timeout: 20_000 });
    const other = await page.context().newPage();
    await other.goto(after.entrance);
    await other.close();
    await banner.waitFor({ state: "hidden", timeout: 20_000 });
    await after.ask("api/runs", "POST", { kind: "scenario", title: "Afterwards", toml: drive(3) });
    await tab.getByRole("link", { name: "Afterwards" }).waitFor({ timeout: 20_000 });
  } catch (e) {
    check(false, `a server started anew: ${e.message.split("\n")[0]}; the banner: ${await tab.locator(".banner").innerText().catch(() => "-")}`);
  } finally {
    await tab.close();
    await after?.stop();
    rmSync(folder, { recursive: true, force: true });
  }
}

/** An item of a paper is chosen from the list of its items and computed: the printed numbers beside those of the program. */
async function papers(t) {
  const { page, address, check, accessible } = t;
  await page.goto(`${address}#/studies/paper`);
  await page.locator(".paper-items tbody tr").first().waitFor();
  await page.getByLabel("Paper", { exact: true }).selectOption("B");
  await page.locator(".paper-items").waitFor();
  await page.getByLabel("Paper", { exact: true }).selectOption("A");
  await page.getByRole("button", { name: "figure-4.1.1", exact: true }).click();
  check((await page.locator("#option-item").inputValue()) === "figure-4.1.1", "a click puts an item into the form");
  await accessible("papers");
  await page.getByRole("button", { name: /Compute/ }).click();
  const id = await t.done();
  await t.tabs("paper", id);
  await page.goto(`${address}#/run/${id}/document`);
  await page.getByText("Schuler period").first().waitFor();
}

/** A recording of signals is made, and its satellites are tracked by another run; the receiver of a scenario has its fields. */
async function receiver(t) {
  const { page, address, ask, check, soon, done, accessible, tabs, options } = t;
  await page.goto(`${address}#/studies/${encodeURIComponent("receiver track")}`);
  const compute = page.getByRole("button", { name: /Compute/ });
  await page.locator(".studies .form").waitFor();
  check((await compute.isDisabled()) && /no recording/.test(await page.locator(".studies .note").innerText()), "nothing is tracked where nothing is recorded, and the reason is told");
  await page.goto(`${address}#/studies/${encodeURIComponent("receiver generate")}`);
  await page.getByLabel("sample rate", { exact: true }).waitFor();
  check((await page.getByLabel("file", { exact: true }).count()) === 0, "the file is the run's own");
  await page.getByLabel("length, s", { exact: true }).fill("1e5");
  check(await compute.isDisabled(), "an hour at most");
  await page.getByLabel("length, s", { exact: true }).fill("3600");
  await compute.click();
  await page.getByText(/more than 2048 MB/).waitFor();
  await page.getByLabel("length, s", { exact: true }).fill("4");
  await page.getByLabel("sample rate", { exact: true }).fill("2.5e6");
  await page.getByLabel("satellites", { exact: true }).fill("G07:45:1200:300.5, G12:48:-3300");
  await page.getByLabel("Name", { exact: true }).fill("Sky");
  await compute.click();
  const made = await done();
  const { files, summary } = await ask(`api/runs/${made}`);
  await page.setViewportSize({ width: 390, height: 844 });
  await page.goto(`${address}#/studies/${encodeURIComponent("receiver generate")}`);
  await page.locator(".studies .form").waitFor();
  check(await soon(async () => (await compute.boundingBox()).y < 844), "on a phone the form of a study is in sight");
  await page.setViewportSize({ width: 1280, height: 900 });
  await page.goto(`${address}#/run/${made}`);
  check(files.includes("recording.ibyte") && summary.sample_rate_hz === 2.5e6, `recorded: ${files} ${JSON.stringify(summary)}`);
  await page.getByRole("link", { name: "Track this recording" }).click();
  await page.locator(".studies .form").waitFor();
  check(await soon(async () => (await page.getByLabel("sample rate", { exact: true }).inputValue()) === "2500000"), "the recording says how it was sampled");
  check((await page.getByLabel("Recording", { exact: true }).locator("option:checked").innerText()) === "Sky", "and is chosen");
  await page.getByLabel("sample rate", { exact: true }).fill("");
  check((await compute.isDisabled()) && /sample rate is missing/.test(await page.locator(".studies .note").innerText()), "without a rate nothing is tracked");
  await page.getByLabel("sample rate", { exact: true }).fill("2.5e6");
  await accessible("receiver");
  if (options.shots) await page.screenshot({ path: join(options.shots, "ui-receiver.png") });
  await compute.click();
  const tracked = await done();
  const found = (await ask(`api/runs/${tracked}`)).summary.satellites.filter((s) => s.found).map((s) => s.satellite);
  check(found.join() === "G07,G12", `satellites of the recording: ${found}`);
  await tabs("tracking", tracked);
  await page.goto(`${address}#/scenario?example=jamming`);
  await page.getByText(/km, up to/).waitFor();
  await page.locator("summary", { hasText: "Receiver at signal level" }).click();
  check((await page.locator("#option-receiver-rate_hz").inputValue()) !== "" && (await page.locator("#option-receiver-jammer").isVisible()), "the receiver of a scenario has its fields");
}

const freePort = () =>
  new Promise((found) => {
    const s = createServer().listen(0, "127.0.0.1", () => {
      const { port } = s.address();
      s.close(() => found(port));
    });
  });

/** What a receiver says about its satellites, at the port of `schuler live`. */
async function sky({ check, soon, accessible, options }, tab, port) {
  const readers = new Set();
  const receiver = createServer((s) => (readers.add(s), s.on("error", () => undefined)));
  await new Promise((done) => receiver.listen(port, "127.0.0.1", done));
  const tell = (satellites) => readers.forEach((s) => s.write(JSON.stringify({ type: "satellites", time_s: 1, satellites }) + "\n"));
  const seen = (name, elevation_deg, azimuth_deg, cn0_db_hz, used) => ({ name, elevation_deg, azimuth_deg, cn0_db_hz, used });
  const card = tab.locator(".live-sky");
  try {
    check(!(await card.isVisible()), "no satellites without messages of them");
    await tab.locator(".live-link", { hasText: "Messages of" }).waitFor();
    tell([seen("G05", 30, 120, 44, true), seen("R06", 80, 300, 39, true), seen("E11", 5, 359, null, false), seen("S23", null, null, 20, false), 7, {}]);
    await card.getByText("2 used of 4 in view").waitFor();
    check((await card.locator(".sky-name").allTextContents()).join() === "G05,R06,E11", "those whose place is known stand in the sky");
    check((await card.locator(".sky-now.status-0").count()) === 2, "two of them are used");
    const rows = await card.locator("tbody tr").allInnerTexts();
    check(rows.length === 4 && /^G05\s+44\s+30\s+120\s+yes$/.test(rows[0]) && /^S23\s+20\s+–\s+–\s+no$/.test(rows[3]), `the list: ${rows}`);
    check((await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 1, "satellites: wider than a phone");
    await accessible("satellites, live", tab);
    for (const [name, width, height] of [["ui-live-sky-390", 390, 844], ["ui-live-sky", 1440, 900]]) {
      await tab.setViewportSize({ width, height });
      await tab.waitForTimeout(300);
      if (options.shots) await card.screenshot({ path: join(options.shots, `${name}.png`) });
    }
    tell([seen("G07", 10, 10, 30, false)]);
    check(await soon(async () => (await card.locator(".sky-name").allTextContents()).join() === "G07"), "the next message replaces them");
    const said = () => card.locator("p").first().innerText();
    await tab.evaluate(() => {
      const now = Date.now;
      Date.now = () => now() + 12_000;
    });
    check(await soon(async () => /No message about satellites/.test(await said())), `a receiver that falls silent is told: ${await said()}`);
  } finally {
    readers.forEach((s) => s.destroy());
    receiver.close();
  }
}

/** A drive replayed to `schuler live`, whose messages the page shows: nothing yet, navigation, the end. */
async function live(t) {
  const { page, check, options, accessible } = t;
  const folder = mkdtempSync(join(tmpdir(), "schuler_live_"));
  const [samples, messages] = [await freePort(), await freePort()];
  writeFileSync(join(folder, "drive.toml"), drive(4));
  execFileSync(options.program, ["simulate", join(folder, "drive.toml"), "-o", join(folder, "drive")], { stdio: "ignore" });
  let text = readFileSync(join(folder, "drive", "dataset.toml"), "utf8").replace("smooth = true", "smooth = false");
  text = text.split(/^(?=\[)/m).filter((part) => !/^\[(output|reference)\]/.test(part)).join("");
  for (const section of ["imu", "gnss"])
    text = text.replace(new RegExp(`(\\[${section}\\]\n)file = .*\n`), `$1source = "tcp-listen://127.0.0.1:${samples}"\nformat = "json"\n`);
  writeFileSync(join(folder, "live.toml"), `${text}\n[live]\nlag_s = 0.5\nhealth_every_s = 0.2\n[[output]]\nto = "tcp-listen://127.0.0.1:${messages}"\nrate_hz = 10\n`);
  const begun = [];
  const begin = (...words) => {
    const child = spawn(options.program, words, { cwd: folder, stdio: ["ignore", "ignore", "pipe"] });
    child.told = "";
    child.stderr.on("data", (d) => (child.told += d));
    begun.push(child);
    return child;
  };
  const server = await serve(options.program, folder, ["--live", `tcp://127.0.0.1:${messages}`]);
  const tab = await page.context().newPage();
  const complaints = [];
  tab.on("pageerror", (e) => complaints.push(e.message));
  try {
    await tab.goto(server.entrance);
    await tab.getByRole("link", { name: "Live", exact: true }).click();
    await tab.locator(".live-link", { hasText: "No connection" }).waitFor();
    const navigator = begin("live", "live.toml");
    await tab.locator(".live-link", { hasText: "Messages of" }).waitFor();
    begin("replay", join("drive", "dataset.toml"), "--to", `tcp://127.0.0.1:${samples}`, "--speed", "8");
    await tab.locator(".stat", { hasText: "navigating" }).waitFor().catch(() => check(false, `it does not navigate: ${navigator.told.slice(-300)}`));
    const drawn = () =>
      tab.evaluate(() => [...document.querySelectorAll(".live figure.plot")].filter((f) => f.plot).map((f) => f.plot.data.y.flat().filter((v) => v !== null).length));
    for (let i = 0; i < 80 && (await drawn())[0] < 300; ++i) await tab.waitForTimeout(100);
    check((await drawn())[0] >= 300, `the plots grow: ${await drawn()}`);
    check(/(49\.99|50\.00)\d+°, 8\.0\d+°/.test(await tab.locator(".stats").innerText()), `where it is: ${await tab.locator(".stats").innerText()}`);
    const taken = async () => Number(await tab.locator("tr", { has: tab.getByRole("rowheader", { name: "gnss", exact: true }) }).locator("td").first().innerText());
    check((await taken()) > 10, `health of the receiver: ${await taken()}`);
    check(/phase: navigating/.test(await tab.locator(".live-events").innerText()), "events are listed");
    const before = (await drawn())[0];
    check(await t.soon(async () => (await drawn())[0] > before), `and go on growing: ${before}, ${await drawn()}`);
    let faded = 0;
    for (let i = 0; i < 25; ++i) {
      faded += await tab.evaluate(() => [...document.querySelectorAll(".live .u-series")].filter((e) => !["", "1"].includes(e.style.opacity)).length);
      await tab.waitForTimeout(60);
    }
    check(faded === 0, `no line fades unless the mouse is near it: ${faded}`);
    if (options.shots) await tab.screenshot({ path: join(options.shots, "ui-live.png") });
    await tab.setViewportSize({ width: 390, height: 844 });
    await tab.waitForTimeout(500);
    check((await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 1, "live: wider than a phone");
    if (options.shots) await tab.screenshot({ path: join(options.shots, "ui-live-390.png"), fullPage: true });
    await accessible("live", tab);
    navigator.kill("SIGTERM");
    await once(navigator, "exit");
    await tab.locator(".live-link", { hasText: "No connection" }).waitFor();
    await sky(t, tab, messages);
    check(complaints.length === 0, `live: ${complaints}`);
  } finally {
    await tab.close();
    for (const child of begun) child.kill("SIGKILL");
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
}

/** Options in another language: names, sentences, ranges, what is wrong; and the ten that matter first. */
async function languages({ page, address, check, soon }) {
  for (const [language, name, sentence, range, wrong] of [
    ["uk", "Інерціальний блок: клас", /клас або модель/, /число від 0 до /, /Очікується: число/],
    ["ru", "Инерциальный блок: класс", /класс или модель/, /число от 0 до /, /Ожидается: число/],
  ]) {
    await page.evaluate((l) => localStorage.setItem("schuler.language", l), language);
    await page.goto(`${address}#/scenario?example=uav-mems`);
    await page.reload();
    const first = page.locator(".form details").first();
    await first.locator(".field").first().waitFor();
    check((await first.locator(".field").count()) === 10 && (await first.getAttribute("open")) !== null, `${language}: ten options stand first: ${await first.locator(".field").count()}`);
    const grade = first.locator('[data-key="imu.grade"]');
    check((await grade.locator("label").innerText()) === name && sentence.test(await grade.innerText()), `${language}: ${await grade.innerText()}`);
    const rate = first.locator('[data-key="gnss.rate_hz"]');
    check(range.test(await rate.innerText()), `${language}: the range: ${await rate.innerText()}`);
    await rate.locator("input").fill("often");
    check(await soon(async () => wrong.test(await rate.locator(".field-wrong").innerText())), `${language}: a wrong entry: ${await rate.innerText()}`);
    const english = await page.locator(".form .help").evaluateAll((all) => all.map((e) => e.textContent).filter((x) => !/[а-яіїєґ]/i.test(x)));
    check(english.length === 0, `${language}: sentences in English: ${english.slice(0, 3)}`);
  }
  await page.evaluate(() => (localStorage.setItem("schuler.language", "en"), sessionStorage.clear()));
  await page.reload();
}

export async function work(t) {
  const steps = [languages, frame, ...Object.values(quality), batch, comparisons, carrier, papers, receiver, graticule, tiles, live, restart];
  for (const step of steps.filter((s) => !t.options.steps || t.options.steps.includes(s.name)))
    try {
      await step(t);
    } catch (e) {
      t.check(false, `${step.name}: ${e.message.split("\n")[0]}`);   // the other steps do not need it
    }
}
