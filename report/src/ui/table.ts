// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { Json } from "../payload.ts";
import { element } from "./dom.ts";

/** A number as tables show it, four significant digits; a missing one is a dash. */
export function formatted(value: Json | undefined): string {
  if (value === null || value === undefined || value === "") return "–";
  if (typeof value !== "number") return typeof value === "object" ? JSON.stringify(value) : String(value);
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e7) return value.toExponential(3);
  return String(Number(value.toPrecision(4)));
}

const UNITS: readonly (readonly [string, string])[] = [
  ["_deg", "deg"], ["_mm", "mm"], ["_m", "m"], ["_rad", "rad"], ["_us", "µs"], ["_ms", "ms"], ["_s", "s"],
];

/** The name and unit of a key such as position_rmse_m. */
export function titleOf(key: string): { name: string; unit: string } {
  for (const [end, unit] of UNITS) {
    if (key.endsWith(end)) return { name: key.slice(0, -end.length).replaceAll("_", " "), unit };
  }
  return { name: key.replaceAll("_", " "), unit: "" };
}

export interface Cell {
  value: Json | undefined;
  /** Where it is in its document, for those who look for it. */
  key?: string;
}

/** A table with a row per name; it scrolls sideways where the page is narrow. */
export function table(caption: string, columns: string[], rows: { name: string; cells: Cell[] }[]): HTMLElement {
  const head = element("tr");
  for (const column of columns) {
    const { name, unit } = titleOf(column);
    head.append(element("th", { scope: "col" }, name, ...(unit ? [element("span", { class: "unit" }, ` [${unit}]`)] : [])));
  }
  const body = element("tbody");
  for (const row of rows) {
    const line = element("tr", {}, element("th", { scope: "row" }, row.name));
    for (const cell of row.cells) {
      const number = typeof cell.value === "number";
      const attributes = { class: number ? "number" : "", ...(cell.key ? { "data-key": cell.key, "data-value": JSON.stringify(cell.value ?? null) } : {}) };
      line.append(element("td", attributes, formatted(cell.value)));
    }
    body.append(line);
  }
  const made = element("table", {}, element("caption", {}, caption), element("thead", {}, head), body);
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption }, made);
}
