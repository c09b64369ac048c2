// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Elements of the page. Text is always set as text, never as markup.

type Attributes = Record<string, string | number | boolean>;

/** A new element; attributes that are false are left out. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== false) made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children);
  return made;
}

export function button(text: string, press: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const made = element("button", { type: "button", ...attributes }, text);
  made.addEventListener("click", press);
  return made;
}

/** A labelled box to tick. */
export function toggle(text: string, on: boolean, change: (on: boolean) => void): HTMLLabelElement {
  const box = element("input", { type: "checkbox" });
  box.checked = on;
  box.addEventListener("change", () => change(box.checked));
  return element("label", { class: "toggle" }, box, text);
}

/** A labelled list to choose from; the options are [value, text]. */
export function choice(
  text: string,
  options: readonly (readonly [string, string])[],
  chosen: string,
  change: (value: string) => void,
): HTMLLabelElement {
  const list = element("select", { "aria-label": text });
  for (const [value, name] of options) list.append(element("option", { value, selected: value === chosen }, name));
  list.addEventListener("change", () => change(list.value));
  return element("label", { class: "choice" }, element("span", {}, text), list);
}
