// Before anything is drawn: language and colours of the page that index.html draws by itself, so that nothing flashes; and what the page of
// this address needs is asked for, while its scripts are on their way. A plain script, made small by vite.config.ts.
import { begin, needs, route } from "./begun";
import { applyTheme, chosenLanguage } from "./choice";

document.documentElement.lang = chosenLanguage();
applyTheme();
try {
  const { kind, rest } = route(location.hash);
  document.documentElement.dataset.page = kind;
  const { scripts, requests } = needs(kind, rest[0] ?? "");
  const language = document.documentElement.lang;
  for (const name of language === "en" ? scripts : [language, ...scripts]) {
    const link = document.createElement("link");
    link.rel = "modulepreload";
    link.href = `/assets/${name}.js`;
    document.head.append(link);
  }
  requests.forEach(begin);
} catch {
  // an address that cannot be read: the page says so
}
