// Steps of page_test.mjs about forms: what is typed is kept until it is run, what is wrong is told, a run is repeated with its own settings.
import { mkdirSync, symlinkSync, writeFileSync } from "node:fs";
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
  check((await start.getAttribute("title")).length > 10 && /Not possible/.test(await page.locator(".note:not([hidden])").first().innerText()), `with the reason: ${await start.getAttribute("title")}`);

  await page.evaluate(() => sessionStorage.clear());

  // there and back again
  const away = async (at, change, see) => {
    await page.goto(`${address}${at}`);
    await start.waitFor();
    await change();
    await page.waitForTimeout(100);
    await page.goto(`${address}#/`);
    await page.locator(".examples li").first().waitFor();
    await page.goBack();
    await start.waitFor();
    await see();
    check((await page.locator(".restored").count()) === 1, `${at}: that a draft was taken up is told`);
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
      await page.locator(".tasks summary").click();
      await rate.fill("3");
    },
    async () => check((await page.locator(".batch-sets input:checked").count()) === 1 && (await page.locator('.batch-sets input[value="kept-b"]').isChecked()) && (await rate.inputValue()) === "3", "so are the choice of a batch and its options"),
  );
  const speed = page.locator("#option-speed");
  await away(`#/studies/${encodeURIComponent("analyze equator")}`, async () => speed.fill("612"), async () => check((await speed.inputValue()) === "612", "so is a study"));
}

export const formSteps = [drafts];
