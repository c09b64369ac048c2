// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { Json } from "../payload.ts";
import { element } from "./dom.ts";
import { formatted, titleOf } from "./format.ts";

export interface Cell {
  value: Json | undefined;
  /** Its path in the document, as an attribute for tests and scripts. */
  key?: string;
}

/** A table with a row per name; it scrolls sideways on a narrow page. */
export function table(caption: string, columns: string[], rows: { name: string; cells: Cell[] }[]): HTMLElement {
  const head = element("tr");
  for (const column of columns) {
    const { name, unit } = titleOf(column);
    // A corner without a name heads nothing.
    head.append(element(column === "" ? "td" : "th", column === "" ? {} : { scope: "col" }, name, ...(unit ? [element("span", { class: "unit" }, ` [${unit}]`)] : [])));
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
