// What is drawn before the scripts of the page are there, and that they take it over without a jump.

/** Where things stand, and what they say. */
const places = (tab) =>
  tab.evaluate(() => {
    const out = {};
    const shown = [...document.querySelectorAll("header .brand, header nav a, main h1, main .lead")].filter((e) => e.checkVisibility());
    for (const e of shown) {
      const { x, y, height } = e.getBoundingClientRect();
      out[e.innerText] = [x, y, height].map(Math.round).join();
    }
    return out;
  });

export async function first({ page, address, check }) {
  for (const [language, word, title, theme] of [
    ["uk", "Сценарій", "Інтегрована інерціально-супутникова навігація", "dark"],
    ["en", "Scenario", "Integrated inertial-satellite navigation", "light"],
  ]) {
    const tab = await page.context().newPage();
    try {
      await tab.goto(`${address}icon.svg`);
      await tab.evaluate(([l, c]) => (localStorage.setItem("schuler.language", l), localStorage.setItem("schuler.theme", c)), [language, theme]);
      const asked = [];
      tab.on("request", (r) => asked.push(new URL(r.url()).pathname));
      let release = null;
      const held = new Promise((r) => (release = r));
      await tab.route("**/assets/main.js", async (route) => (await held, route.fallback()));
      await tab.goto(address, { waitUntil: "commit" });
      await tab.locator("main h1").waitFor({ timeout: 10_000 });
      const before = await places(tab);
      check(word in before && title in before && Object.keys(before).length === 8, `${language}: drawn without scripts: ${Object.keys(before)}`);
      check((await tab.evaluate(() => document.documentElement.dataset.theme)) === theme, `${language}: in the colours that were chosen`);
      for (let i = 0; i < 50 && !asked.includes("/api/runs"); ++i) await tab.waitForTimeout(50);
      check(["/api/examples", "/api/datasets", "/api/runs"].every((p) => asked.includes(p)), `${language}: asked for before the scripts are there: ${asked}`);
      release();
      await tab.locator(".drop").waitFor();
      const after = await places(tab);
      check(JSON.stringify(before) === JSON.stringify(after), `${language}: nothing jumps: ${JSON.stringify(before)} ${JSON.stringify(after)}`);
      check(asked.filter((p) => p === "/api/examples").length === 1, `${language}: what is asked for early is asked for once`);
      // of a run the heading of the first page is not shown, not for a moment
      await tab.unroute("**/assets/main.js");
      await tab.route("**/assets/main.js", () => undefined);
      await tab.goto("about:blank");
      await tab.goto(`${address}#/run/none/overview`, { waitUntil: "commit" });
      await tab.locator("header nav a").first().waitFor();
      check(!(title in (await places(tab))), `${language}: a run does not begin with the first page`);
    } catch (e) {
      check(false, `before the scripts, ${language}: ${e.message.split("\n")[0]}`);
    } finally {
      await tab.evaluate(() => localStorage.removeItem("schuler.theme")).catch(() => undefined);
      await tab.close();
    }
  }
}
