// What the page computes by itself: exports, derived signals, grids of outages. No browser, no program.
//   node unit_test.mjs --modules NODE_MODULES
// Exit status 0 passed, 1 failed, 77 skipped.
import { optionsOf } from "./browse.mjs";
import { modules, pretend } from "./unit.mjs";

const options = optionsOf(process.argv.slice(2));
let failures = 0;
const check = (condition, text) => {
  if (condition) return;
  ++failures;
  console.error(`FAILED: ${text}`);
};
pretend({ "--ink-1": "#000001", "--ink-2": "#000002", "--ink-3": "#000003", "--rejected": "#ff0000", "--excluded": "#00ff00" });

/** CSV, SVG and PNG have the colours, axes and units of the plot. */
async function exports_() {
  const [{ csvOf, shownLines }, { svgOf }, { innovationLines }] = await modules(options.modules, "plots/exports", "plots/svg", "pages/views");
  const settings = {
    title: "t",
    unit: "m",
    rightUnit: "m/s",
    lines: [{ label: "a" }, { label: "r", paint: "--rejected", dots: true }, { label: "b", right: true }],
    load: null,
  };
  const data = { x: [0, 10], y: [[0, 1], [null, 1], [100, 200]] };
  const rows = csvOf(settings, data).split("\n");
  check(rows[0] === "time_s,a (m),r (m),b (m/s)", `each column of the CSV has the unit of its axis: ${rows[0]}`);
  check(rows[2] === "10,1,1,200", `and its numbers: ${rows[2]}`);
  const lines = shownLines(settings, new Set([0]));
  check(lines[1].colour === "#ff0000" && lines[0].hidden && lines[2].right, `lines in the colours of the plot: ${JSON.stringify(lines)}`);
  const chart = { data: [data.x, ...data.y], scales: { x: { min: 0, max: 10 }, y: { min: 0, max: 1 }, y2: { min: 100, max: 200 } } };
  const svg = svgOf(chart, { title: "t", unit: "m", rightUnit: "m/s", along: "time, s" }, shownLines(settings, new Set()), null, []);
  const drawn = [...svg.matchAll(/<path d="(M[^"]+)" stroke="(#[0-9a-f]+)" stroke-width="1.4"/g)];
  check(drawn.length === 2 && drawn[0][1] === drawn[1][1], `a line on the right axis has the scale of that axis: ${drawn.map((d) => d[1])}`);
  check(/<circle[^>]*fill="#ff0000"/.test(svg), "rejected ones have their own colour in the SVG");
  check(svg.includes(">m/s</text>") && svg.includes(">200</text>"), "the right axis has its numbers and its unit");

  const parts = innovationLines([1, 2, 3, 4], [1, 1, 1, 1], [0, 1, 2, 3]);
  check(JSON.stringify(parts.slice(0, 3)) === "[[1,null,null,null],[null,2,null,null],[null,null,null,4]]", `accepted, rejected, excluded: ${JSON.stringify(parts)}`);
  check(JSON.stringify(parts[3]) === "[3,3,null,3]", `the band leaves out what is withheld: ${JSON.stringify(parts[3])}`);
}

for (const step of [exports_])
  try {
    await step();
  } catch (e) {
    check(false, `${step.name}: ${e.stack ?? e}`);
  }
console.log(`unit: ${failures} failures`);
process.exit(failures ? 1 : 0);
