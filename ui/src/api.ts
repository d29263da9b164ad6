// The server's interface, as /api/openapi.json documents it.
import { runRequest, taken } from "./begun";
import { t } from "./i18n";
import { said } from "./reasons";

export interface Problem {
  text: string;
  mend: string;
  key: string;
  line: number;
}

export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Problem,
  ) {
    const place = [problem.line > 0 ? `line ${problem.line}` : "", problem.key].filter(Boolean).join(", ");
    super(said((place ? `${place}: ` : "") + problem.text + (problem.mend ? `; ${problem.mend}` : "")));
  }
}

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Settings = Record<string, Json>;

export interface Option {
  key: string;
  shape: "number" | "integer" | "flag" | "text" | "numbers" | "texts" | "table" | "tables" | "any";
  length: number;
  low: number | null;
  high: number | null;
  choices: string[];
  accepts: string;
  help: string;
  unit: string;
  /** Where it has an effect; empty: everywhere. */
  applies?: string;
  /** Nothing can be computed without it. */
  required?: boolean;
  default: Json;
}

export interface CommandForm {
  command: string;
  purpose: string;
  examples: string;
  options: Option[];
  /** Of a study: what it works on, or null. */
  input?: string | null;
  /** Which of these that may be; a recording of signals is made by another study. */
  accepts?: ("scenario" | "dataset" | "recording")[];
  optional_input?: boolean;
}

export interface PaperItem {
  item: string;
  what: string;
  page: string;
  printed_numbers: number;
  runs: number;
  seconds: number;
}

export interface Track {
  time_s: number[];
  north_m: number[];
  east_m: number[];
  up_m: number[];
  height_m: number[];
  speed_m_s: number[];
  roll_deg: number[];
  pitch_deg: number[];
  heading_deg: number[];
  cut: boolean;
}

export interface Understood {
  settings: Settings;
  used: Settings;
  toml: string;
  problem: Problem | null;
  track?: Track;
  kind?: "scenario" | "dataset";
}

export type RunState = "waiting" | "running" | "done" | "failed" | "cancelled";

export interface Run {
  id: string;
  title: string;
  kind: string;
  state: RunState;
  message: string;
  created: number;
  dataset: string | null;
  scheme: string | null;
  duration_s: number | null;
  error_m: number | null;
  reference: string | null;
  /** The batch that it belongs to. */
  batch: string | null;
  note: string;
  verdict: string | null;
  progress?: number;
  stage?: string;
  spent_s?: number;
  /** Of a study. */
  command?: string | null;
  /** As it was ordered. */
  order?: { command: string; runs: number; arguments: Settings } | null;
}

export interface Spread {
  rms: number | null;
  p95: number | null;
  max: number | null;
}

export interface Summary {
  name: string;
  scheme: string | null;
  mechanization: string | null;
  smoothed: boolean | null;
  duration_s: number | null;
  settled_after_s: number | null;
  reference: string | null;
  imu: { epochs: number; rate_hz: number; gaps: number } | null;
  gnss: { epochs: number; accepted: number; rejected: number } | null;
  errors: Record<string, Record<string, Spread> | null> | null;
  outages: Outage[] | null;
  outages_forward?: Outage[] | null;
  verdict?: { word: string; reasons: string[] } | null;
  self_check?: Record<string, unknown> | null;
  separation?: Record<string, unknown> | null;
  events?: unknown;
  /** Epochs of carrier phase against a base, by what their ambiguities are. */
  carrier?: { epochs: number; fixed: number; float: number; single: number } | null;
  /** What each source was doing, in order of source and time. */
  health?: Health[] | null;
  integrity?: { alerts: { time_s: number; channel: string; test: string; size: number | null }[] } | null;
  findings?: Record<string, unknown> | null;
  facts?: Fact[] | null;
  ignored?: unknown[];
  command?: string;
  schemes?: Record<string, unknown>[];
  consistency: Record<string, unknown> | null;
  /** Of `schuler gravity`. */
  gravity?: Record<string, unknown>;
  /** Of a campaign. */
  montecarlo?: { runs: number; failed: number; runs_per_s: number | null };
  timing: Record<string, number> | null;
  warnings: string[];
}

export interface Outage {
  start_s: number;
  duration_s: number;
  end_horizontal_m: number | null;
  max_horizontal_m: number | null;
  end_vertical_m: number | null;
  max_3d_m: number | null;
  inside_3sigma: boolean | null;
}

export interface Health {
  source: string;
  state: string;
  from_s: number;
  to_s: number;
  samples: number;
  used: number;
}

/** A setting and how it is known. */
export interface Fact {
  key: string;
  value: Json;
  unit: string | null;
  how: string;
  sigma: number | null;
  from_s: number | null;
  to_s: number | null;
  note: string | null;
}

export interface RunDetails extends Run {
  summary: Summary | null;
  files: string[];
}

export interface Column {
  id: string;
  name: string;
  unit: string;
  /** What its numbers stand for, where that is a list of names. */
  names?: string[];
}

export interface Group {
  group: string;
  rows: number;
  start_s: number | null;
  stop_s: number | null;
  columns: Column[];
}

export interface Series {
  rows: number;
  thinned: boolean;
  time_s: number[];
  columns: Record<string, (number | null)[]>;
  units: Record<string, string>;
}

/** Columns of a log before anything is processed. */
export interface Raw {
  rows: number;
  thinned: boolean;
  /** The first time as written, s, and the name of its column; `time_s` counts from there. */
  zero: number;
  time: string;
  time_s: (number | null)[];
  columns: Record<string, (number | null)[]>;
  units: Record<string, string>;
}

export interface Figure {
  value: number | null;
  unit: string;
}

export interface AxisNoise {
  sensor: "gyro" | "accel";
  axis: string;
  unit: string;
  density_unit: string;
  quantization: Figure;
  white: Figure;
  bias_instability: Figure;
  random_walk: Figure;
  ramp: Figure;
  allan: { tau_s: number[]; deviation: number[]; relative_sigma: number[] };
  spectrum: { frequency_hz: number[]; density: number[] };
}

export interface Noise {
  name: string;
  rate_hz: number;
  duration_s: number;
  gaps: number;
  axes: AxisNoise[];
}

export interface DatasetInfo {
  name: string;
  title: string;
  opened: boolean;
  files: { name: string; bytes: number }[];
}

export interface FileProblem {
  level: "info" | "warning" | "error";
  text: string;
  mend: string;
}

/** What a log offers to the tasks, other than its kind. */
export type Provided = "imu" | "fixes" | "ranges" | "ephemerides" | "orbits";

export interface Inspection {
  path: string;
  files: {
    path: string;
    kind: string;
    provides: Provided[];
    columns: string[];
    rows: number;
    rate_hz: number | null;
    gaps: number;
    duplicates: number;
    start_s: number | null;
    stop_s: number | null;
    problems: FileProblem[];
  }[];
  findings: { key: string; value: string; confidence: number; why: string }[];
  problems: FileProblem[];
  dataset_toml: string;
  own_toml: boolean;
  form: Understood;
}

async function reply(response: Response): Promise<Response> {
  if (response.ok) return response;
  let problem: Problem = { text: `${response.status} ${response.statusText}`, mend: "", key: "", line: 0 };
  try {
    problem = ((await response.json()) as { error: Problem }).error;
  } catch {
    // no JSON: the status says it
  }
  throw new ApiError(response.status, problem);
}

async function get<T>(path: string, signal?: AbortSignal): Promise<T> {
  return (await reply(await (taken(path) ?? fetch(path, signal ? { signal } : {})))).json() as Promise<T>;
}

async function send<T>(method: string, path: string, body?: unknown, signal?: AbortSignal): Promise<T> {
  const init: RequestInit = { method, headers: { "Content-Type": "application/json" } };
  if (body !== undefined) init.body = JSON.stringify(body);
  if (signal) init.signal = signal;
  return (await reply(await fetch(path, init))).json() as Promise<T>;
}

const id = encodeURIComponent;

export interface Range {
  from?: number | undefined;
  to?: number | undefined;
  points?: number | undefined;
}

function ranged(query: URLSearchParams, range: Range): string {
  for (const name of ["from", "to", "points"] as const) {
    const value = range[name];
    if (value !== undefined) query.set(name, String(value));
  }
  return query.toString();
}

export const api = {
  about: () => get<{ version: string; max_upload: number; confined: boolean; opened: string | null; live: string | null; tiles: number[] }>("/api/about"),
  options: (of: "scenario" | "dataset") => get<Option[]>(`/api/options?of=${of}`),
  examples: () => get<{ name: string; about: string; toml: string }[]>("/api/examples"),
  settings: (of: "scenario" | "dataset", body: { settings: Settings } | { toml: string }, signal?: AbortSignal) =>
    send<Understood>("POST", `/api/settings?of=${of}`, body, signal),
  datasets: () => get<DatasetInfo[]>("/api/datasets"),
  newDataset: (title: string) => send<{ name: string }>("POST", "/api/datasets", { title }),
  removeDataset: (name: string) => send<object>("DELETE", `/api/datasets/${id(name)}`),
  inspect: (name: string) => get<Inspection>(`/api/datasets/${id(name)}/inspect`),
  runs: () => get<Run[]>("/api/runs"),
  run: (run: string) => get<RunDetails>(`/api/runs/${id(run)}`),
  runWithChannels: (run: string) => get<RunDetails & { channels: Group[] }>(runRequest(run)),
  start: (order: Record<string, unknown>) => send<Run>("POST", "/api/runs", order),
  startBatch: (order: Record<string, unknown>) => send<{ batch: string; runs: string[] }>("POST", "/api/batches", order),
  annotate: (run: string, note: string) => send<Run>("PATCH", `/api/runs/${id(run)}`, { note }),
  rename: (run: string, title: string) => send<Run>("PATCH", `/api/runs/${id(run)}`, { title }),
  remove: (run: string) => send<object>("DELETE", `/api/runs/${id(run)}`),
  cancel: (run: string) => send<object>("POST", `/api/runs/${id(run)}/cancel`),
  runSettings: (run: string) => get<Understood>(`/api/runs/${id(run)}/settings`),
  log: async (run: string) => (await reply(await fetch(`/api/runs/${id(run)}/log`))).text(),
  channels: (run: string) => get<Group[]>(`/api/runs/${id(run)}/channels`),
  series: (run: string, columns: string[], range: Range = {}, origin?: string, signal?: AbortSignal) => {
    const query = new URLSearchParams({ columns: columns.join(",") });
    if (origin) query.set("origin", origin);
    return get<Series>(`/api/runs/${id(run)}/series?${ranged(query, range)}`, signal);
  },
  difference: (run: string, other: string, range: Range = {}, signal?: AbortSignal) =>
    get<Series>(`/api/runs/${id(run)}/difference?${ranged(new URLSearchParams({ with: other }), range)}`, signal),
  raw: (name: string, file: string, range: Range = {}, signal?: AbortSignal) =>
    get<Raw>(`/api/datasets/${id(name)}/raw?${ranged(new URLSearchParams({ file }), range)}`, signal),
  commands: () => get<CommandForm[]>("/api/commands"),
  studies: () => get<CommandForm[]>("/api/studies"),
  papers: () => get<{ paper: string; items: PaperItem[] }[]>("/api/papers"),
  startStudy: (order: Record<string, unknown>) => send<Run>("POST", "/api/studies", order),
  layouts: async () => (await get<Record<string, unknown> | null>("/api/layouts")) ?? {},
  keepLayouts: (all: Record<string, unknown>) => send<object>("PUT", "/api/layouts", all),
  noise: (of: "runs" | "datasets", name: string) => get<Noise>(`/api/${of}/${id(name)}/noise`),
  fileText: async (run: string, file: string) => (await reply(await fetch(`/api/runs/${id(run)}/files/${id(file)}`))).text(),
  fileUrl: (run: string, file: string, save = false) => `/api/runs/${id(run)}/files/${id(file)}${save ? "?save=1" : ""}`,
};

/** Sends a file as it is; `progress` from 0 to 1. */
export function upload(dataset: string, file: File, path: string, progress: (part: number) => void): Promise<void> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("PUT", `/api/datasets/${id(dataset)}/files/${path.split("/").map(id).join("/")}`);
    request.upload.onprogress = (e) => progress(e.total > 0 ? e.loaded / e.total : 0);
    request.onload = () => {
      if (request.status < 300) return resolve();
      let problem: Problem = { text: `${request.status} ${request.statusText}`, mend: "", key: "", line: 0 };
      try {
        problem = (JSON.parse(request.responseText) as { error: Problem }).error;
      } catch {
        // no JSON: the status says it
      }
      reject(new ApiError(request.status, problem));
    };
    request.onerror = () => reject(new Error(t("server.silent")));
    request.send(file);
  });
}
