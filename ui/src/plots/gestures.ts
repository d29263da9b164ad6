// Keys, wheel and dragging over a plot.
import type uPlot from "uplot";
import type { Linked } from "./linked";

export interface Handled {
  readonly element: HTMLElement;
  readonly place: HTMLElement;
  readonly linked: Linked;
  readonly shown: uPlot | null;
  reset(): void;
}

export function handle(plot: Handled): void {
  plot.element.addEventListener("keydown", (e) => key(plot, e));
  plot.place.addEventListener("wheel", (e) => wheel(plot, e), { passive: false });
  plot.place.addEventListener("pointerdown", (e) => grab(plot, e), { capture: true });
}

function key(plot: Handled, e: KeyboardEvent): void {
  if (e.target !== plot.element || e.ctrlKey || e.metaKey || e.altKey) return;
  const { linked } = plot;
  const actions: Record<string, () => void> = {
    ArrowLeft: () => linked.pan(-0.15),
    ArrowRight: () => linked.pan(0.15),
    "+": () => linked.zoom(0.6),
    "=": () => linked.zoom(0.6),
    "-": () => linked.zoom(1 / 0.6),
    "0": () => plot.reset(),
    Home: () => linked.set(linked.start, linked.start + linked.to - linked.from),
    End: () => linked.set(linked.stop - (linked.to - linked.from), linked.stop),
  };
  const action = actions[e.key];
  if (!action) return;
  e.preventDefault();
  action();
}

function wheel({ element, linked, shown }: Handled, e: WheelEvent): void {
  if (!shown || !(e.ctrlKey || document.activeElement === element || document.fullscreenElement === element)) return;
  e.preventDefault();
  const box = shown.over.getBoundingClientRect();
  const about = shown.posToVal(e.clientX - box.left, "x");
  if (Math.abs(e.deltaX) > Math.abs(e.deltaY)) linked.pan(Math.sign(e.deltaX) * 0.08);
  else linked.zoom(e.deltaY > 0 ? 1.2 : 1 / 1.2, about);
}

/** Shift, or the middle button: moves instead of choosing a range. */
function grab({ element, place, linked, shown }: Handled, e: PointerEvent): void {
  element.focus({ preventScroll: true });
  if (!shown || !(e.shiftKey || e.button === 1)) return;
  e.preventDefault();
  e.stopPropagation();
  const { from, to } = linked;
  const move = (m: PointerEvent) => {
    const by = ((e.clientX - m.clientX) / Math.max(1, shown.over.clientWidth)) * (to - from);
    const left = Math.min(Math.max(from + by, linked.start), linked.stop - (to - from));
    linked.set(left, left + to - from);
  };
  window.addEventListener("pointermove", move);
  window.addEventListener("pointerup", () => window.removeEventListener("pointermove", move), { once: true });
  // uPlot listens for the mouse, not the pointer
  place.addEventListener("mousedown", (m) => m.stopPropagation(), { capture: true, once: true });
}
