// Steps of page_test.mjs about maps: lines of latitude and longitude, tiles of a folder.
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { deflateSync } from "node:zlib";
import { serve } from "./browse.mjs";
import { drive, ended } from "./page_work.mjs";

/** A PNG of one pixel. */
function pixel(...rgb) {
  const crc = (bytes) => {
    let c = ~0;
    for (const b of bytes) for (let k = 0, x = (c ^= b); k < 8; ++k) c = x = x & 1 ? (x >>> 1) ^ 0xedb88320 : x >>> 1;
    return ~c >>> 0;
  };
  const chunk = (name, data) => {
    const body = Buffer.concat([Buffer.from(name), data]),
      out = Buffer.alloc(body.length + 8);
    out.writeUInt32BE(data.length, 0), body.copy(out, 4), out.writeUInt32BE(crc(body), body.length + 4);
    return out;
  };
  const head = Buffer.from([0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
  return Buffer.concat([Buffer.from("89504e470d0a1a0a", "hex"), chunk("IHDR", head), chunk("IDAT", deflateSync(Buffer.from([0, ...rgb]))), chunk("IEND", Buffer.alloc(0))]);
}

/** Lines of latitude and longitude lie under a track, at round steps and where a table of the ellipsoid has them. */
export async function graticule(t) {
  const { page, address, ask, check, soon, options } = t;
  const { id } = await ask("api/runs", "POST", { kind: "scenario", title: "Lines", toml: drive(6) });
  await ended(t, [id]);
  await page.goto(`${address}#/run/${id}/overview`);
  await page.locator(`.run[data-run="${id}"] .plan-canvas`).waitFor();
  const drawn = (scale) =>
    page.evaluate((scale) => {
      const { plan } = document.querySelector(".run figure.plan");
      plan.centre = { east: 0, north: 0 };
      plan.scale = scale;
      plan.fitted = true;
      plan.draw();
      return plan.lines;
    }, scale);
  check(await soon(async () => /″/.test((await drawn(1)).parallels[0]?.label ?? "")), "lines of degrees");
  const { parallels, meridians } = await drawn(1);
  const line = (all, label) => all.find((l) => l.label === label)?.at ?? NaN;
  const near = (x, y, by) => Math.abs(x - y) < by;
  // the drive begins at 50 deg north, 8 deg east; there a degree has 111 229 m northward and 71 696 m eastward
  check(near(line(parallels, "50°00′00″N"), 0, 3) && near(line(meridians, "8°00′00″E"), 0, 3), `the start lies on them: ${JSON.stringify([parallels, meridians])}`);
  check(near(line(parallels, "50°00′05″N") - line(parallels, "49°59′55″N"), (2 * 5 * 111229) / 3600, 0.1), `parallels: ${JSON.stringify(parallels)}`);
  check(near(line(meridians, "8°00′10″E") - line(meridians, "7°59′50″E"), (2 * 10 * 71696) / 3600, 0.1), `meridians: ${JSON.stringify(meridians)}`);
  const shapes = [[0.01, /^\d+°\d\d′[NE]$/], [0.001, /^\d+°(\d\d′)?[NE]$/], [100, /^\d+°\d\d′\d\d\.\d{1,2}″[NE]$/], [1e-5, /^-?\d+$/]];
  for (const [scale, shape] of shapes) {
    for (const all of Object.values(await drawn(scale)).map((lines) => lines.map((l) => l.label)))
      check(all.length > 1 && all.length < 30 && all.every((x) => shape.test(x)) && new Set(all).size === all.length, `lines at ${scale} pixels a metre: ${all}`);
  }
  const beyond = await page.evaluate(() => {
    const { plan } = document.querySelector(".run figure.plan");
    const of = (plane, scale) => ((plan.plane = plane), (plan.scale = scale), plan.draw(), Object.values(plan.lines).map((all) => all.map((l) => l.label)));
    return [of({ lat: -0.001, lon: 179.999 }, 0.5), of({ lat: 89.99, lon: 0 }, 1)];
  });
  check(beyond[0][0].includes("180°00′00″W") || beyond[0][0].includes("180°00′00″E"), `the date line: ${beyond[0][0]}`);
  check(beyond[0][0].some((x) => /^179°59′\d\d″W$/.test(x)) && beyond[0][0].some((x) => /^179°59′\d\d″E$/.test(x)), `and beyond: ${beyond[0][0]}`);
  check(beyond[0][1].includes("0°00′00″") && beyond[0][1].some((x) => /S$/.test(x)) && beyond[0][1].some((x) => /N$/.test(x)), `the equator: ${beyond[0][1]}`);
  check(beyond[1].flat().length === 0, `none at the pole: ${beyond[1]}`);
  await page.reload();
  await page.locator(`.run[data-run="${id}"] .plan-canvas`).waitFor();
  await page.waitForTimeout(600);
  if (options.shots) await page.locator("figure.plan").screenshot({ path: join(options.shots, "ui-graticule.png") });
}

/** Tiles of a folder lie under the track where they belong: the edge of two of them is 140 m west of the start at 8 degrees east. */
export async function tiles(t) {
  const { page, check, options } = t;
  const folder = mkdtempSync(join(tmpdir(), "schuler_tiles_"));
  for (let x = 8553; x < 8560; ++x)
    for (let y = 5545; y < 5560; ++y) {
      mkdirSync(join(folder, "tiles", "14", String(x)), { recursive: true });
      writeFileSync(join(folder, "tiles", "14", String(x), `${y}.png`), x < 8556 ? pixel(0, 0, 255) : pixel(255, 0, 0));
    }
  const server = await serve(options.program, folder, ["--tiles", join(folder, "tiles")]);
  const tab = await page.context().newPage();
  const complaints = [];
  tab.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  try {
    await tab.goto(server.entrance);
    const { id } = await server.ask("api/runs", "POST", { kind: "scenario", title: "Over a map", toml: drive(5) });
    await ended({ ask: server.ask, page }, [id]);
    await tab.goto(`${server.address}#/run/${id}/overview`);
    await tab.locator(".plan-canvas").waitFor();
    const seen = () =>
      tab.evaluate(() => {
        const { plan } = document.querySelector("figure.plan"),
          { canvas } = plan;
        const at = (east, north) => [...canvas.getContext("2d").getImageData(...plan.place(east, north).map((v) => Math.round(v * devicePixelRatio)), 1, 1).data];
        const edge = -((8 - ((8556 / 16384) * 360 - 180)) * Math.PI / 180) * 6378137 / Math.sqrt(1 - 0.00669437999014 * Math.sin(50 * Math.PI / 180) ** 2) * Math.cos(50 * Math.PI / 180);
        plan.centre = { east: edge, north: 40 };   // the edge of the tiles in the middle
        plan.scale = 1;
        plan.fitted = true;
        plan.paint();
        return { drawn: plan.tiles?.drawn ?? 0, edge, west: at(edge - 6, 60), east: at(edge + 6, 60) };
      });
    const right = ({ drawn, west, east }) => drawn >= 2 && west[2] > west[0] + 80 && east[0] > east[2] + 80;
    for (let i = 0; i < 50 && !right(await seen()); ++i) await tab.waitForTimeout(100);
    const last = await seen(),
      { drawn, edge, west, east } = last;
    check(right(last), `the map lies under the track: ${drawn} tiles, the edge ${edge} m, west of it ${west}, east ${east}`);
    check(complaints.length === 0, `a tile that is not there is no fault: ${complaints}`);
    const outside = await fetch(`${server.address}api/tiles/14/../x`, { headers: { Authorization: `Bearer ${server.token}` } });
    check(outside.status >= 400, `names that are no numbers: ${outside.status}`);
    if (options.shots) await tab.screenshot({ path: join(options.shots, "ui-tiles.png") });
  } finally {
    await tab.close();
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
}
