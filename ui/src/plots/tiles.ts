// Tiles of a map (`schuler ui --tiles`) under a track: Web Mercator squares, drawn where the plane of the track has their corners.
import { api } from "../api";
import { metresOf, radius, type Plane } from "./graticule";

const largest = 200;
let zooms: Promise<number[]> | null = null;

/** Asked for once: which zooms there are; none without a folder of tiles. */
export function tileZooms(): Promise<number[]> {
  return (zooms ??= api.about().then(
    (a) => a.tiles,
    () => [],
  ));
}

export class TileLayer {
  private readonly images = new Map<string, ImageBitmap | null>();

  constructor(
    private readonly zooms: number[],
    private readonly plane: Plane,
    private readonly arrived: () => void,
  ) {}

  /** How many tiles are there to be drawn. */
  get drawn(): number {
    return [...this.images.values()].filter((i) => i !== null).length;
  }

  private image(z: number, x: number, y: number): ImageBitmap | null {
    const key = `${z}/${x}/${y}`;
    const known = this.images.get(key);
    if (known !== undefined) return known;
    if (this.images.size > 4 * largest) this.images.clear();
    this.images.set(key, null);
    void fetch(`/api/tiles/${key}`).then(async (r) => {
      if (r.status !== 200) return;
      this.images.set(key, await createImageBitmap(await r.blob()));
      this.arrived();
    }).catch(() => undefined);
    return null;
  }

  /** `place`: metres east and north to the canvas; `scale`: pixels a metre; the bounds in metres. */
  draw(g: CanvasRenderingContext2D, scale: number, place: (east: number, north: number) => [number, number], [west, east, south, north]: [number, number, number, number]): void {
    const m = metresOf(this.plane);
    const lat = (n: number) => this.plane.lat + ((n / m.north) * 180) / Math.PI,
      lon = (e: number) => this.plane.lon + ((e / m.east) * 180) / Math.PI;
    // a tile of 256 pixels is drawn at about its size; of the zooms that there are the nearest below
    const wanted = Math.log2((2 * Math.PI * radius * Math.cos((this.plane.lat * Math.PI) / 180) * scale) / 256) + 0.3;
    const z = this.zooms.filter((x) => x <= wanted).at(-1) ?? this.zooms[0];
    if (z === undefined) return;
    const n = 2 ** z;
    const column = (degrees: number) => ((degrees + 180) / 360) * n;
    const row = (degrees: number) => {
      const s = Math.sin((Math.max(-85.05, Math.min(85.05, degrees)) * Math.PI) / 180);
      return (0.5 - Math.log((1 + s) / (1 - s)) / (4 * Math.PI)) * n;
    };
    const rowLat = (y: number) => (Math.atan(Math.sinh(Math.PI * (1 - (2 * y) / n))) * 180) / Math.PI;
    const [x0, x1, y0, y1] = [column(lon(west)), column(lon(east)), row(lat(north)), row(lat(south))].map(Math.floor) as [number, number, number, number];
    if ((x1 - x0 + 1) * (y1 - y0 + 1) > largest) return;
    const at = (x: number, y: number) => place((((x / n) * 360 - 180 - this.plane.lon) * Math.PI * m.east) / 180, ((rowLat(y) - this.plane.lat) * Math.PI * m.north) / 180);
    g.globalAlpha = 0.75;
    for (let x = x0; x <= x1; ++x)
      for (let y = Math.max(0, y0); y <= Math.min(n - 1, y1); ++y) {
        const image = this.image(z, ((x % n) + n) % n, y);
        if (!image) continue;
        const [a, b] = at(x, y),
          [c, d] = at(x + 1, y + 1);
        g.drawImage(image, a, b, c - a + 0.5, d - b + 0.5);
      }
    g.globalAlpha = 1;
  }
}
