// Colours of lines: nine of the style sheet, told apart by colour-blind readers too, or what the user chose.
import { css } from "../dom";

export const inks = ["--ink-1", "--ink-2", "--ink-3", "--ink-4", "--ink-5", "--ink-6", "--ink-7", "--ink-8", "--ink-9"] as const;

const key = (line: string) => `schuler.colour.${line}`;

/** The colour of a line: what the user chose for that name, else that of its number. */
export function colour(line: string, number: number, paint?: string): string {
  if (paint) return css(paint);
  return localStorage.getItem(key(line)) ?? css(inks[number % inks.length]!);
}

export function chooseColour(line: string, value: string | null): void {
  if (value === null) localStorage.removeItem(key(line));
  else localStorage.setItem(key(line), value);
}

/** "#rrggbb" of any CSS colour, for colour inputs. */
export function hex(value: string): string {
  const context = document.createElement("canvas").getContext("2d")!;
  context.fillStyle = value;
  return context.fillStyle.startsWith("#") ? context.fillStyle : "#888888";
}

export function faded(value: string, alpha: number): string {
  const text = hex(value);
  const byte = (at: number) => parseInt(text.slice(at, at + 2), 16);
  return `rgba(${byte(1)}, ${byte(3)}, ${byte(5)}, ${alpha})`;
}
