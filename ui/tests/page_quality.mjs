// Steps of page_test.mjs about the first page of a run and what leads to it: health of the sources, events, grids of outages, running again.
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { drive, ended } from "./page_work.mjs";

/** A data set of a simulated drive in the workspace; `change` may spoil a file: name, rows. */
export function dataset({ folder, options }, name, seed, change = (_, rows) => rows) {
  const to = join(folder, "work", "data", name);
  writeFileSync(join(folder, `${name}.toml`), drive(seed));
  mkdirSync(join(folder, "work", "data"), { recursive: true });
  execFileSync(options.program, ["simulate", join(folder, `${name}.toml`), "-o", to], { stdio: "ignore" });
  for (const file of ["imu.csv", "gnss.csv"]) {
    const [head, ...rows] = readFileSync(join(to, file), "utf8").trimEnd().split("\n");
    writeFileSync(join(to, file), [head, ...change(file, rows)].join("\n") + "\n");
  }
  return to;
}

const timesOf = (rows) => {
  const zero = Number(rows[0].split(",")[0]);
  return rows.map((r) => Number(r.split(",")[0]) - zero);
};

/** Two seconds of the inertial unit and twenty of GNSS are missing: both are drawn, listed and marked. */
export async function health(t) {
  const { page, address, ask, check, soon, accessible, options } = t;
  dataset(t, "holes", 8, (file, rows) => {
    const times = timesOf(rows);
    const [from, to] = file === "imu.csv" ? [100, 102] : [150, 170];
    return rows.filter((_, i) => !(times[i] > from && times[i] < to));
  });
  const { id } = await ask("api/runs", "POST", { kind: "dataset", dataset: "holes", title: "Holes", settings: {} });
  const [run] = await ended(t, [id]);
  check(run.state === "done", `holes: ${run.message}`);
  await page.goto(`${address}#/run/${id}/overview`);
  const line = page.locator("figure.health");
  await line.waitFor();
  const { summary } = await ask(`api/runs/${id}`);
  const sources = [...new Set(summary.health.map((x) => x.source))];
  const shown = await page.evaluate(() => document.querySelector("figure.health").health.sources);
  check(shown.length > 1 && shown.join() === sources.join(), `a row a source: ${shown}`);
  await line.scrollIntoViewIfNeeded();
  // the middle of an interval has the colour of its state
  const painted = (source, time) =>
    page.evaluate(
      ([source, time]) => {
        const { health } = document.querySelector("figure.health");
        const [x, y] = health.placeOf(source, time).map((v) => Math.round(v * devicePixelRatio));
        return [...health.canvas.getContext("2d").getImageData(x, y, 1, 1).data].slice(0, 3).join();
      },
      [source, time],
    );
  const colour = (name) => page.evaluate((name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim().match(/[0-9a-f]{2}/g).map((x) => parseInt(x, 16)).join(), name);
  const silent = summary.health.find((x) => x.source === "gnss_position" && x.state === "silent");
  check(silent && Math.abs(silent.to_s - silent.from_s - 20) < 1.5, `GNSS is silent for twenty seconds: ${JSON.stringify(silent)}`);
  check(await soon(async () => (await painted("gnss_position", (silent.from_s + silent.to_s) / 2)) === (await colour("--ink-6"))), "its silence is drawn");
  check((await painted("imu", 50)) === (await colour("--ink-1")), "and where the inertial unit is used");
  const list = page.locator(".event-list");
  const events = await list.innerText();
  check(/gap of the inertial unit/.test(events) && /no GNSS/.test(events), `both gaps are events: ${events}`);
  const gap = summary.health.find((x) => x.source === "imu" && x.state === "silent");
  const marks = await page.evaluate(() => document.querySelector("figure.health").health.linked.marks.map((m) => m.at));
  check(marks.includes(gap.from_s) && marks.includes(silent.from_s), `and are marked where they begin: ${gap.from_s}, ${silent.from_s}, ${marks}`);
  await accessible("health of the sources");
  if (options.shots) await page.screenshot({ path: join(options.shots, "ui-health.png"), fullPage: true });
}

/** How many points the lines of the first plot with such a title have; a plot draws as soon as it is in sight. */
const points = (page, title) =>
  page.evaluate((title) => {
    const f = [...document.querySelectorAll("figure.plot")].find((x) => x.querySelector(".plot-title")?.textContent.includes(title));
    f?.scrollIntoView();
    return f?.plot?.data.y.map((y) => y.filter((v) => v !== null).length) ?? [];
  }, title);

/** GNSS withheld in windows at regular intervals: the windows of the form are those of the run, and running again finds them. */
export async function grid(t) {
  const { page, address, ask, check, soon, done, accessible } = t;
  dataset(t, "windows", 9);
  await page.goto(`${address}#/data/windows`);
  await page.locator('.task input[value="grid"]').check();
  await page.getByLabel("length of a window").fill("50");
  await page.getByLabel("one every").fill("40");
  const start = page.locator("button.primary.run");
  check((await start.isDisabled()) && /no window fits/.test(await start.getAttribute("title")), `windows that overlap are refused with the reason: ${await start.getAttribute("title")}`);
  await page.getByLabel("length of a window").fill("15");
  await page.getByLabel("the first after").fill("80");
  check(await soon(async () => /4 windows: 80 s \+ 15 s to 200 s \+ 15 s/.test(await page.locator(".tasks [role=status]").innerText())), `the windows are told: ${await page.locator(".tasks [role=status]").innerText()}`);
  await page.reload();
  await page.getByLabel("length of a window").waitFor();
  check((await page.getByLabel("length of a window").inputValue()) === "15" && (await page.getByLabel("the first after").inputValue()) === "80", "a reload keeps the windows");
  await accessible("outage grid");
  await start.click();
  const id = await done();
  const { summary } = await ask(`api/runs/${id}`);
  check(summary.outages.map((o) => `${o.start_s.toFixed(3)}+${o.duration_s.toFixed(3)}`.replaceAll(".000", "")).join() === "80+15,120+15,160+15,200+15", `the windows of the run: ${JSON.stringify(summary.outages)}`);
  await page.goto(`${address}#/run/${id}/overview`);
  await page.locator(`.run[data-run="${id}"] .quality`).waitFor();
  check(await soon(async () => (await points(page, "difference to the withheld fixes"))[0] > 40), `errors in the outages are drawn: ${await points(page, "difference to the withheld fixes")}`);
  await page.getByRole("link", { name: "Change and run again" }).click();
  await page.getByLabel("length of a window").waitFor();
  check((await page.locator(".task input:checked").getAttribute("value")) === "grid" && (await page.getByLabel("one every").inputValue()) === "40", "running again finds the grid");
}

/** Forward minus backward, errors in outages, and the settings as the difference to another run. */
export async function separation(t) {
  const { page, address, ask, check, soon } = t;
  dataset(t, "both-ways", 10);
  const order = (title, more) => ask("api/runs", "POST", { kind: "dataset", dataset: "both-ways", title, ...more });
  const plain = await order("Plain", { settings: {} });
  const both = await order("Both ways", { settings: { outage: [{ start_s: 120, duration_s: 30 }] }, arguments: { backward: true } });
  for (const run of await ended(t, [plain.id, both.id])) check(run.state === "done", `${run.title}: ${run.message}`);
  await page.goto(`${address}#/run/${both.id}/overview`);
  await page.locator(`.run[data-run="${both.id}"] .quality`).waitFor();
  for (const [title, least] of [["forward − backward", 50], ["difference to the withheld fixes", 20]])
    check(await soon(async () => (await points(page, title))[0] > least), `${title}: ${await points(page, title)}`);
  await page.locator("summary", { hasText: "Settings and where they come from" }).click();
  await page.getByLabel("Difference to", { exact: true }).selectOption({ label: "Plain" });
  await page.locator("table.facts thead th", { hasText: "Plain" }).waitFor();
  const rows = await page.locator("table.facts tbody tr").allInnerTexts();
  const { facts } = (await ask(`api/runs/${both.id}`)).summary;
  const others = new Map((await ask(`api/runs/${plain.id}`)).summary.facts.map((f) => [f.key, JSON.stringify(f.value)]));
  const differ = facts.filter((f) => others.get(f.key) !== JSON.stringify(f.value)).map((f) => f.key);
  check(differ.length > 0 && differ.length < facts.length, `something differs, and not everything: ${differ}`);
  check(differ.every((key) => rows.some((r) => r.startsWith(key))), `what differs is told: ${rows}`);
  check(rows.every((r) => !facts.some((f) => r.startsWith(`${f.key}\t`) && !differ.includes(f.key))), `and nothing else: ${rows}`);
}
