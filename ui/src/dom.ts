import { t } from "./i18n";

// Elements in few words. Text is always set as text: nothing of a file or a server becomes markup.
export type Child = Node | string | number | null | undefined | false;
type Properties = Record<string, unknown>;

/** An element; properties that begin with "on" are listeners, those the DOM knows are set, others (`class`, `data-…`) attributes. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties | null = null,
  ...children: (Child | Child[])[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2).toLowerCase(), value as EventListener);
    else if (name in node && !name.startsWith("aria")) (node as unknown as Properties)[name] = value;
    else node.setAttribute(name, value === true ? "" : String(value));
  }
  append(node, ...children);
  return node;
}

export function append(node: Element, ...children: (Child | Child[])[]): void {
  for (const child of children.flat()) {
    if (child === null || child === undefined || child === false) continue;
    node.append(child instanceof Node ? child : String(child));
  }
}

export function replace(node: Element, ...children: (Child | Child[])[]): void {
  node.replaceChildren();
  append(node, ...children);
}

const SVG = "http://www.w3.org/2000/svg";
export function svg(tag: string, attributes: Record<string, string | number>, ...children: (Node | string)[]): SVGElement {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  node.append(...children);
  return node;
}

/** Calls `f` once things have been quiet for `ms`. */
export function quietly<A extends unknown[]>(ms: number, f: (...a: A) => void): (...a: A) => void {
  let timer = 0;
  return (...a) => {
    window.clearTimeout(timer);
    timer = window.setTimeout(() => f(...a), ms);
  };
}

/** Once the browser has nothing better to do, but soon. */
export function idle(): Promise<void> {
  const latest = 1500;
  return new Promise((done) => (window.requestIdleCallback ? window.requestIdleCallback(() => done(), { timeout: latest }) : window.setTimeout(done, 200)));
}

export function saveAs(blob: Blob, name: string): void {
  const link = h("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const colours = new Map<string, string>();
let coloursOf = "";

/** A variable of the style sheet. Kept as long as the theme stays: asking the browser makes it lay out the page anew. */
export function css(name: string): string {
  const theme = document.documentElement.dataset.theme ?? "";
  if (theme !== coloursOf) colours.clear();
  coloursOf = theme;
  let value = colours.get(name);
  if (value === undefined)
    colours.set(name, (value = getComputedStyle(document.documentElement).getPropertyValue(name).trim()));
  return value;
}

/** A message at the foot of the page for some seconds; read out by screen readers. */
export function tell(text: string, kind: "info" | "error" = "info"): void {
  const place = document.getElementById("messages");
  if (!place) return;
  const note = h("div", { class: `toast ${kind}`, role: kind === "error" ? "alert" : "status" }, text);
  place.append(note);
  window.setTimeout(() => note.remove(), kind === "error" ? 12_000 : 4000);
}

export async function copyText(text: string, what: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = h("textarea", { value: text });
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  tell(t("copied", { what }));
}

const drawings = {
  copy: "M5 5V2h9v9h-3M2 5h9v9H2z",
  full: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4",
  note: "M3 2h10v12H3zM5 5h6M5 8h6M5 11h4",
  lines: "M1 11l4-6 4 4 6-7M1 14h14",
} as const;

/** A small drawing in the colour of the text: fonts do not have these signs everywhere. */
export function icon(name: keyof typeof drawings): SVGElement {
  return svg(
    "svg",
    { viewBox: "0 0 16 16", width: 13, height: 13, "aria-hidden": "true" },
    svg("path", { d: drawings[name], fill: "none", stroke: "currentColor", "stroke-width": 1.5 }),
  );
}
