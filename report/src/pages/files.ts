// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Tables and texts of the results folder.
import type { Payload } from "../payload.ts";
import { parseCsv, type Table } from "../ui/csv.ts";
import { element } from "../ui/dom.ts";
import { table } from "../ui/table.ts";

const MOST_ROWS = 200;

export function tableNode(name: string, { columns, rows }: Table): HTMLElement {
  const shown = rows.slice(0, MOST_ROWS);
  const more = rows.length - shown.length;
  return table(
    more > 0 ? `${name}, the first ${shown.length} of ${rows.length} rows` : name,
    columns,
    shown.map((row, i) => ({
      name: String(row[0] ?? "–"),
      cells: row.slice(1).map((value, k) => ({ value, key: `${name}/${i}/${columns[k + 1]}` })),
    })),
  );
}

/** All tables and texts, folded. */
export function files(payload: Payload): HTMLElement[] {
  const folded = (name: string, node: HTMLElement) => element("details", {}, element("summary", {}, name), node);
  return [
    ...Object.entries(payload.tables).map(([name, text]) => folded(name, tableNode(name, parseCsv(text)))),
    ...Object.entries(payload.texts).map(([name, text]) => folded(name, element("pre", { class: "text" }, text))),
  ];
}
