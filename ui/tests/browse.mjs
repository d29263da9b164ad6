// The server of `schuler ui` and a browser on its page, for the tests of the page.
import { spawn } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

export function optionsOf(words) {
  return Object.fromEntries(words.flatMap((a, i) => (a.startsWith("--") ? [[a.slice(2), words[i + 1] ?? ""]] : [])));
}

export function skip(why) {
  console.log(`SKIPPED: ${why}`);
  process.exit(77);
}

/** The server in `folder`, its workspace `folder`/work; `words`: more of its command line. */
export async function serve(program, folder, words = [], port = 0) {
  const server = spawn(program, ["ui", "--port", String(port), "--workspace", join(folder, "work"), ...words], {
    cwd: folder,
    stdio: ["ignore", "pipe", "inherit"],
  });
  process.on("exit", () => server.kill());   // a test that ends early leaves no server behind
  const entrance = await new Promise((resolve, reject) => {
    server.stdout.on("data", (d) => {
      const found = /http:\S+/.exec(String(d));
      if (found) resolve(found[0]);
    });
    server.on("exit", () => reject(new Error("the server ended")));
  });
  // The token of the entrance becomes a cookie; from then on the page asks without it.
  const address = new URL("/", entrance).href,
    token = new URL(entrance).searchParams.get("token");
  const ask = async (path, method = "GET", body = undefined) => {
    const headers = { Authorization: `Bearer ${token}`, ...(body === undefined ? {} : { "Content-Type": "application/json" }) };
    const reply = await fetch(address + path, { method, headers, ...(body === undefined ? {} : { body: JSON.stringify(body) }) });
    return reply.json();
  };
  const stop = async () => {
    server.removeAllListeners("exit");
    const over = new Promise((r) => server.once("exit", r));
    server.kill("SIGTERM");
    await over;
  };
  return { server, entrance, address, token, ask, stop };
}

/** A browser, or the end of the test where there is none. */
export async function browse(options, settings = {}) {
  const path = options.browser ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
  if (!path || !existsSync(path)) skip("there is no Chromium");
  if (!existsSync(join(options.modules, "playwright-core")))
    skip("there is no playwright-core; scripts/build_ui.sh installs it where npm reaches a registry");
  const require = createRequire(resolve(options.modules, "x.js"));
  const { chromium } = require("playwright-core");
  const browser = await chromium.launch({
    executablePath: path,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing"],
  });
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, acceptDownloads: true, colorScheme: "light", ...settings });
  await context.addInitScript(() => {
    if (window.top === window) localStorage.getItem("schuler.language") ?? localStorage.setItem("schuler.language", "en");
  });
  // the page from a folder instead of that in the program: no build after a change of it
  if (options.dist)
    await context.route(/\/(index\.html)?(\?[^/]*)?$|\/assets\/|\/icon\.svg$/, async (route) => {
      const path = new URL(route.request().url()).pathname.slice(1) || "index.html";
      try {
        const response = await route.fetch({ maxRedirects: 0 });
        if (response.status() >= 300 && response.status() !== 404) return await route.fulfill({ response });
        const type = { html: "text/html", js: "text/javascript", css: "text/css", svg: "image/svg+xml" }[path.split(".").at(-1)];
        await route.fulfill({ status: 200, headers: { ...response.headers(), "content-type": `${type}; charset=utf-8` }, body: readFileSync(join(options.dist, path)) });
      } catch {
        await route.abort().catch(() => undefined);   // the tab is closed, or the server ends
      }
    });
  const page = await context.newPage();
  page.setDefaultTimeout(1000 * Number(options.wait ?? 60));
  return { browser, context, page, require };
}

/**
 * Opens every tab of a run and tells what is wrong with it: an error text, a plot without a point, a page wider than the window.
 * Errors of the console are the caller's to collect.
 */
export async function visitTabs(page, address, run, { wait = 8000, only = null, shot = null } = {}) {
  const wrong = [];
  await page.goto(`${address}#/run/${encodeURIComponent(run)}`);
  await page.locator(`.run[data-run="${run}"] [role="tablist"]`).waitFor();
  const tabs = await page.locator('[role="tab"]').evaluateAll((all) => all.map((t) => t.id.replace("tab-", "")));
  for (const tab of tabs) {
    if (only && !only.includes(tab)) continue;
    await page.locator(`#tab-${tab}`).click();
    await page.locator(`#view[data-tab="${tab}"]`).waitFor().catch(() => wrong.push(`${tab}: does not open`));
    // plots load as they come into sight
    const plots = await page.locator("#view figure.plot").count();
    const state = () =>
      page.evaluate(() => {
        const out = { errors: [], empty: [], pending: 0 };
        for (const e of document.querySelectorAll("#view .bad, main > .card .bad")) out.errors.push(e.textContent.slice(0, 200));
        for (const f of document.querySelectorAll("#view figure.plot")) {
          if (!f.plot || f.hidden) continue;
          const { data } = f.plot;
          const title = f.querySelector(".plot-title")?.textContent;
          const note = f.querySelector(".plot-note")?.textContent ?? "";
          if (f.plot.failed) out.errors.push(`${title}: ${note}`);
          else if (!f.plot.shown) ++out.pending;
          else if (!f.plot.settings.mayBeEmpty && !data.y.some((y) => y.some((v) => v !== null && Number.isFinite(v)))) out.empty.push(title);
        }
        return out;
      });
    let now = await state();
    for (let i = 0; i < plots && now.pending > 0; ++i)
      if (i < 40) {
        await page.locator("#view figure.plot").nth(i).scrollIntoViewIfNeeded({ timeout: 1000 }).catch(() => undefined);   // a hidden one stays away
        await page.waitForTimeout(40);
        if (i % 6 === 5) now = await state();
      }
    const until = Date.now() + wait;
    while (now.pending > 0 && Date.now() < until) {
      await page.waitForTimeout(150);
      const next = await page.evaluate(() => {
        const f = [...document.querySelectorAll("#view figure.plot")].find((x) => x.plot && !x.hidden && !x.plot.shown && !x.plot.failed);
        f?.scrollIntoView();
        return Boolean(f);
      });
      now = await state();
      if (!next) break;
    }
    for (const e of now.errors) wrong.push(`${tab}: ${e}`);
    for (const e of now.empty) wrong.push(`${tab}: the plot "${e}" is empty`);
    if (now.pending > 0) wrong.push(`${tab}: ${now.pending} plots were not drawn`);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    if (wide > 1) wrong.push(`${tab}: ${wide} px wider than the window`);
    if (shot) await shot(tab);
  }
  return { tabs, wrong };
}
