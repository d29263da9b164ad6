/** What the address names: an element, and what must happen when it goes. */
export interface Page {
  title: string;
  element: HTMLElement;
  close?: () => void;
  /** The theme has changed. */
  redraw?: () => void;
}
