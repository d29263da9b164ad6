// Lines of latitude and longitude under a track, with labels at round steps.
import { language } from "../i18n";

/** Equatorial, m. */
export const radius = 6378137;
const flat = 0.00669437999014; // first eccentricity squared

/** Where on the Earth the point 0, 0 of a plane lies, degrees. */
export interface Plane {
  lat: number;
  lon: number;
}

/** Metres of a radian northward and eastward at a latitude. */
export function metresOf({ lat }: Plane): { north: number; east: number } {
  const phi = (lat * Math.PI) / 180,
    w = Math.sqrt(1 - flat * Math.sin(phi) ** 2);
  return { north: (radius * (1 - flat)) / w ** 3, east: (radius / w) * Math.cos(phi) };
}

/** Steps in seconds of arc: round in degrees, minutes and seconds. */
const steps = [
  ...[-4, -3, -2, -1].flatMap((p) => [1, 2, 5].map((m) => m * 10 ** p)),
  ...[1, 2, 5, 10, 15, 30],
  ...[1, 2, 5, 10, 15, 30].map((m) => 60 * m),
  ...[1, 2, 5, 10, 15, 30, 45, 90].map((d) => 3600 * d),
];

/** The smallest round step, in seconds of arc, of at least `least`. */
export function roundStep(least: number): number {
  return steps.find((s) => s >= least * (1 - 1e-9)) ?? steps.at(-1)!;
}

/** Of a line at `n` steps: 49°59′30″N; as many parts as the step needs. */
export function degreesOf(n: number, step: number, positive: string, negative: string): string {
  const digits = step < 1 ? Math.ceil(-Math.log10(step) - 1e-9) : 0;
  const unit = 10 ** digits;
  const whole = Math.round(Math.abs(n * step) * unit);
  const d = Math.floor(whole / (3600 * unit)),
    m = Math.floor(whole / (60 * unit)) % 60,
    s = (whole % (60 * unit)) / unit;
  const seconds = s.toFixed(digits).padStart(digits > 0 ? 3 + digits : 2, "0");
  const text = step % 3600 === 0 ? `${d}°` : step % 60 === 0 ? `${d}°${String(m).padStart(2, "0")}′` : `${d}°${String(m).padStart(2, "0")}′${language === "en" ? seconds : seconds.replace(".", ",")}″`;
  return `${text}${whole === 0 ? "" : n > 0 ? positive : negative}`;
}

export interface Line {
  /** Metres east (of a meridian) or north (of a parallel) in the plane. */
  at: number;
  label: string;
}

/** Lines inside the bounds of a plane, at least `apart` metres from each other; none at the poles. */
export function graticule(plane: Plane, [west, east, south, north]: [number, number, number, number], apart: number): { meridians: Line[]; parallels: Line[] } {
  const m = metresOf(plane);
  if (!(Math.abs(plane.lat) < 89.9) || !(apart > 0)) return { meridians: [], parallels: [] };
  const lines = (low: number, high: number, origin: number, metres: number, label: (n: number, step: number) => string, limit: number): Line[] => {
    const arc = (x: number) => ((x / metres) * 180 * 3600) / Math.PI; // metres to seconds of arc
    const step = roundStep(arc(apart)),
      zero = origin * 3600;
    const out: Line[] = [];
    for (let n = Math.ceil((zero + arc(low)) / step); n * step <= zero + arc(high) && out.length < 100; ++n)
      if (Math.abs(n * step) <= limit) out.push({ at: (((n * step - zero) / 3600) * Math.PI * metres) / 180, label: label(n, step) });
    return out;
  };
  const turn = 360 * 3600;
  return {
    // beyond the date line the other count goes on
    meridians: lines(west, east, plane.lon, m.east, (n, step) => degreesOf(Math.round(((((n * step + turn / 2) % turn) + turn) % turn) / step - turn / 2 / step), step, "E", "W"), Infinity),
    parallels: lines(south, north, plane.lat, m.north, (n, step) => degreesOf(n, step, "N", "S"), 90 * 3600),
  };
}
