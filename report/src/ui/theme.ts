// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Dark and light theme: the preference of the system, until the reader chooses.
import { element } from "./dom.ts";

export type Theme = "light" | "dark";

const preferred = matchMedia("(prefers-color-scheme: dark)");
const listeners = new Set<() => void>();
let chosen: Theme | undefined;

export function theme(): Theme {
  return chosen ?? (preferred.matches ? "dark" : "light");
}

/** The value of a custom property of the style sheet, such as "--ink". */
export function themeColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function onTheme(change: () => void): void {
  listeners.add(change);
}

function apply(): void {
  document.documentElement.dataset["theme"] = theme();
  for (const listener of listeners) listener();
}

/** The button that changes the theme. */
export function themeButton(): HTMLButtonElement {
  const made = element("button", { type: "button", class: "theme" });
  const name = () => {
    const other = theme() === "dark" ? "light" : "dark";
    made.textContent = other === "dark" ? "Dark" : "Light";
    made.setAttribute("aria-label", `Use ${other} colours`);
  };
  made.addEventListener("click", () => {
    chosen = theme() === "dark" ? "light" : "dark";
    apply();
  });
  onTheme(name);
  name();
  return made;
}

preferred.addEventListener("change", () => {
  if (chosen === undefined) apply();
});
document.documentElement.dataset["theme"] = theme();
