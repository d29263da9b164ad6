// Steps of page_test.mjs for the live view: a drive replayed to `schuler live`, satellites of a receiver, tabs that share one stream.
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { createServer } from "node:net";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { serve } from "./browse.mjs";
import { drive } from "./page_work.mjs";

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

/** Eight tabs of one browser: one of them listens to each stream and the others hear it; another one takes the place of one that is closed. */
async function shared({ check, soon }, tab, server) {
  const context = tab.context();
  const asked = [];
  const listen = (r) => {
    const { pathname, origin } = new URL(r.url());
    if (origin === new URL(server.address).origin && /^\/api\/(live|events)$/.test(pathname)) asked.push(pathname);
  };
  context.on("request", listen);
  const more = [];
  try {
    for (let i = 0; i < 7; ++i) {
      const one = await context.newPage();
      more.push(one);
      await one.goto(`${server.address}#/${i % 2 ? "" : "live"}`);
      await one.locator("h1").waitFor({ timeout: 10_000 });
    }
    const drawn = (one) => one.evaluate(() => [...document.querySelectorAll(".live figure.plot")].find((f) => f.plot)?.plot.data.x.at(-1) ?? -1);
    const moves = async (one) => {
      await one.bringToFront();
      const before = await drawn(one);
      return soon(async () => (await drawn(one)) > before + 0.5);
    };
    for (const one of [more[0], more[2], more[6]]) {
      check(await moves(one), "a later tab shows what arrives");
      await one.locator(".live-link", { hasText: "Messages of" }).waitFor();
    }
    const n = (path) => asked.filter((p) => p === path).length;
    check(n("/api/live") === 0 && n("/api/events") <= 1, `eight tabs have one stream of each kind: ${asked}`);
    await tab.goto(`${server.address}#/`);
    check(await soon(async () => n("/api/live") > 0), "the next tab listens when the first one leaves");
    check(await moves(more[4]), "and the others hear it");
    check(n("/api/live") === 1, `by one stream again: ${asked}`);
  } finally {
    context.off("request", listen);
    for (const one of more) await one.close();
    await tab.bringToFront();
    await tab.goto(`${server.address}#/live`);
    await tab.locator(".live-link", { hasText: "Messages of" }).waitFor();
  }
}

/** A drive replayed to `schuler live`, whose messages the page shows: nothing yet, navigation, the end. */
export async function live(t) {
  const { page, check, options, accessible } = t;
  const folder = mkdtempSync(join(tmpdir(), "schuler_live_"));
  const [samples, messages] = [await freePort(), await freePort()];
  writeFileSync(join(folder, "drive.toml"), drive(4).replace("duration_s = 240", "duration_s = 1200"));
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
    await shared(t, tab, server);
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
