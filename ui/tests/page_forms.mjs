// Steps of page_test.mjs about forms: what is typed is kept until it is run, what is wrong is told, a run is repeated with its own settings.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { dataset } from "./page_quality.mjs";
import { drive, ended } from "./page_work.mjs";

/** What is typed survives a reload and the way back; a field that holds no value keeps the run from starting. */
async function drafts(t) {
  const { page, address, check, soon } = t;
  const start = page.locator("button.primary.run");
  await page.goto(`${address}#/scenario?example=uav-mems`);
  const length = page.locator("#option-duration_s");
  await length.waitFor();
  const before = await length.inputValue();
  await length.fill("ten");
  check(await start.isDisabled(), "no run of a field without a value");
  await length.fill("555");
  check(await soon(async () => start.isEnabled()), "and again with one");
  await page.reload();
  await length.waitFor();
  check((await length.inputValue()) === "555", "a reload keeps what was typed");
  await page.getByRole("button", { name: "Discard them" }).click();
  check(await soon(async () => (await length.inputValue()) === before), "unless it is discarded");
  check((await page.locator(".restored").count()) === 0, "and nothing is restored then");

  // what only the server knows to be wrong
  await page.getByPlaceholder("Find an option").fill("trajectory.type");
  await page.locator("#option-trajectory-type").selectOption("waypoints");
  check(await soon(async () => start.isDisabled()), "no run of settings that the server refuses");
  check((await start.getAttribute("title")).length > 10 && (await page.locator(".bad:not([hidden])").count()) === 1, `with the reason: ${await start.getAttribute("title")}`);

  await page.evaluate(() => sessionStorage.clear());

  // there and back again
  const away = async (at, change, see) => {
    // by the first page: a page whose address changes stays until the next one is made
    await page.goto(`${address}#/`);
    await page.locator(".examples li").first().waitFor();
    await page.goto(`${address}${at}`);
    await start.waitFor();
    await change();
    await page.waitForTimeout(100);
    await page.goto(`${address}#/`);
    await page.locator(".examples li").first().waitFor();
    await page.goBack();
    await start.waitFor();
    await see();
    check(await soon(async () => (await page.locator(".restored").count()) === 1), `${at}: that a draft was taken up is told`);
    await page.getByRole("button", { name: "Discard them" }).click();
    check(await soon(async () => (await page.locator(".restored").count()) === 0), `${at}: and can be discarded`);
  };
  const name = page.getByLabel("Name", { exact: true });
  await away("#/scenario?example=demo", async () => name.fill("A name alone"), async () => check((await name.inputValue()) === "A name alone", "a name alone is kept"));
  const what = page.getByLabel("What to do");
  await away(
    "#/scenario?example=triad-2sv",
    async () => {
      await what.selectOption("montecarlo");
      await page.getByLabel("Number of runs").fill("7");
    },
    async () => check((await what.inputValue()) === "montecarlo" && (await page.getByLabel("Number of runs").inputValue()) === "7", "so is a campaign with its number of runs"),
  );
  dataset(t, "kept-a", 11);
  dataset(t, "kept-b", 12);
  const task = (value) => page.locator(`.task input[value="${value}"]`);
  const rate = page.locator(".tasks #option-output-rate");
  await away(
    "#/data/kept-a",
    async () => {
      await task("ahrs").check();
      await page.locator(".tasks .form input[type=text]").first().fill("7");
    },
    async () => check((await task("ahrs").isChecked()) && (await page.locator(".tasks .form input[type=text]").first().inputValue()) === "7", "so are a task and its options"),
  );
  await away(
    "#/batch",
    async () => {
      await page.getByRole("button", { name: "None", exact: true }).click();
      await page.locator('.batch-sets input[value="kept-b"]').check();
      await task("process").check();
      await page.locator(".tasks summary").first().click();
      await rate.fill("3");
    },
    async () => check((await page.locator(".batch-sets input:checked").count()) === 1 && (await page.locator('.batch-sets input[value="kept-b"]').isChecked()) && (await rate.inputValue()) === "3", "so are the choice of a batch and its options"),
  );
  const speed = page.locator("#option-speed");
  await away(`#/studies/${encodeURIComponent("analyze equator")}`, async () => speed.fill("612"), async () => check((await speed.inputValue()) === "612", "so is a study"));
}

/** Running again begins with the name, the settings, the outages and the options of the run, and comes to the same order. */
async function again(t) {
  const { page, address, ask, check, soon, done } = t;
  await page.evaluate(() => sessionStorage.clear());
  dataset(t, "repeated", 14);
  const outage = [{ start_s: 130, duration_s: 12 }];
  const orders = {
    scenario: { kind: "scenario", title: "Mine, of a scenario", toml: `${drive(13)}[filter]\nscheme = "loose"\n[[outage]]\nstart_s = 130\nduration_s = 12\n` },
    "data set": { kind: "dataset", dataset: "repeated", title: "Mine, of a data set", settings: { outage, "run.settle_s": 33 }, arguments: { backward: true } },
  };
  for (const [of, order] of Object.entries(orders)) {
    const { id } = await ask("api/runs", "POST", order);
    const [run] = await ended(t, [id]);
    check(run.state === "done", `${of}: ${run.message}`);
    await page.goto(`${address}#/run/${id}/overview`);
    await page.locator(`.run[data-run="${id}"]`).getByRole("link", { name: "Change and run again" }).click();
    await page.locator(".run[data-run]").waitFor({ state: "detached" });
    const start = page.locator("button.primary.run");
    await start.waitFor();
    check((await page.locator("input.run-name").inputValue()) === order.title, `${of}: the name is that of the run: ${await page.locator("input.run-name").inputValue()}`);
    check((await page.locator("#option-filter-scheme").inputValue()) === "loose", `${of}: so is the scheme`);
    const spans = await page.locator(".outage-list .outage input").evaluateAll((all) => all.map((i) => i.value));
    check(spans.join() === "130,12", `${of}: and the outage: ${spans}`);
    if (of === "data set") check((await page.locator(".tasks #option-backward").inputValue()) === "true", `${of}: and the options`);
    check(await soon(async () => start.isEnabled()), `${of}: it can be started`);
    await start.click();
    const second = await done();
    check(second !== id, `${of}: as another run`);
    const settings = async (run) => JSON.stringify((await ask(`api/runs/${run}/settings`)).settings);
    check((await settings(second)) === (await settings(id)), `${of}: the same settings: ${await settings(second)} ${await settings(id)}`);
    const [a, b] = [(await ask(`api/runs/${id}`)), await ask(`api/runs/${second}`)];
    check(JSON.stringify(b.order.arguments) === JSON.stringify(a.order.arguments), `${of}: the same options: ${JSON.stringify([a.order, b.order])}`);
    check(b.summary.outages.length === 1 && b.summary.outages[0].start_s === 130, `${of}: the same outage: ${JSON.stringify(b.summary.outages)}`);
  }
}

/** What is wrong is told where it is: the line of a TOML text; files that are refused leave no data set. */
async function faults(t) {
  const { page, address, ask, check, soon, folder } = t;
  await page.goto(`${address}#/`);
  await page.locator(".drop").waitFor();
  await page.goto(`${address}#/scenario?example=demo`);
  await page.locator("summary", { hasText: "As TOML" }).click();
  const text = page.locator("textarea.toml");
  await text.fill('name = "x"\nduration_s = 100\nspeed = = 3\n');
  await page.getByRole("button", { name: "Take this text" }).click();
  await page.locator(".toast.error").first().waitFor();
  check(/line 3/.test(await page.locator(".toast.error").first().innerText()), `the line of a fault in TOML: ${await page.locator(".toast.error").first().innerText()}`);
  await page.goto(`${address}#/`);
  await page.locator(".drop").waitFor();
  const before = (await ask("api/datasets")).length;
  const big = join(folder, "big.csv");
  writeFileSync(big, "time_s\n1\n");
  await page.route("**/api/datasets/*/files/*", (route) => route.fulfill({ status: 413, contentType: "application/json", body: JSON.stringify({ error: { text: "too large for the workspace", mend: "", key: "", line: 0 } }) }));
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Choose files" }).click()]);
  await chooser.setFiles(big);
  await page.locator(".drop-status .bad", { hasText: "too large" }).waitFor();
  check(await soon(async () => (await ask("api/datasets")).length === before), "a refused upload leaves no data set");
  await page.unrouteAll({ behavior: "wait" });
}

/** The keyboard alone: past the header, from tab to tab, into the help and back. */
async function keyboard(t) {
  const { page, address, ask, check, soon } = t;
  const { id } = await ask("api/runs", "POST", { kind: "scenario", title: "By keys", toml: drive(15) });
  await ended(t, [id]);
  await page.goto(`${address}#/run/${id}/overview`);
  await page.reload();
  await page.locator('[role="tablist"]').waitFor();
  const focused = () => page.evaluate(() => document.activeElement?.id || document.activeElement?.className || document.activeElement?.tagName);
  await page.keyboard.press("Tab");
  check((await focused()) === "skip", `the first key leads past the header: ${await focused()}`);
  await page.keyboard.press("Enter");
  check((await focused()) === "content", `into the content: ${await focused()}`);
  for (let i = 0; i < 20 && !/^tab-/.test(await focused()); ++i) await page.keyboard.press("Tab");
  check((await focused()) === "tab-overview", `one tab of the list has the focus: ${await focused()}`);
  const names = await page.locator('[role="tab"]').evaluateAll((all) => all.map((e) => e.id));
  for (const name of [...names.slice(1), names[0]]) {
    await page.keyboard.press("ArrowRight");
    check((await focused()) === name, `an arrow leads to ${name}: ${await focused()}`);
    check(await soon(async () => (await page.locator(`#${name}`).getAttribute("aria-selected")) === "true"), `and opens it: ${name}`);
  }
  await page.keyboard.press("Tab");
  check((await focused()) === "view", `then into what it shows: ${await focused()}`);
  await page.keyboard.press("?");
  check(await page.locator("dialog.keys").isVisible(), "the help on keys opens");
  check(await page.evaluate(() => document.querySelector("dialog.keys").contains(document.activeElement)), "and has the focus");
  await page.keyboard.press("Escape");
  check(!(await page.locator("dialog.keys").isVisible()) && (await focused()) === "view", `Escape leads back: ${await focused()}`);
}

/** Pages that are to be overlooked do not go on for ever, on a desk. */
async function heights(t) {
  const { page, address, check } = t;
  dataset(t, "high", 16);
  await page.setViewportSize({ width: 1440, height: 900 });
  const bounds = { "": [4500, ".examples li"], "#/data/high": [5000, ".tasks"], "#/scenario?example=demo": [3000, ".form .field"] };
  for (const [path, [most, ready]] of Object.entries(bounds)) {
    await page.goto(address + path);
    await page.reload();
    await page.locator(ready).first().waitFor();
    await page.waitForTimeout(500);
    const high = await page.evaluate(() => document.documentElement.scrollHeight);
    check(high <= most, `${path || "start"} is ${high} px high, ${most} are allowed`);
    console.log(`${path || "start"}: ${high} px`);
  }
  await page.setViewportSize({ width: 1280, height: 900 });
}

export const formSteps = [drafts, again, faults, keyboard, heights];
