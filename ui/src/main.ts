// The frame of the page: header, language, theme, keyboard, which page the address names.
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { append, h, replace, tell } from "./dom";
import { forget, route } from "./begun";
import { applyTheme, chosenTheme, themeKey, themes, type Theme } from "./choice";
import { helpReady, language, languageReady, setLanguage, t } from "./i18n";
import type { Page } from "./page";
import { watchServer } from "./streams";

/** Pages by the first word of the address; the scripts of each are loaded when it is opened. */
const pages: Record<string, (rest: string[], parameters: URLSearchParams) => Promise<Page>> = {
  scenario: async (_, parameters) => (await import("./pages/editor")).editorPage(parameters),
  data: async (rest, parameters) => (await import("./pages/data")).dataPage(rest[0] ?? "", parameters),
  run: async (rest) => (await import("./pages/run")).runPage(rest[0] ?? "", rest[1] ?? ""),
  compare: async (rest) => (await import("./pages/compare")).comparePage(rest),
  batch: async (rest, parameters) => {
    const { batchPage, batchTablePage } = await import("./pages/batch");
    return rest[0] ? batchTablePage(rest[0]) : batchPage(parameters);
  },
  live: async () => (await import("./pages/live")).livePage(),
  studies: async (rest, parameters) => (await import("./pages/studies")).studiesPage(parameters, rest[0] ?? ""),
};
const start = async () => (await import("./pages/start")).startPage();

const content = h("main", { id: "content", tabIndex: -1 });
let shown: Page | null = null;
let turn = 0;

async function open(): Promise<void> {
  const mine = ++turn;
  const { kind, rest, parameters } = route(location.hash);
  shown?.close?.();
  shown = null;
  try {
    await helpReady();
    const page = (Object.hasOwn(pages, kind) ? pages[kind]! : start)(rest, parameters);
    const made = await page;
    forget();
    if (mine !== turn) return made.close?.();
    shown = made;
    replace(content, made.element);
    document.title = `${made.title} – Schuler`;
    for (const link of document.querySelectorAll<HTMLAnchorElement>("header nav a"))
      link.toggleAttribute("aria-current", link.hash.split("?")[0] === `#/${kind}`);
  } catch (e) {
    if (mine !== turn) return; // another page is there
    replace(
      content,
      h(
        "section",
        { class: "card" },
        h("h1", null, t("error.title")),
        h("p", null, (e as Error).message),
        h("p", null, h("a", { href: "#/" }, t("nav.start"))),
      ),
    );
  }
}

const banner = h("p", { class: "banner", role: "alert", hidden: true });

function frame(): void {
  applyTheme();
  const icons: Record<Theme, string> = { auto: "◐", light: "☀", dark: "☾" };
  const themeButton = h(
    "button",
    {
      type: "button",
      class: "icon",
      "aria-label": t("theme"),
      title: t("theme"),
      onClick: () => {
        localStorage.setItem(themeKey, themes[(themes.indexOf(chosenTheme()) + 1) % themes.length]!);
        applyTheme();
        themeButton.textContent = icons[chosenTheme()];
        shown?.redraw?.();
      },
    },
    icons[chosenTheme()],
  );
  const chooser = h(
    "select",
    {
      "aria-label": t("language"),
      onChange: (e: Event) => {
        setLanguage((e.target as HTMLSelectElement).value);
        void languageReady().then(() => (frame(), open()));
      },
    },
    h("option", { value: "en" }, "English"),
    h("option", { value: "uk" }, "Українська"),
    h("option", { value: "ru" }, "Русский"),
  );
  chooser.value = language;
  replace(
    document.getElementById("app")!,
    h("a", { class: "skip", href: "#content", onClick: (e: Event) => (e.preventDefault(), content.focus()) }, t("skip")),
    h(
      "header",
      null,
      h("a", { class: "brand", href: "#/" }, "Schuler"),
      h(
        "nav",
        { "aria-label": t("nav") },
        h("a", { href: "#/" }, t("nav.start")),
        h("a", { href: "#/scenario?example=demo" }, t("nav.scenario")),
        h("a", { href: "#/batch" }, t("nav.batch")),
        h("a", { href: "#/studies" }, t("nav.studies")),
        h("a", { href: "#/live" }, t("nav.live")),
      ),
      h("span", { class: "grow" }),
      h(
        "button",
        { type: "button", class: "icon", title: t("keys.title"), "aria-label": t("keys.title"), onClick: () => keys.showModal() },
        "?",
      ),
      themeButton,
      chooser,
    ),
    banner,
    content,
    h("div", { id: "messages", "aria-live": "polite" }),
  );
  const keys = h("dialog", { class: "keys", "aria-labelledby": "keys-title" });
  const row = (key: string, what: string) => h("tr", null, h("th", null, h("kbd", null, key)), h("td", null, what));
  append(
    keys,
    h("h2", { id: "keys-title" }, t("keys.title")),
    h(
      "table",
      { id: "plot-keys" },
      h(
        "tbody",
        null,
        row("Tab", t("keys.tab")),
        row("← →", t("keys.pan")),
        row("+ −", t("keys.zoom")),
        row("0", t("keys.reset")),
        row("⇧ + ✥", t("keys.drag")),
        row("▭", t("keys.box")),
        row("Ctrl + ⇅", t("keys.wheel")),
        row("Ctrl + ↵", t("keys.run")),
        row("?", t("keys.help")),
      ),
    ),
    h("form", { method: "dialog" }, h("button", null, t("close"))),
  );
  document.getElementById("app")!.append(keys);
  document.onkeydown = (e) => {
    const typing = /^(INPUT|TEXTAREA|SELECT)$/.test((e.target as HTMLElement).tagName);
    if (e.key === "?" && !typing) keys.showModal();
    if (e.key === "Enter" && (e.ctrlKey || e.metaKey)) document.querySelector<HTMLButtonElement>("button.primary.run")?.click();
  };
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  applyTheme();
  shown?.redraw?.();
});
window.addEventListener("hashchange", () => void open());
window.addEventListener("unhandledrejection", (e) => tell(String((e.reason as Error)?.message ?? e.reason), "error"));
watchServer((state) => {
  banner.textContent = t(state === "refused" ? "server.anew" : "server.gone");
  banner.hidden = state === "alive";
  if (state === "alive" && shown === null) void open();
});
void languageReady().then(() => {
  // what index.html has drawn stays until the page is there
  if (document.documentElement.dataset.page === "") append(content, h("h1", null, t("start.title")), h("p", { class: "lead" }, t("start.lead")));
  frame();
  void open();
});
