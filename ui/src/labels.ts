// Names of options: of the key itself, or of its words without section and unit.
const units = /_(deg_sqrt_h|m_s_sqrt_h|ug_sqrt_hz|rad_s|deg_h|deg_s|m_s2|m_s|time_s|arcsec|ppm|deg|rad|hz|mg|ug|pa|ut|mgal|m|s)$/;

const deepSections = [
  "filter.assumed",
  "filter.initial_error",
  "filter.separate",
  "filter.integrity",
  "trajectory.start",
  "trajectory.vibration",
  "trajectory.waves",
];

export function sectionOf(key: string): string {
  const deep = deepSections.find((s) => key.startsWith(s + "."));
  return deep ?? (key.includes(".") ? key.slice(0, key.indexOf(".")) : "general");
}

/** "imu.gyro_noise_deg_sqrt_h" to "gyro noise". */
export function wordsOf(key: string): string {
  const section = sectionOf(key);
  const last = section === "general" ? key : key.slice(section.length + 1).replaceAll(".", " ");
  return last
    .replace(/_time_s$/, "_time")
    .replace(units, "")
    .replaceAll("_", " ");
}

/** Where a language may have the name of an option, the more particular first. */
export function labelKeys(key: string): [string, string] {
  return [`key.${key}`, `label.${wordsOf(key)}`];
}

/** The options that most users set, in the order in which a form has them first. */
export const mainOptions = {
  scenario: [
    "duration_s",
    "seed",
    "trajectory.type",
    "trajectory.speed_m_s",
    "vehicle.kind",
    "imu.grade",
    "imu.rate_hz",
    "gnss.receiver",
    "gnss.rate_hz",
    "filter.scheme",
  ],
  dataset: [
    "vehicle.kind",
    "imu.grade",
    "imu.axes",
    "imu.mounting_deg",
    "gnss.lever_arm_m",
    "gnss.latency_s",
    "initial.heading_deg",
    "filter.scheme",
    "filter.smooth",
    "filter.backward",
  ],
};
