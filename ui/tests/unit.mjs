// Modules of the page without a browser, for tests of what they compute.
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { skip } from "./browse.mjs";

const source = join(dirname(fileURLToPath(import.meta.url)), "../src");

/** What modules of the page touch when they are loaded; `paints`: variables of the style sheet. */
export function pretend(paints = {}) {
  const kept = new Map();
  const storage = { getItem: (k) => kept.get(k) ?? null, setItem: (k, v) => kept.set(k, String(v)), removeItem: (k) => kept.delete(k) };
  Object.assign(globalThis, {
    localStorage: storage,
    sessionStorage: storage,
    document: { documentElement: { lang: "", dataset: {} } },
    getComputedStyle: () => ({ getPropertyValue: (name) => paints[name] ?? name }),
    location: { hash: "" },
    IntersectionObserver: class {},
    ResizeObserver: class {},
  });
  globalThis.window ??= globalThis;
  globalThis.navigator ??= { language: "en" };
}

/** The exports of TypeScript modules, by their names under ui/src without ending. */
export async function modules(folder, ...names) {
  let esbuild;
  try {
    esbuild = createRequire(resolve(folder, "x.js"))("esbuild");
  } catch {
    skip("there is no esbuild; scripts/build_ui.sh installs it where npm reaches a registry");
  }
  const made = mkdtempSync(join(tmpdir(), "schuler_unit_"));
  // the drawing libraries need a browser as soon as they are loaded
  const nothing = join(made, "nothing.mjs");
  writeFileSync(nothing, "export default class {}\n");
  try {
    const out = [];
    for (const name of names) {
      const file = join(made, `${name.replaceAll("/", "-")}.mjs`);
      esbuild.buildSync({ entryPoints: [join(source, `${name}.ts`)], bundle: true, format: "esm", outfile: file, nodePaths: [resolve(folder)], logLevel: "error", alias: { uplot: nothing } });
      out.push(await import(pathToFileURL(file).href));
    }
    return out;
  } finally {
    rmSync(made, { recursive: true, force: true });
  }
}
