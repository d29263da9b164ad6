// Every example and every real data set through the page of `schuler ui`: runs all of them, opens every tab of every run and every data
// set, and fails on a console error, an error text, an empty plot, a page wider than its window, an example that is refused or fails, and a
// set that cannot be processed and is not listed below with the reason.
//   node page_all.mjs --program SCHULER --modules NODE_MODULES [--data FOLDER] [--only WORD] [--shots FOLDER] [--width PIXELS] [--examples no]
//                     [--dist UI_BUNDLE] [--table FILE]
// --table: what was opened, as the table of docs/ui.md.
// Exit status 0 passed, 1 failed, 77 skipped.
import { cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { browse, optionsOf, serve, visitTabs } from "./browse.mjs";

const options = optionsOf(process.argv.slice(2));
/** Sets of which the task that the page offers first cannot be done, and why. */
const hopeless = {
};
const folder = mkdtempSync(join(tmpdir(), "schuler_all_"));
const { browser, page } = await browse(options, options.width ? { viewport: { width: Number(options.width), height: 844 } } : {});
const { entrance, address, ask, stop } = await serve(options.program, folder);
let failures = 0;
const complaints = [];
/** What was opened: name, task or kind, tabs, state. Failures are counted by name. */
const opened = new Map();
const faults = new Map();
const fail = (where, what) => {
  ++failures;
  faults.set(where, (faults.get(where) ?? 0) + 1);
  console.error(`FAILED: ${where}: ${what}`);
};
page.on("pageerror", (e) => complaints.push(`error on the page: ${e.message}`));
page.on("console", (m) => m.type() === "error" && complaints.push(`console: ${m.text()}`));
page.on("response", (r) => r.status() >= 400 && complaints.push(`${r.status()} ${r.url().slice(address.length)}`));
const wanted = (name) => !options.only || name.includes(options.only);
const shot = async (name) => {
  if (!options.shots) return;
  mkdirSync(options.shots, { recursive: true });
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.waitForTimeout(250);
  await page.screenshot({ path: join(options.shots, `${name}.png`) });
};
const finished = async (id) => {
  for (;;) {
    const run = await ask(`api/runs/${id}`);
    if (run.state !== "waiting" && run.state !== "running") return run;
    await new Promise((r) => setTimeout(r, 300));
  }
};
const visit = async (name, id, what) => {
  complaints.length = 0;
  const { tabs, wrong } = await visitTabs(page, address, id, { shot: options.shots ? (tab) => shot(`${name}-${tab}`) : null });
  for (const w of [...wrong, ...complaints]) fail(name, w);
  opened.set(name, { what, tabs, end: (await ask(`api/runs/${id}`)).state });
  console.log(`${name}: ${tabs.join(" ")}`);
};

/** An example or a study is there to be run: refused or failed it is a fault. */
const through = async (name, order, what, path = "api/runs") => {
  const begun = await ask(path, "POST", order);
  if (begun.error) return fail(name, `refused: ${begun.error.text}`);
  const run = await finished(begun.id);
  if (run.state !== "done") fail(name, `${run.state}: ${run.message || "without a word"}`);
  await visit(name, begun.id, what);
  return begun.id;
};

/** The table of docs/ui.md. */
const table = () => {
  const row = ([name, { what, tabs, end }]) => `| ${name} | ${what} | ${tabs.length}: ${tabs.join(", ")} | ${end}${hopeless[name] ? `: ${hopeless[name]}` : ""} | ${faults.get(name) ?? 0} |`;
  return ["| set | what was run | tabs opened | ended | errors |", "|---|---|---|---|---|", ...[...opened].map(row)].join("\n") + "\n";
};

try {
  await page.goto(entrance);
  await page.locator(".drop").waitFor();
  const plain = (await ask("api/examples")).filter((e) => wanted(e.name) && options.examples !== "no");
  for (const { name, toml } of plain) {
    const { settings } = await ask("api/settings?of=scenario", "POST", { toml });
    const gravity = Object.keys(settings ?? {}).some((k) => k.startsWith("gravity.") || k.startsWith("anomaly"));
    await through(name, { kind: "scenario", title: name, toml, command: gravity ? "gravity" : "run" }, `example, ${gravity ? "gravity" : "run"}`);
  }
  // of those that need nothing but their defaults
  const alone = (s) => !s.input && !(s.accepts ?? []).includes("recording") && !s.options.some((o) => o.required);
  for (const study of (await ask("api/studies")).filter((s) => alone(s) && wanted(s.command) && options.examples !== "no"))
    await through(study.command.replace(" ", "-"), { command: study.command, title: study.command, settings: {} }, "study", "api/studies");
  const data = options.data && existsSync(options.data) ? readdirSync(options.data).filter((d) => statSync(join(options.data, d)).isDirectory() && wanted(d)) : [];
  if (data.length === 0) console.log("no data sets: give --data FOLDER");
  for (const name of data) {
    const id = name.toLowerCase().replaceAll("_", "-");
    mkdirSync(join(folder, "work", "data"), { recursive: true });
    cpSync(join(options.data, name), join(folder, "work", "data", id), { recursive: true });
    complaints.length = 0;
    await page.goto(`${address}#/data/${id}`);
    await page.locator(".tasks").waitFor({ timeout: 120_000 }).catch(() => fail(name, "its page does not open"));
    for (const card of await page.locator("details:has(> .form-tools), details.raw-signals").all()) {
      await card.locator("> summary").click();
      // a plot is drawn when it is seen
      await card.locator("figure.plot").first().scrollIntoViewIfNeeded({ timeout: 120_000 }).catch(() => {});
      await card.locator("figure.plot .u-over").first().waitFor({ timeout: 120_000 }).catch(async () => fail(name, `raw logs: ${await card.innerText()}`));
    }
    for (const word of await page.locator(".bad:not([hidden])").allInnerTexts()) fail(name, `data page: ${word}`);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    if (wide > 1) fail(name, `data page ${wide} px wider than the window`);
    for (const c of complaints) fail(name, c);
    await shot(`data-${name}`);
    // what the page would start by itself
    const task = await page.locator('.task input:checked').getAttribute("value", { timeout: 2000 }).catch(() => null);
    const button = page.locator("button.primary.run");
    if (!task || (await button.isDisabled())) {
      const why = await page.locator(".note:not([hidden])").allInnerTexts();
      if (why.length === 0) fail(name, "nothing can be started and no reason is told");
      else if (!hopeless[name]) fail(name, `cannot be processed: ${why.join(" ")}`);
      opened.set(name, { what: "data page", tabs: [], end: "not started" });
      console.log(`${name}: ${why.join(" ")}`);
      continue;
    }
    await button.click();
    await page.waitForURL(/#\/run\//, { timeout: 60_000 }).catch(async () => fail(name, `does not start: ${await page.locator(".toast").allInnerTexts()}`));
    const run = decodeURIComponent(/#\/run\/([^/]+)/.exec(page.url())?.[1] ?? "");
    if (!run) continue;
    const end = await finished(run);
    if (end.state !== "done") {
      if (!hopeless[name]) fail(name, `${task}: ${end.state}: ${end.message}`);
      console.log(`${name} (${task}): ${end.state}: ${end.message}`);
    } else if (hopeless[name]) fail(name, "is processed by now: take it off the list");
    await visit(name, run, task);
  }
} catch (e) {
  fail("test", String(e.stack ?? e));
} finally {
  await browser.close();
  await stop();
  rmSync(folder, { recursive: true, force: true });
}
if (options.table) writeFileSync(options.table, table());
console.log(`page_all: ${failures} failures`);
process.exit(failures ? 1 : 0);
