/** What the address names: an element, and what must happen when it goes. */
export interface Page {
  title: string;
  element: HTMLElement;
  close?: () => void;
  /** The theme has changed. */
  redraw?: () => void;
}

/** To the first page, if the reader is still at this address by then. */
export function toStartFrom(address: string): () => void {
  return () => {
    if (location.hash === address) location.hash = "#/";
  };
}
