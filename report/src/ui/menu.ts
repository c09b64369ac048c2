// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A small menu below the button that opens it.
import { button, element } from "./dom.ts";

export interface MenuItem {
  text: string;
  press: () => void;
}

/** Opens a menu at a button; it closes by a choice, by Escape, and when the focus leaves it. */
export function openMenu(at: HTMLElement, label: string, items: readonly MenuItem[]): void {
  const menu = element("div", { class: "menu", role: "menu", "aria-label": label });
  let isClosed = false;
  const close = (back: boolean) => {
    // To remove what has the focus takes the focus from it, which closes too.
    if (isClosed) return;
    isClosed = true;
    menu.remove();
    at.setAttribute("aria-expanded", "false");
    if (back) at.focus();
  };
  const entries = items.map(({ text, press }) => button(text, () => (close(true), press()), { role: "menuitem", tabindex: -1 }));
  menu.append(...entries);
  menu.addEventListener("keydown", (event) => {
    const step: Record<string, number> = { ArrowDown: 1, ArrowUp: -1 };
    const now = entries.indexOf(document.activeElement as HTMLButtonElement);
    if (event.key === "Escape" || event.key === "Tab") close(true);
    else if (event.key in step) entries[(now + step[event.key] + entries.length) % entries.length].focus();
    else if (event.key !== "Enter" && event.key !== " ") return;
    // Keys of the page have no business in an open menu; Enter and Space press the entry.
    event.stopPropagation();
    if (event.key !== "Enter" && event.key !== " ") event.preventDefault();
  });
  menu.addEventListener("focusout", (event) => {
    if (!menu.contains(event.relatedTarget as Node | null)) close(false);
  });
  document.body.append(menu);
  at.setAttribute("aria-expanded", "true");
  const box = at.getBoundingClientRect();
  menu.style.left = `${Math.max(4, Math.min(box.left, innerWidth - menu.offsetWidth - 4))}px`;
  const below = box.bottom + 4;
  menu.style.top = `${below + menu.offsetHeight > innerHeight ? Math.max(4, box.top - menu.offsetHeight - 4) : below}px`;
  entries[0].focus();
}
