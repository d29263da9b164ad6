// The pictures of README and docs, made anew; the same pages in another theme, width or language to be looked at.
//   node shots.mjs --program SCHULER --modules NODE_MODULES --shots FOLDER [--dist UI_BUNDLE] [--data FOLDER] [--looks yes]
// --data: the real sets (default: shared/data beside the source tree), for the quality control of a drive; a simulated drive without them.
// --looks yes: each page also as NAME-LOOK.png: dark, 390 px wide, in Ukrainian, in Russian.
import { cpSync, existsSync, mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { browse, optionsOf, serve } from "./browse.mjs";
import { work } from "./page_work.mjs";

const options = optionsOf(process.argv.slice(2));
const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const data = options.data ?? process.env.SCHULER_DATA ?? join(root, "../shared/data");
const wide = { width: 1440, height: 900 };
const folder = mkdtempSync(join(tmpdir(), "schuler_shots_"));
mkdirSync(options.shots, { recursive: true });
const { browser, page } = await browse(options, { viewport: wide });
page.setDefaultTimeout(120_000);
const { entrance, address, ask, stop } = await serve(options.program, folder);
let failures = 0;
const check = (good, text) => good || (++failures, console.error(`FAILED: ${text}`));

const looks = [
  ["", wide, "light", "en"],
  ...(options.looks ? [["-dark", wide, "dark", "en"], ["-390", { width: 390, height: 844 }, "light", "uk"], ["-390-dark", { width: 390, height: 844 }, "dark", "ru"], ["-uk", wide, "light", "uk"]] : []),
];
const shot = async (name, path, ready) => {
  for (const [suffix, size, colorScheme, language] of looks) {
    await page.setViewportSize(size);
    await page.emulateMedia({ colorScheme });
    await page.evaluate((l) => localStorage.setItem("schuler.language", l), language);
    await page.goto(`${address}#/${path}`);
    await page.reload();
    await page.locator(ready).first().waitFor();
    await page.waitForTimeout(1500);
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(over <= 1, `${name}${suffix}: ${over} px wider than the window`);
    await page.screenshot({ path: join(options.shots, `${name}${suffix}.png`) });
  }
};
const finished = async ({ id, error }) => {
  if (error) throw new Error(error.text);
  for (;;) {
    const run = await ask(`api/runs/${id}`);
    if (run.state === "done") return id;
    if (run.state === "failed" || run.state === "cancelled") throw new Error(`${run.title}: ${run.message}`);
    await page.waitForTimeout(300);
  }
};

try {
  await page.goto(entrance);
  await page.locator(".drop").waitFor();
  const examples = await ask("api/examples");
  const scenario = async (name, title, command = "run", change = (toml) => toml) =>
    finished(await ask("api/runs", "POST", { kind: "scenario", title, command, toml: change(examples.find((e) => e.name === name).toml) }));
  await shot("ui-scenario", "scenario?example=uav-mems", ".form .field");
  const flight = await scenario("uav-mems", "Flight");
  await shot("ui-errors", `run/${flight}/errors`, "figure.plot canvas");
  let drive = flight;
  if (existsSync(join(data, "drive_0708"))) {
    cpSync(join(data, "drive_0708"), join(folder, "work", "data", "drive"), { recursive: true });
    drive = await finished(await ask("api/runs", "POST", { kind: "dataset", dataset: "drive", title: "Drive", arguments: { backward: true } }));
    if (options.looks) await shot("ui-data", "data/drive", ".tasks");
  }
  await shot("ui-quality", `run/${drive}/overview`, ".quality .plot canvas");
  if (options.looks) for (const tab of ["innovations", "signals", "track"]) await shot(`ui-${tab}`, `run/${drive}/${tab}`, "figure canvas");
  const pair = [];
  for (const scheme of ["tight", "loose"])
    pair.push(await scenario("triad-2sv", `Two satellites, ${scheme}`, "run", (toml) => toml.replace(/^scheme = .*$/m, `scheme = "${scheme}"`)));
  await shot("ui-compare", `compare/${pair.join("/")}`, "figure.plot canvas");
  await shot("ui-sky", `run/${pair[0]}/sky`, ".sky-now");
  await shot("ui-gravity", `run/${await scenario("gravity-flight", "Survey", "gravity")}/gravity`, "figure.plot canvas");
  if (options.looks) for (const [name, path, ready] of [["ui-start", "", ".examples li"], ["ui-batch", "batch", ".batch-sets"], ["ui-studies", "studies/analyze%20schuler", ".study-form"]]) await shot(name, path, ready);
  await page.setViewportSize({ width: 1280, height: 1900 });
  await page.emulateMedia({ colorScheme: "light" });
  const demo = await scenario("demo", "demo");
  await page.goto(pathToFileURL(join(folder, "work", demo, "report.html")).href);
  await page.waitForTimeout(1500);
  await page.screenshot({ path: join(options.shots, "report.png") });
  await page.setViewportSize(wide);
  await page.goto(address);
  await page.evaluate(() => localStorage.setItem("schuler.language", "en"));
  await work({ page, address, ask, check, folder, options: { ...options, steps: "live" }, accessible: async () => undefined, shot: async () => undefined, soon: async (c) => {
    for (let i = 0; i < 100; ++i) {
      if (await c()) return true;
      await page.waitForTimeout(100);
    }
    return false;
  } });
} catch (e) {
  check(false, String(e.stack ?? e));
} finally {
  await browser.close();
  await stop();
  rmSync(folder, { recursive: true, force: true });
}
console.log(`shots: ${failures} failures`);
process.exit(failures ? 1 : 0);
