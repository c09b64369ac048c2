// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the pointer does in a scene besides turning it: it selects, centres, asks, and scrolls the page.
import { element } from "../ui/dom.ts";

/** A press that moves farther than this [pixels] turns the scene. */
const STILL = 5;
const HINT_MS = 1600;

export interface PointerTarget {
  click: (x: number, y: number) => void;
  doubleClick: (x: number, y: number) => void;
  /** The lines of the text beside the pointer, none where there is nothing. */
  hover: (x: number, y: number) => string[];
}

export class Pointer {
  readonly tooltip = element("div", { class: "tooltip", role: "status", hidden: true });
  private readonly hint = element("div", { class: "wheel-hint", hidden: true }, "Ctrl and wheel zoom; press the scene first to zoom by the wheel alone");
  private pending = false;
  private x = 0;
  private y = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** @param setZoom lets the wheel zoom, or scroll the page */
  constructor(private readonly node: HTMLElement, canvas: HTMLCanvasElement, private readonly target: PointerTarget, setZoom: (on: boolean) => void) {
    node.append(this.tooltip, this.hint);
    node.addEventListener("wheel", (event) => {
      const zooms = document.activeElement === canvas || event.ctrlKey || event.metaKey || document.fullscreenElement !== null;
      setZoom(zooms);
      if (!zooms) this.tell();
    }, { capture: true, passive: true });
    let downX = NaN;
    let downY = NaN;
    canvas.addEventListener("pointerdown", (event) => {
      downX = event.offsetX;
      downY = event.offsetY;
      this.hide();
    });
    canvas.addEventListener("pointerup", (event) => {
      if (event.button === 0 && Math.hypot(event.offsetX - downX, event.offsetY - downY) < STILL) target.click(event.offsetX, event.offsetY);
    });
    canvas.addEventListener("dblclick", (event) => target.doubleClick(event.offsetX, event.offsetY));
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.ask(event.offsetX, event.offsetY);
    });
    canvas.addEventListener("pointerleave", () => this.hide());
  }

  private tell(): void {
    this.hint.hidden = false;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (this.hint.hidden = true), HINT_MS);
  }

  private hide(): void {
    this.pending = false;
    this.tooltip.hidden = true;
  }

  private ask(x: number, y: number): void {
    this.x = x;
    this.y = y;
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      if (this.pending) this.answer();
    });
  }

  private answer(): void {
    this.pending = false;
    const lines = this.target.hover(this.x, this.y);
    this.node.style.cursor = lines.length > 0 ? "pointer" : "";
    this.tooltip.hidden = lines.length === 0;
    if (lines.length === 0) return;
    this.tooltip.replaceChildren(...lines.map((line) => element("div", {}, line)));
    const { clientWidth: width, clientHeight: height } = this.node;
    const left = Math.min(this.x + 14, width - this.tooltip.offsetWidth - 4);
    const below = this.y + 18 + this.tooltip.offsetHeight < height;
    const top = below ? this.y + 16 : this.y - this.tooltip.offsetHeight - 8;
    this.tooltip.style.transform = `translate(${Math.max(4, left)}px, ${Math.max(4, top)}px)`;
  }
}
