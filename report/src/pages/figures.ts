// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Figures of a results folder: few are shown at once, of many there is an index.
import { button, element } from "../ui/dom.ts";
import { picture } from "./page.ts";

const MOST_AT_ONCE = 6;

/** An index of figures, of which one is shown; words narrow it. */
function index(pictures: [string, string][]): HTMLElement {
  const place = element("div", { class: "shown", "aria-live": "polite" });
  const entries = element("div", { class: "entries", role: "group", "aria-label": "Figures" });
  const box = element("input", { type: "search", "aria-label": "Figures with the words", placeholder: "Figures with the words …" });
  const count = element("p", { class: "hint", role: "status" });
  const buttons = pictures.map(([name], i) => button(name.replace(/\.svg$/, "").replaceAll("_", " "), () => show(i), { "aria-pressed": "false" }));
  let at = -1;
  const show = (next: number) => {
    at = next;
    place.replaceChildren(picture(...pictures[next]));
    buttons.forEach((one, i) => one.setAttribute("aria-pressed", String(i === next)));
  };
  const step = (by: number) => {
    const left = buttons.flatMap((one, i) => (one.hidden ? [] : [i]));
    const place = left.indexOf(at);
    if (left.length > 0) show(left[(place + by + left.length) % left.length]);
  };
  const narrow = () => {
    const words = box.value.toLowerCase().split(/\s+/);
    pictures.forEach(([name], i) => (buttons[i].hidden = !words.every((word) => name.toLowerCase().replaceAll("_", " ").includes(word))));
    const left = buttons.filter((one) => !one.hidden).length;
    count.textContent = left < pictures.length ? `${left} of ${pictures.length} figures` : `${pictures.length} figures`;
  };
  box.addEventListener("input", narrow);
  entries.append(...buttons);
  narrow();
  show(0);
  return element("div", { class: "figure-index" },
    element("div", { class: "side" }, box, count, entries),
    element("div", {}, element("div", { class: "buttons" }, button("Figure before", () => step(-1)), button("Next figure", () => step(1))), place));
}

export function figures(pictures: Record<string, string>): HTMLElement {
  const list = Object.entries(pictures);
  if (list.length > MOST_AT_ONCE) return index(list);
  return element("div", { class: "pictures" }, ...list.map(([name, svg]) => picture(name, svg)));
}
