// What the pages with a form have in common: what is typed is kept until it is run or discarded, the server judges the settings, and
// nothing is started, with the reason, while something is wrong.
import { api, type Settings, type Understood } from "../api";
import { h, quietly } from "../dom";
import type { OptionForm } from "../form";
import { t } from "../i18n";
import { said } from "../reasons";

/** Kept for the page's address until the browser's tab is closed. */
export interface Draft {
  settings: Settings;
  title: string;
  /** What the page has beside: its task, its choice of data sets. */
  more: unknown;
}

export interface Wishes {
  form: OptionForm;
  title: HTMLInputElement;
  start: HTMLButtonElement;
  /** As what the server judges the settings; left out: it does not. */
  of?: "scenario" | "dataset";
  /** What is kept with the settings. */
  more?: () => unknown;
  /** Why nothing can be started although all fields are right; empty: it can. */
  reason?: () => string;
  /** The server has looked at the settings. */
  understood?: (now: Understood) => void;
}

export class Desk {
  /** What is wrong with the settings. */
  readonly problem = h("p", { class: "bad", role: "alert", hidden: true });
  /** Why nothing can be started. */
  readonly obstacle = h("p", { class: "note", hidden: true });
  private readonly at = `schuler.draft.${location.hash}`;
  private wishes: Wishes | null = null;
  private first = "";
  private objection = "";
  private readonly wrong = new Map<OptionForm, number>();
  private request: AbortController | null = null;
  private readonly ask = quietly(150, () => void this.judge());

  /** From now on changes are kept: what the page has now is what it begins with. */
  begin(wishes: Wishes): void {
    this.wishes = wishes;
    this.first = this.now();
    wishes.title.addEventListener("input", () => this.keep());
    this.allow();
  }

  private now(): string {
    const { form, title, more } = this.wishes!;
    return JSON.stringify({ settings: form.settings, title: title.value, more: more?.() ?? null });
  }

  /** What was typed here before, where it is not what the page begins with anyway. */
  get draft(): Draft | null {
    const text = sessionStorage.getItem(this.at);
    return text && text !== this.first ? (JSON.parse(text) as Draft) : null;
  }

  /** Tells that a draft was taken up, with the way back. */
  restored(): HTMLElement {
    const discard = () => (this.forget(), window.dispatchEvent(new HashChangeEvent("hashchange")));
    return h("p", { class: "note restored" }, t("draft.restored"), " ", h("button", { type: "button", onClick: discard }, t("draft.discard")));
  }

  forget(): void {
    sessionStorage.removeItem(this.at);
  }

  keep(): void {
    if (!this.wishes) return;
    const text = this.now();
    try {
      if (text === this.first) this.forget();
      else sessionStorage.setItem(this.at, text);
    } catch {
      // the browser keeps nothing: a draft is no reason to fail
    }
  }

  /** Something was typed or chosen. */
  changed(): void {
    this.keep();
    if (this.wishes?.of) this.ask();
    this.allow();
  }

  /** Follows a form: the settings, or options of a task. */
  follow(form: OptionForm): void {
    form.judged = (n) => {
      this.wrong.set(form, n);
      this.allow();
    };
  }

  /** A form is no longer part of the page. */
  leave(form: OptionForm | null): void {
    if (form) this.wrong.delete(form);
  }

  allow(): void {
    if (!this.wishes) return;
    const { start, reason } = this.wishes;
    const fields = [...this.wrong.values()].some((n) => n > 0);
    const why = fields ? t("form.mend_first") : this.objection || (reason?.() ?? "");
    start.disabled = why !== "";
    start.title = why;
    // what the server objects to stands above already
    this.obstacle.hidden = why === "" || why === this.objection;
    this.obstacle.textContent = `${t("task.not")}: ${why}`;
  }

  /** What the server says of the settings, in its field or above the form. */
  show(now: Understood): void {
    const known = now.problem !== null && this.wishes!.form.blame(now.problem);
    this.problem.hidden = !now.problem;
    this.objection = now.problem ? said(`${now.problem.text}${now.problem.mend ? `; ${now.problem.mend}` : ""}`) : "";
    if (now.problem) this.problem.textContent = known ? t("editor.see_field", { key: now.problem.key }) : this.objection;
    this.allow();
  }

  async judge(): Promise<void> {
    const { form, of, understood } = this.wishes!;
    if (!of) return;
    this.request?.abort();
    const request = (this.request = new AbortController());
    try {
      const now = await api.settings(of, { settings: form.settings }, request.signal);
      if (request.signal.aborted) return;
      form.understood(now);
      this.show(now);
      understood?.(now);
    } catch (e) {
      if (request.signal.aborted) return;
      this.problem.hidden = false;
      this.problem.textContent = (e as Error).message;
    }
  }
}
