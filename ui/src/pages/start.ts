// Start: logs to drop, examples to pick, runs to open or compare.
import { api, upload, type DatasetInfo, type Run } from "../api";
import { h, icon, replace, tell } from "../dom";
import { language, maybe, number, t } from "../i18n";
import type { Page } from "../page";
import { watchRuns } from "../streams";
import { stateBadge } from "./badge";
import { partDone, progressWords } from "./progress";

/** Files of a drop, those of folders too. */
interface Sent {
  file: File;
  /** Inside the data set: folders are kept. */
  path: string;
}

async function dropped(items: DataTransferItemList): Promise<{ files: Sent[]; name: string }> {
  const files: Sent[] = [];
  let name = "";
  const walk = async (entry: FileSystemEntry): Promise<void> => {
    if (entry.isFile) {
      const file = await new Promise<File>((done, fail) => (entry as FileSystemFileEntry).file(done, fail));
      const parts = entry.fullPath.split("/").filter(Boolean);
      files.push({ file, path: parts.length > 1 ? parts.slice(1).join("/") : file.name });
      return;
    }
    name ||= entry.name;
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) {
      const some = await new Promise<FileSystemEntry[]>((done, fail) => reader.readEntries(done, fail));
      if (some.length === 0) return;
      for (const each of some) await walk(each);
    }
  };
  const entries = [...items].map((i) => i.webkitGetAsEntry()).filter((e) => e !== null);
  for (const entry of entries) await walk(entry);
  return { files, name: name || files[0]?.file.name.replace(/\.[^.]*$/, "") || "data" };
}

/** Each folder in the folder as a data set of its own; files beside them are of none. */
function byFolder(files: Sent[]): Map<string, Sent[]> {
  const out = new Map<string, Sent[]>();
  for (const { file, path } of files) {
    const [name = "", ...rest] = path.split("/");
    if (rest.length > 0) out.set(name, [...(out.get(name) ?? []), { file, path: rest.join("/") }]);
  }
  return out;
}

async function send(files: Sent[], title: string, status: HTMLElement, several = false): Promise<void> {
  const wanted = files.filter((f) => !f.path.split("/").some((part) => part.startsWith(".")));
  if (wanted.length === 0) return tell(t("start.nothing"), "error");
  const bar = h("progress", { max: 1, value: 0 });
  const text = h("span");
  replace(status, bar, text);
  const sets = several ? byFolder(wanted) : new Map([[title, wanted]]);
  if (sets.size === 0) return tell(t("start.no_folders"), "error");
  let name = "";
  const names: string[] = [];
  try {
    const whole = [...sets.values()].flat().reduce((sum, f) => sum + f.file.size, 0) || 1;
    let before = 0;
    for (const [each, content] of sets) {
      ({ name } = await api.newDataset(each));
      for (const { file, path } of content) {
        text.textContent = several ? `${each}/${path}` : path;
        await upload(name, file, path, (part) => (bar.value = (before + part * file.size) / whole));
        before += file.size;
      }
      names.push(name);
    }
    location.hash = several ? `#/batch?sets=${names.map(encodeURIComponent).join(",")}&title=${encodeURIComponent(title)}` : `#/data/${encodeURIComponent(name)}`;
  } catch (e) {
    // half a data set is none
    if (name) void api.removeDataset(name).catch(() => undefined);
    replace(status, h("p", { class: "bad", role: "alert" }, (e as Error).message));
  }
}

function dropZone(): HTMLElement {
  const status = h("div", { class: "drop-status" });
  const choose = (folder: boolean, several = false) => {
    const input = h("input", { type: "file", multiple: true });
    if (folder) input.setAttribute("webkitdirectory", "");
    input.onchange = () => {
      const files = [...(input.files ?? [])];
      const path = files[0]?.webkitRelativePath.split("/")[0];
      const sent = files.map((file) => ({ file, path: file.webkitRelativePath.split("/").slice(1).join("/") || file.name }));
      void send(sent, path || files[0]?.name.replace(/\.[^.]*$/, "") || "data", status, several);
    };
    input.click();
  };
  const zone = h(
    "div",
    { class: "drop" },
    h("p", { class: "drop-big" }, t("start.drop")),
    h("p", { class: "muted" }, t("start.formats")),
    h(
      "p",
      null,
      h("button", { type: "button", onClick: () => choose(false) }, t("start.files")),
      " ",
      h("button", { type: "button", onClick: () => choose(true) }, t("start.folder")),
      " ",
      h("button", { type: "button", onClick: () => choose(true, true) }, t("start.folders")),
    ),
    status,
  );
  for (const kind of ["dragenter", "dragover"])
    zone.addEventListener(kind, (e) => (e.preventDefault(), zone.classList.add("over")));
  for (const kind of ["dragleave", "drop"]) zone.addEventListener(kind, () => zone.classList.remove("over"));
  zone.addEventListener("drop", (e) => {
    e.preventDefault();
    if (e.dataTransfer) void dropped(e.dataTransfer.items).then(({ files, name }) => send(files, name, status));
  });
  return zone;
}

const iconButton = (sign: string | Node, name: string, action: () => void) =>
  h("button", { type: "button", class: "icon", title: name, "aria-label": name, onClick: action }, sign);

const removeButton = (title: string, remove: () => Promise<void>) =>
  iconButton("✕", `${t("remove")} ${title}`, () => void (confirm(t("remove.sure", { name: title })) && remove()));

function datasetList(sets: DatasetInfo[], again: () => void): HTMLElement {
  return h(
    "ul",
    { class: "plain-list" },
    ...sets.map((d) =>
      h(
        "li",
        null,
        h("a", { href: `#/data/${encodeURIComponent(d.name)}` }, d.title),
        h("span", { class: "muted" }, ` ${t("start.n_files", { n: d.files.length })}${d.opened ? ` · ${t("start.opened")}` : ""}`),
        !d.opened && removeButton(d.title, () => api.removeDataset(d.name).then(again)),
      ),
    ),
  );
}

function runTable(runs: Run[], again: () => void): HTMLElement {
  if (runs.length === 0) return h("p", { class: "muted" }, t("start.no_runs"));
  const chosen = new Set<string>();
  const most = 60;
  const compare = h(
    "button",
    {
      type: "button",
      disabled: true,
      onClick: () => (location.hash = `#/compare/${[...chosen].map(encodeURIComponent).join("/")}`),
    },
    t("start.compare"),
  );
  const removal = h(
    "button",
    {
      type: "button",
      disabled: true,
      onClick: () => {
        if (confirm(t("start.remove_sure", { n: chosen.size }))) void Promise.allSettled([...chosen].map((id) => api.remove(id))).then(again);
      },
    },
    t("start.remove"),
  );
  const done = new Set(runs.filter((r) => r.state === "done").map((r) => r.id));
  const rows = runs.map((run) => {
    const title = h("a", { href: `#/run/${encodeURIComponent(run.id)}` }, run.title);
    return h(
      "tr",
      { "data-run": run.id },
      h(
        "td",
        null,
        h("input", {
          type: "checkbox",
          "aria-label": `${t("start.choose")} ${run.title}`,
          disabled: run.state === "running" || run.state === "waiting",
          onChange: (e: Event) => {
            if ((e.target as HTMLInputElement).checked) chosen.add(run.id);
            else chosen.delete(run.id);
            compare.disabled = chosen.size < 2 || [...chosen].some((id) => !done.has(id));
            removal.disabled = chosen.size === 0;
          },
        }),
      ),
      h(
        "td",
        { class: "run-title" },
        title,
        run.batch && h("a", { class: "batch-link", href: `#/batch/${encodeURIComponent(run.batch)}`, title: t("batch.title") }, run.batch),
        run.note && h("span", { class: "muted run-note" }, run.note),
      ),
      h("td", { class: "state" }, stateBadge(run)),
      h("td", { class: "verdict-cell" }, run.verdict ? maybe(`verdict.${run.verdict}`, run.verdict) : "–"),
      h("td", null, run.scheme ?? "–"),
      h("td", { class: "figure" }, number(run.duration_s)),
      h("td", { class: "figure" }, number(run.error_m, 3)),
      h("td", null, new Date(run.created * 1000).toLocaleString(language)),
      h(
        "td",
        { class: "tools" },
        (run.state === "running" || run.state === "waiting") &&
          iconButton("⊘", `${t("run.cancel")} ${run.title}`, () => void api.cancel(run.id).then(again, (e: Error) => tell(e.message, "error"))),
        iconButton("✎", `${t("rename")} ${run.title}`, () => {
          const name = prompt(t("rename"), run.title);
          if (name) void api.rename(run.id, name).then(again);
        }),
        iconButton(icon("note"), `${t("note.edit")} ${run.title}`, () => {
          const note = prompt(t("note.edit"), run.note);
          if (note !== null) void api.annotate(run.id, note).then(again, (e: Error) => tell(e.message, "error"));
        }),
        removeButton(run.title, () => api.remove(run.id).then(again)),
      ),
    );
  });
  const head = [
    "",
    t("run.title"),
    t("run.state"),
    t("quality.verdict"),
    t("run.scheme"),
    `${t("run.duration")}, s`,
    `${t("run.error")}, m`,
    t("run.created"),
    "",
  ];
  const body = h("tbody", null, ...rows.slice(0, most));
  const all: HTMLButtonElement = h("button", { type: "button", onClick: () => (body.append(...rows.slice(most)), all.remove()) }, t("start.all_runs", { n: rows.length }));
  const search = h("input", {
    type: "search",
    placeholder: t("start.find_run"),
    "aria-label": t("start.find_run"),
    onInput: () => {
      if (all.isConnected) all.click();
      const word = search.value.toLowerCase();
      rows.forEach((row, i) => (row.hidden = !`${runs[i]!.title} ${runs[i]!.scheme ?? ""} ${runs[i]!.dataset ?? ""} ${runs[i]!.batch ?? ""} ${runs[i]!.note}`.toLowerCase().includes(word)));
    },
  });
  return h(
    "div",
    null,
    rows.length > 8 && h("p", { class: "form-tools" }, search),
    h(
      "div",
      { class: "scroll", tabIndex: 0 },
      h(
        "table",
        { class: "runs" },
        h(
          "thead",
          null,
          h(
            "tr",
            null,
            ...head.map((x, i) =>
              h(
                "th",
                { scope: "col", class: i === 5 || i === 6 ? "figure" : "" },
                x || h("span", { class: "hidden" }, t("start.choose")),
              ),
            ),
          ),
        ),
        body,
      ),
    ),
    rows.length > most && all,
    h("p", { class: "form-tools" }, compare, removal, h("span", { class: "muted" }, ` ${t("start.compare_hint")}`)),
  );
}

export async function startPage(): Promise<Page> {
  const examples = await api.examples();
  const sets = h("div"),
    runs = h("div");
  const refreshSets = async () => {
    const all = await api.datasets();
    replace(
      sets,
      all.length > 0 && h("h3", null, t("start.datasets")),
      datasetList(all, () => void refreshSets()),
      all.length > 1 && h("p", null, h("a", { class: "button", href: "#/batch" }, t("start.batch"))),
    );
  };
  const refreshRuns = async () =>
    replace(
      runs,
      runTable(await api.runs(), () => void refreshRuns()),
    );
  await Promise.all([refreshSets(), refreshRuns()]);
  const close = watchRuns((e) => {
    const cell = runs.querySelector(`tr[data-run="${CSS.escape(e.id)}"] .state`);
    if (!cell || e.state === "done" || e.state === "failed" || e.state === "cancelled") {
      if (!cell?.querySelector(`.${e.state}`)) void refreshRuns();
      return;
    }
    const part = partDone(e);
    replace(cell, h("progress", { max: 1, ...(part === null ? {} : { value: part }), "aria-label": t(`state.${e.state}`) }), ` ${progressWords(e)}`);
  });
  const element = h(
    "div",
    { class: "start" },
    h("h1", null, t("start.title")),
    h("p", { class: "lead" }, t("start.lead")),
    h(
      "div",
      { class: "columns" },
      h("section", { class: "card" }, h("h2", null, t("start.logs")), dropZone(), sets),
      h("section", { class: "card" }, h("h2", null, t("start.runs")), runs),
    ),
    h(
        "section",
        { class: "card" },
        h("h2", null, t("start.examples")),
        h("p", { class: "muted" }, t("start.examples_lead")),
        h(
          "ul",
          { class: "examples" },
          ...examples.map((e) =>
            h(
              "li",
              null,
              h(
                "a",
                { href: `#/scenario?example=${encodeURIComponent(e.name)}` },
                h("strong", null, e.name),
                h("span", null, e.about),
              ),
            ),
          ),
        ),
      ),
  );
  return { title: t("nav.start"), element, close };
}
