// Sentences of the program in the reader's language: each is recognised by the template that it was made of (messages "reason.").
import { language, t } from "./i18n";
import en from "./messages/en.json";

interface Template {
  key: string;
  names: string[];
  shape: RegExp;
}

let known: Template[] | null = null;

function templates(): Template[] {
  const escaped = (text: string) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
  return (known ??= Object.entries(en as Record<string, string>)
    .filter(([key]) => key.startsWith("reason."))
    .map(([key, text]) => {
      const parts = text.replaceAll("''", "'").split(/\{(\w+)\}/);
      return { key, size: text.length, names: parts.filter((_, i) => i % 2 === 1), shape: new RegExp(`^${parts.map((p, i) => (i % 2 === 1 ? "(.*?)" : escaped(p))).join("")}$`) };
    })
    // those that say most come first
    .sort((a, b) => b.size - a.size));
}

/** The sentence in the language of the page, with what it is filled with; as it is where it is not known. */
export function said(text: string, depth = 0): string {
  if (language === "en" || depth > 3) return text;
  for (const { key, names, shape } of templates()) {
    const found = shape.exec(text);
    if (found) return t(key, Object.fromEntries(names.map((name, i) => [name, said(found[i + 1] ?? "", depth + 1)])));
  }
  // "what is wrong; what to do", or "file:line: key: what is wrong"
  if (text.includes("; ")) return text.split("; ").map((part) => said(part, depth + 1)).join("; ");
  const place = /^(line \d+|[^\s:]+(?::\d+)?)(, [\w.]+)?: (.+)$/.exec(text);
  if (!place) return text;
  return `${place[1]!.replace(/^line (\d+)$/, (_, n: string) => t("error.line", { n }))}${place[2] ?? ""}: ${said(place[3]!, depth)}`;
}
