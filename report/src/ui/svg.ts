// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Elements of drawings. As in dom.ts, text is always set as text.

const NAMESPACE = "http://www.w3.org/2000/svg";

/** A new element of a drawing; numbers are rounded to hundredths. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K, attributes: Record<string, string | number> = {}, ...children: (Node | string)[]
): SVGElementTagNameMap[K] {
  const made = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) {
    made.setAttribute(name, typeof value === "number" ? String(Number(value.toFixed(2))) : value);
  }
  made.append(...children);
  return made;
}

/** About how wide a text is [px]; names come from strangers, and are measured before they are drawn. */
export function widthOf(text: string, size: number): number {
  return 0.56 * size * [...text].length;
}

/** A text of at most a width, cut with an ellipsis. */
export function shortened(text: string, size: number, width: number): string {
  const most = Math.max(2, Math.floor(width / (0.56 * size)));
  const letters = [...text];
  return letters.length <= most ? text : `${letters.slice(0, most - 1).join("")}…`;
}
