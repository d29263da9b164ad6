// Requests that are begun before the scripts of the page are there (first.ts), and taken once by who would make them.
declare global {
  interface Window {
    schulerBegun?: Map<string, Promise<Response>>;
  }
}

/** The scripts that a page of this kind needs besides the first one (names of vite.config.ts), and what it asks for at once. */
export function needs(kind: string, name: string): { scripts: string[]; requests: string[] } {
  if (kind === "") return { scripts: ["start"], requests: ["/api/examples", "/api/datasets", "/api/runs"] };
  if (kind === "run" && name !== "") return { scripts: ["plots", "run"], requests: [runRequest(name)] };
  return { scripts: [], requests: [] };
}

/** A run with the columns that it has. */
export function runRequest(id: string): string {
  return `/api/runs/${encodeURIComponent(id)}?channels=1`;
}

/** The parts of the address after its "#": what kind of page, of what, and the rest. */
export function route(hash: string): { kind: string; rest: string[]; parameters: URLSearchParams } {
  const [path = "", query = ""] = hash.replace(/^#\/?/, "").split("?");
  const [kind = "", ...rest] = path.split("/").map(decodeURIComponent);
  return { kind, rest, parameters: new URLSearchParams(query) };
}

export function begin(path: string): void {
  const answer = fetch(path);
  answer.catch(() => undefined); // who takes it is told
  (window.schulerBegun ??= new Map()).set(path, answer);
}

export function taken(path: string): Promise<Response> | undefined {
  const answer = window.schulerBegun?.get(path);
  window.schulerBegun?.delete(path);
  return answer;
}

/** What nobody has taken for the first page is too old for the next. */
export function forget(): void {
  window.schulerBegun?.clear();
}
