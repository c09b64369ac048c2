// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Marks and axes of the drawings that tables are shown by. They are vectors, so that print and large screens show them sharp.
import { element } from "../ui/dom.ts";
import { svg } from "../ui/svg.ts";
import { enlarged } from "../ui/text_size.ts";
import { type Scale, tickText } from "./scale.ts";

export const FONT = 12;

export interface Frame {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** A mark whose shape differs too, for readers who do not tell the colours apart. */
export function mark(shape: number, x: number, y: number, colour: string, size = 4): SVGElement {
  const look = { fill: colour, class: "mark" };
  switch (shape % 4) {
    case 1:
      return svg("rect", { x: x - size, y: y - size, width: 2 * size, height: 2 * size, ...look });
    case 2:
      return svg("path", { d: `M${x} ${y - 1.25 * size}L${x + 1.2 * size} ${y + size}L${x - 1.2 * size} ${y + size}Z`, ...look });
    case 3:
      return svg("path", { d: `M${x} ${y - 1.35 * size}L${x + 1.35 * size} ${y}L${x} ${y + 1.35 * size}L${x - 1.35 * size} ${y}Z`, ...look });
    default:
      return svg("circle", { cx: x, cy: y, r: size, ...look });
  }
}

export function line(x1: number, y1: number, x2: number, y2: number, className: string, colour = ""): SVGElement {
  return svg("line", { x1, y1, x2, y2, class: className, ...(colour ? { stroke: colour } : {}) });
}

export function text(x: number, y: number, words: string, anchor: "start" | "middle" | "end", className = "tick"): SVGElement {
  return svg("text", { x, y, "text-anchor": anchor, class: className }, words);
}

/** Grid lines and numbers below a drawing. */
export function axisBelow(scale: Scale, frame: Frame): SVGElement[] {
  const at = (value: number) => frame.left + scale.at(value) * (frame.right - frame.left);
  return scale.ticks.flatMap((tick) => [
    line(at(tick), frame.top, at(tick), frame.bottom, tick === 0 ? "axis" : "grid"), text(at(tick), frame.bottom + FONT + 4, tickText(tick), "middle"),
  ]);
}

/** Grid lines and numbers at the left. */
export function axisLeft(scale: Scale, frame: Frame): SVGElement[] {
  const at = (value: number) => frame.bottom - scale.at(value) * (frame.bottom - frame.top);
  return scale.ticks.flatMap((tick) => [
    line(frame.left, at(tick), frame.right, at(tick), tick === 0 ? "axis" : "grid"), text(frame.left - 6, at(tick) + 4, tickText(tick), "end"),
  ]);
}

/** The colours of lines, above the drawings that share them. */
export function key(entries: readonly { name: string; colour: string; shape?: number }[]): HTMLElement {
  return element("ul", { class: "legend signs" }, ...entries.map(({ name, colour, shape }) => {
    const sign = svg("svg", { width: 14, height: 12, "aria-hidden": "true" }, shape === undefined ? line(0, 6, 14, 6, "sign", colour) : mark(shape, 7, 6, colour, 4));
    return element("li", {}, sign, name);
  }));
}

/** A drawing that is drawn anew when its place has another width; its text grows with that of the page. */
export function responsive(draw: (width: number) => SVGSVGElement): HTMLElement {
  const node = element("div", { class: "drawing" });
  let last = 0;
  const fill = (width: number) => {
    if (width === 0 || Math.abs(width - last) < 1) return;
    last = width;
    const factor = enlarged();
    const drawn = draw(width / factor);
    drawn.setAttribute("height", String(Math.round(factor * Number(drawn.getAttribute("height")))));
    drawn.setAttribute("width", String(Math.round(width)));
    node.replaceChildren(drawn);
  };
  new ResizeObserver(() => fill(node.clientWidth)).observe(node);
  return node;
}
