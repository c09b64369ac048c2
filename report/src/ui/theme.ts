// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Dark and light theme: the preference of the system, until the reader chooses.
import { element } from "./dom.ts";

export type Theme = "light" | "dark";

const preferred = matchMedia("(prefers-color-scheme: dark)");
const listeners = new Set<() => void>();
const KEY = "posemix-theme";
let chosen: Theme | undefined = kept();

/** What the reader chose last; browsers may refuse to keep anything of a page from a file. */
function kept(): Theme | undefined {
  try {
    const value = localStorage.getItem(KEY);
    return value === "light" || value === "dark" ? value : undefined;
  } catch {
    return undefined;
  }
}

function keep(value: Theme): void {
  try {
    localStorage.setItem(KEY, value);
  } catch {
    // Then the choice lasts as long as the page.
  }
}
let forced: Theme | undefined;

export function theme(): Theme {
  return forced ?? chosen ?? (preferred.matches ? "dark" : "light");
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

/** Overrules the reader's choice, as for print; undefined gives it back. */
export function forceTheme(wanted: Theme | undefined): void {
  if (forced === wanted) return;
  forced = wanted;
  apply();
}

/** The button that changes the theme. */
export function themeButton(): HTMLButtonElement {
  const made = element("button", { type: "button", class: "theme" });
  const name = () => {
    const other = theme() === "dark" ? "light" : "dark";
    made.textContent = `Use ${other} colours`;
  };
  made.addEventListener("click", () => {
    chosen = theme() === "dark" ? "light" : "dark";
    keep(chosen);
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
