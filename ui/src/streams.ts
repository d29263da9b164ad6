// What the server tells by itself: changes of runs, messages of a live navigation, and whether it is there at all.
import { api, type RunState } from "./api";

export interface RunEvent {
  id: string;
  state: RunState;
  progress: number;
  /** What is being done, as "reading"; empty where the program does not say. */
  stage: string;
  /** Since the process was started. */
  spent_s: number;
  message: string;
}

/** Refused: a server answers, but it was started anew and has another token. */
export type ServerState = "alive" | "gone" | "refused";
const connection = new Set<(state: ServerState) => void>();
let server: ServerState = "alive";

function connected(now: ServerState): void {
  if (now === server) return;
  server = now;
  for (const each of [...connection]) each(now);
}

/** Tells when the server stops answering, and when it answers again. */
export function watchServer(listener: (state: ServerState) => void): void {
  connection.add(listener);
  window.setInterval(() => {
    if (document.hidden && server === "alive") return;
    void fetch("/api/about", { signal: AbortSignal.timeout(6000) }).then(
      (r) => connected(r.status === 401 ? "refused" : "alive"),
      () => connected("gone"),
    );
  }, 4000);
}

interface Told {
  name: string;
  data: string;
}
/** Between tabs: an event, that the connection is lost, or the wish of a tab that came later for what was told last. */
type Passed = { kind: "event"; told: Told } | { kind: "lost" } | { kind: "ask" };

interface Wishes {
  path: string;
  names: string[];
  take: (told: Told) => void;
  /** The connection is lost; the browser tries again. */
  lost?: () => void;
  /** Under which name a tab that comes later is told it: the last of each name; null: it waits for the next one. */
  lasting?: (told: Told) => string | null;
}

const canShare = () => typeof BroadcastChannel !== "undefined" && navigator.locks !== undefined;

/**
 * A stream of events that all tabs share: a browser opens six connections to a server at most, so that one tab listens and passes on
 * what it hears. When that tab is closed another one takes its place. Returns what ends it.
 */
function share({ path, names, take, lost, lasting }: Wishes): () => void {
  const key = `schuler ${path}`;
  const channel = canShare() ? new BroadcastChannel(key) : null;
  const over = new AbortController();
  const last = new Map<string, Told>();
  let source: EventSource | null = null;
  const pass = (passed: Passed) => channel?.postMessage(passed);
  const listen = () =>
    new Promise<void>((done) => {
      const connect = () => {
        source = new EventSource(path);
        source.onerror = () => (lost?.(), pass({ kind: "lost" }));
        for (const name of names)
          source.addEventListener(name, (e) => {
            const told = { name, data: (e as MessageEvent<string>).data };
            const under = lasting?.(told);
            if (under) last.set(under, told);
            take(told);
            pass({ kind: "event", told });
          });
      };
      // the browser connects again by itself after a break, but not after a refusal
      const again = (state: ServerState) => state === "alive" && source?.readyState === EventSource.CLOSED && connect();
      connection.add(again);
      over.signal.addEventListener("abort", () => {
        connection.delete(again);
        source?.close();
        done();
      });
      if (over.signal.aborted) return done();
      connect();
    });
  if (!channel) void listen();
  else {
    channel.onmessage = ({ data }: MessageEvent<Passed>) => {
      if (data.kind === "event") take(data.told);
      else if (data.kind === "lost") lost?.();
      else if (source) last.forEach((told) => pass({ kind: "event", told }));
    };
    pass({ kind: "ask" });
    void navigator.locks.request(key, { signal: over.signal }, listen).catch(() => undefined); // ended while it waited
  }
  return () => {
    over.abort();
    channel?.close();
  };
}

type Listener = (e: RunEvent) => void;
const listeners = new Set<Listener>();
let watching = false;

function told(event: RunEvent): void {
  for (const each of [...listeners]) each(event);
}

function listenToRuns(): void {
  watching = true;
  if (canShare() || typeof BroadcastChannel === "undefined") {
    share({ path: "/api/events", names: ["run"], take: ({ data }) => told(JSON.parse(data) as RunEvent) });
    return;
  }
  // without locks (a page by plain HTTP from another machine) each tab asks now and then
  window.setInterval(() => {
    if (document.hidden || listeners.size === 0) return;
    void api.runs().then(
      (all) =>
        all
          .filter((r) => r.state === "running" || r.state === "waiting" || r.progress !== undefined)
          .forEach((r) => told({ id: r.id, state: r.state, progress: r.progress ?? 0, stage: r.stage ?? "", spent_s: r.spent_s ?? 0, message: r.message })),
      () => undefined,
    );
  }, 2000);
}

/** Tells of every change of a run at work; returns what ends that. */
export function watchRuns(listener: Listener): () => void {
  listeners.add(listener);
  if (!watching) listenToRuns();
  return () => listeners.delete(listener);
}

/** Messages of the live navigation, and of the connection to it; returns what ends that. */
export function watchLive(take: (name: string, message: Record<string, unknown>) => void, lost: () => void): () => void {
  return share({
    path: "/api/live",
    names: ["link", "live"],
    take: ({ name, data }) => take(name, JSON.parse(data) as Record<string, unknown>),
    lost,
    // states come ten times a second; health and satellites seldom
    lasting: ({ name, data }) => (name === "link" ? name : (/"type":"(health|satellites)"/.exec(data)?.[1] ?? null)),
  });
}
