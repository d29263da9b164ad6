// Every option of every form of `schuler ui` has a name and a sentence in every language of the page, every section a name.
//   node texts_test.mjs --program SCHULER --modules NODE_MODULES
// Exit status 0 passed, 1 failed, 77 skipped.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { optionsOf, serve, skip } from "./browse.mjs";

const options = optionsOf(process.argv.slice(2));
const source = join(dirname(fileURLToPath(import.meta.url)), "../src");
let esbuild;
try {
  esbuild = createRequire(resolve(options.modules, "x.js"))("esbuild");
} catch {
  skip("there is no esbuild; scripts/build_ui.sh installs it where npm reaches a registry");
}
const { code } = esbuild.transformSync(readFileSync(join(source, "labels.ts"), "utf8"), { loader: "ts", format: "esm" });
const { labelKeys, sectionOf, mainOptions } = await import(`data:text/javascript,${encodeURIComponent(code)}`);
const texts = (name) => JSON.parse(readFileSync(join(source, "messages", name), "utf8"));

let failures = 0;
const fail = (text) => {
  ++failures;
  console.error(`FAILED: ${text}`);
};
const folder = mkdtempSync(join(tmpdir(), "schuler_texts_"));
const { ask, stop } = await serve(options.program, folder);
try {
  const [scenario, dataset, commands, studies] = await Promise.all(["options?of=scenario", "options?of=dataset", "commands", "studies"].map((p) => ask(`api/${p}`)));
  const all = [...scenario, ...dataset, ...[...commands, ...studies].flatMap((c) => c.options)];
  if (all.length < 500) fail(`only ${all.length} options`);
  for (const language of ["uk", "ru"]) {
    const [names, helps] = [texts(`${language}.json`), texts(`help.${language}.json`)];
    for (const key of new Set(all.map((o) => o.key))) {
      if (!labelKeys(key).some((k) => names[k])) fail(`${language}: ${key} has no name (${labelKeys(key).join(" or ")})`);
      if (sectionOf(key) !== "general" && [...scenario, ...dataset].some((o) => o.key === key) && !names[`section.${sectionOf(key)}`]) fail(`${language}: the section of ${key} has no name`);
    }
    const used = new Set();
    for (const help of new Set(all.map((o) => o.help))) {
      const at = help.indexOf(": ");
      const parts = helps[help] ? [help] : [help.slice(0, at), help.slice(at + 2)];
      if (parts.every((p) => helps[p])) parts.forEach((p) => used.add(p));
      else fail(`${language}: no translation of "${help}"`);
    }
    for (const help of Object.keys(helps)) if (!used.has(help)) fail(`${language}: no option says "${help}"`);
    for (const { command } of studies) if (!names[`study.${command.replace("analyze ", "")}`]) fail(`${language}: no purpose of ${command}`);
  }
  for (const [of, keys] of [["scenario", scenario], ["dataset", dataset]])
    for (const key of mainOptions[of]) if (!keys.some((o) => o.key === key)) fail(`${key} is no option of a ${of}`);
} finally {
  await stop();
  rmSync(folder, { recursive: true, force: true });
}
console.log(`texts: ${failures} failures`);
process.exit(failures ? 1 : 0);
