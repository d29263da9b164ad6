// The settings of a run with where each comes from, and what differs from those of another run.
import { api, type Fact, type RunDetails } from "../api";
import { append, h, replace } from "../dom";
import { maybe, number, t } from "../i18n";

function shown(v: unknown): string {
  if (v === null || v === undefined) return "–";
  if (typeof v === "number") return number(v, 5);
  if (Array.isArray(v)) return v.map(shown).join(", ");
  if (typeof v === "object") return Object.entries(v as object).map(([k, x]) => `${k}: ${shown(x)}`).join(", ");
  return String(v);
}

function valueOf(f: Fact | undefined): string {
  if (!f) return "–";
  const sigma = f.sigma !== null && f.sigma !== undefined ? ` ± ${number(f.sigma, 2)}` : "";
  return `${shown(f.value)}${sigma}${f.unit ? ` ${f.unit}` : ""}`;
}

export function factsCard(run: RunDetails, others: Promise<{ id: string; title: string }[]>): HTMLElement | null {
  const facts = run.summary?.facts ?? [];
  if (facts.length === 0) return null;
  const place = h("div", { class: "scroll", tabIndex: 0 });
  const search = h("input", { type: "search", placeholder: t("form.search"), "aria-label": t("form.search"), onInput: () => fill() });
  let other: RunDetails | null = null;
  const choice = h(
    "select",
    {
      "aria-label": t("facts.compare"),
      hidden: true,
      onChange: () =>
        void (choice.value ? api.run(choice.value) : Promise.resolve(null)).then((r) => {
          other = r;
          fill();
        }),
    },
    h("option", { value: "" }, `${t("facts.compare")} …`),
  );
  void others.then((all) => {
    append(choice, ...all.map((r) => h("option", { value: r.id }, r.title)));
    choice.hidden = all.length === 0;
  });
  const fill = () => {
    const word = search.value.toLowerCase();
    const theirs = new Map((other?.summary?.facts ?? []).map((f) => [f.key, f]));
    const keys = other ? [...new Set([...facts.map((f) => f.key), ...theirs.keys()])] : facts.map((f) => f.key);
    const mine = new Map(facts.map((f) => [f.key, f]));
    const rows = keys
      .filter((k) => `${k} ${valueOf(mine.get(k))} ${mine.get(k)?.note ?? ""}`.toLowerCase().includes(word))
      .filter((k) => !other || JSON.stringify(mine.get(k)?.value) !== JSON.stringify(theirs.get(k)?.value));
    const head = other ? [t("facts.key"), run.title, other.title, t("facts.how")] : [t("facts.key"), t("data.value"), t("facts.how"), t("facts.note")];
    replace(
      place,
      rows.length === 0 && h("p", { class: "muted" }, t("facts.same")),
      rows.length > 0 &&
        h(
          "table",
          { class: "facts" },
          h("thead", null, h("tr", null, ...head.map((x) => h("th", { scope: "col" }, x)))),
          h(
            "tbody",
            null,
            ...rows.map((k) => {
              const f = mine.get(k);
              const how = f ? h("span", { class: `how ${f.how}` }, maybe(`how.${f.how}`, f.how)) : "–";
              return h(
                "tr",
                null,
                h("td", null, h("code", null, k)),
                h("td", null, valueOf(f)),
                ...(other ? [h("td", null, valueOf(theirs.get(k))), h("td", null, how)] : [h("td", null, how), h("td", { class: "muted" }, f?.note ?? "")]),
              );
            }),
          ),
        ),
    );
  };
  fill();
  return h(
    "details",
    { class: "card" },
    h("summary", null, `${t("facts.title")} (${facts.length})`),
    h("p", { class: "form-tools" }, search, choice),
    place,
  );
}
