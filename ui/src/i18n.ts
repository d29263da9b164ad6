// Texts in the reader's language: one message file a language, English where a text is missing. Messages with parameters are in
// the syntax of ICU MessageFormat (plural forms by the rules of the language), formatted by intl-messageformat.
import { IntlMessageFormat } from "intl-messageformat";
import { chosenLanguage, languageKey, languages as known } from "./choice";
import en from "./messages/en.json";

type Messages = Record<string, string>;
/** Those that are loaded: who reads English loads no other. */
const languages: Record<string, Messages> = { en };
const files: Record<string, () => Promise<{ default: Messages }>> = {
  uk: () => import("./messages/uk.json"),
  ru: () => import("./messages/ru.json"),
};

export let language = chosenLanguage();
document.documentElement.lang = language;

/** Until this is done, texts are in English. */
export async function languageReady(): Promise<void> {
  const name = language;
  const load = files[name];
  if (load && !languages[name]) languages[name] = (await load()).default;
}

/** Parsed once: of the language that is shown. */
const formats = new Map<string, IntlMessageFormat>();

export function setLanguage(name: string): void {
  language = known.includes(name) ? name : "en";
  formats.clear();
  localStorage.setItem(languageKey, language);
  document.documentElement.lang = language;
}

/** The text of a key with its {names} filled in; the key itself where there is none. */
export function t(key: string, values: Record<string, string | number> = {}): string {
  const text = languages[language]?.[key] ?? (en as Messages)[key] ?? key;
  if (!text.includes("{")) return text;
  let format = formats.get(key);
  if (!format) formats.set(key, (format = new IntlMessageFormat(text, key in (languages[language] ?? {}) ? language : "en", undefined, { ignoreTag: true })));
  return String(format.format(values));
}

/** Sentences of the options by their English, which the program sends: only who reads them in another language loads them. */
const helps: Record<string, Messages> = {};
const helpFiles: Record<string, () => Promise<{ default: Messages }>> = {
  uk: () => import("./messages/help.uk.json"),
  ru: () => import("./messages/help.ru.json"),
};

/** Until this is done, sentences of options are in English. */
export async function helpReady(): Promise<void> {
  const name = language;
  const load = helpFiles[name];
  if (load && !helps[name]) helps[name] = (await load()).default;
}

export function help(text: string): string {
  const known = helps[language];
  if (!known) return text;
  if (known[text]) return known[text];
  // "value that the filter assumes instead of the simulated one: gyro angle random walk"
  const at = text.indexOf(": ");
  const [head, tail] = [known[text.slice(0, at)], known[text.slice(at + 2)]];
  return at > 0 && head && tail ? `${head}: ${tail}` : text;
}

/** A text that may be missing: `otherwise` then. */
export function maybe(key: string, otherwise: string): string {
  return languages[language]?.[key] ?? (en as Messages)[key] ?? otherwise;
}

export function number(x: number | null | undefined, digits = 4): string {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  if (x !== 0 && (Math.abs(x) < 1e-4 || Math.abs(x) >= 1e7)) return x.toExponential(2);
  return String(Number(x.toPrecision(digits)));
}
