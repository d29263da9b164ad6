// What the reader has chosen for the whole page: language and colours. Used before anything is drawn (first.ts): no imports.
export const languages = ["en", "uk", "ru"];

export type Theme = "auto" | "light" | "dark";
export const themes: Theme[] = ["auto", "light", "dark"];

export const languageKey = "schuler.language";
export const themeKey = "schuler.theme";

export function chosenLanguage(): string {
  const chosen = localStorage.getItem(languageKey);
  if (chosen && languages.includes(chosen)) return chosen;
  return languages.slice(1).find((l) => navigator.language.startsWith(l)) ?? "en";
}

export function chosenTheme(): Theme {
  return (localStorage.getItem(themeKey) as Theme | null) ?? "auto";
}

/** Sets the colours of the page. */
export function applyTheme(): void {
  const theme = chosenTheme();
  const dark = theme === "dark" || (theme === "auto" && matchMedia("(prefers-color-scheme: dark)").matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
}
