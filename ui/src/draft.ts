// What was typed and not yet run: kept for the page's address until the browser's tab is closed.
import type { Settings } from "./api";

export interface Draft {
  settings: Settings;
  title: string;
}

const key = () => `schuler.draft.${location.hash}`;

export function keepDraft(draft: Draft, at = key()): void {
  try {
    sessionStorage.setItem(at, JSON.stringify(draft));
  } catch {
    // the browser keeps nothing: a draft is no reason to fail
  }
}

export function draftKey(): string {
  return key();
}

export function keptDraft(): Draft | null {
  const text = sessionStorage.getItem(key());
  return text ? (JSON.parse(text) as Draft) : null;
}

export function forgetDraft(at = key()): void {
  sessionStorage.removeItem(at);
}
