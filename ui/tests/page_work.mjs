// Steps of page_test.mjs that need no run of the others: several data sets together, notes, removal, comparisons of couplings and of
// attitude, carrier phase, a server that ends and is started anew.
import { execFileSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { serve } from "./browse.mjs";
import { first } from "./page_first.mjs";
import { formSteps } from "./page_forms.mjs";
import { live } from "./page_live.mjs";
import { graticule, tiles } from "./page_maps.mjs";
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
  await page.route((url) => url.pathname === `/api/runs/${id}`, async (route) => {
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

/** The server ends: the page says so. It is started anew, with another token: that too; and all is well with the new address. */
async function restart(t) {
  const { page, check, options } = t;
  const folder = mkdtempSync(join(tmpdir(), "schuler_anew_"));
  const before = await serve(options.program, folder);
  const tab = await page.context().newPage();
  let after = null;
  try {
    await tab.goto(before.entrance);
    await tab.locator(".drop").waitFor();
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
  const steps = [first, languages, frame, batch, ...formSteps, quality.health, quality.grid, quality.separation, comparisons, carrier, papers, receiver, graticule, tiles, live, restart];
  for (const step of steps.filter((s) => !t.options.steps || t.options.steps.includes(s.name)))
    try {
      await step(t);
    } catch (e) {
      const where = /page_\w+\.mjs:\d+/.exec(e.stack ?? "")?.[0] ?? "";
      const seen = (await t.page.locator("#content").innerText({ timeout: 2000 }).catch(() => "-")).slice(0, 200).replaceAll("\n", " | ");
      t.check(false, `${step.name}: ${e.message.split("\n")[0]} ${where}, page: ${seen}`);   // the other steps do not need it
    }
}
