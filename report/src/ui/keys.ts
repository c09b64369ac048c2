// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Keys that work wherever the focus is, but in a field of text, and their list on "?".
import { button, element } from "./dom.ts";

interface Binding {
  keys: readonly string[];
  text: string;
  press: (event: KeyboardEvent) => void;
}

/** Where these keys are the browser's own: lists of choices and radio buttons move by arrows, tabs too. */
const OWN: Readonly<Record<string, string>> = {
  ArrowLeft: "select, input[type=range], [role=tab], .scroll", ArrowRight: "select, input[type=range], [role=tab], .scroll",
  Home: "select, input[type=range], [role=tab]", End: "select, input[type=range], [role=tab]",
};
const NAMES: Readonly<Record<string, string>> = {
  " ": "Space", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓",
};

export class Keys {
  private readonly bindings: Binding[] = [];
  private readonly dialog = element("dialog", { class: "keys", "aria-label": "Keys" });

  /** Whether the pointer was used last, and whether it brought the focus to where it is. */
  private pointing = false;
  private isPointed = false;

  constructor() {
    document.addEventListener("pointerdown", () => (this.pointing = true), true);
    document.addEventListener("keydown", () => (this.pointing = false), true);
    document.addEventListener("focusin", () => (this.isPointed = this.pointing));
    document.addEventListener("keydown", (event) => this.take(event));
    document.body.append(this.dialog);
    this.add(["?"], "this list", () => this.help());
  }

  /** Keys as KeyboardEvent.key names them; "Shift+ArrowLeft" has its modifier before it. */
  add(keys: readonly string[], text: string, press: (event: KeyboardEvent) => void): void {
    this.bindings.push({ keys, text, press });
  }

  help(): void {
    const rows = this.bindings.map(({ keys, text }) => {
      const names = keys.flatMap((key, i) => {
        const [last, ...modifiers] = key.split("+").reverse();
        const name = [...modifiers.reverse(), NAMES[last] ?? (last === "" ? "+" : last)].join(" ");
        return [...(i > 0 ? [" "] : []), element("kbd", {}, name)];
      });
      return element("tr", {}, element("th", { scope: "row" }, ...names), element("td", {}, text));
    });
    this.dialog.replaceChildren(
      element("h2", {}, "Keys"), element("table", {}, element("tbody", {}, ...rows)), button("Close", () => this.dialog.close()));
    this.dialog.showModal();
  }

  private take(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || this.dialog.open) return;
    const target = event.target as HTMLElement;
    if (target.closest("input:not([type=range], [type=checkbox], [type=radio]), textarea")) return;
    const own = OWN[event.key];
    if (own !== undefined && target.closest(own)) return;
    // A button that is reached by keys is pressed by them; after a click, the space bar plays.
    if (event.key === " " && target.closest("button, summary, a, input, select") && !this.isPointed) return;
    const shifted = event.shiftKey && event.key.length > 1 ? `Shift+${event.key}` : event.key;
    const found = this.bindings.find(({ keys }) => keys.includes(shifted) || (event.key.length === 1 && keys.includes(event.key.toLowerCase())));
    if (!found) return;
    event.preventDefault();
    found.press(event);
  }
}
