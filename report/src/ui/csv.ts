// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Tables of the results folder.
import { isObject, type Json } from "../payload.ts";

export interface Table {
  columns: string[];
  rows: Json[][];
}

function cellsOf(line: string): string[] {
  const cells: string[] = [];
  const pattern = /\s*(?:"((?:[^"]|"")*)"|([^,]*))\s*(?:,|$)/y;
  while (pattern.lastIndex < line.length) {
    const match = pattern.exec(line);
    if (!match) break;
    cells.push(match[1] !== undefined ? match[1].replaceAll('""', '"') : match[2].trim());
  }
  if (line.endsWith(",")) cells.push("");
  return cells;
}

/** Comma-separated values with a line of names; numbers become numbers. */
export function parseCsv(text: string): Table {
  const lines = text.split(/\r?\n/).filter((line) => line !== "" && !line.startsWith("#"));
  const rows = lines.slice(1).map((line) =>
    cellsOf(line).map((cell) => (cell === "" ? null : Number.isFinite(Number(cell)) ? Number(cell) : cell)),
  );
  return { columns: lines.length > 0 ? cellsOf(lines[0]) : [], rows };
}

/** Rows that are objects, as a table: the keys of all of them are the columns. */
export function tableOfRows(rows: Json): Table {
  const objects = Array.isArray(rows) ? rows.filter(isObject) : [];
  const columns = [...new Set(objects.flatMap((row) => Object.keys(row)))];
  return { columns, rows: objects.map((row) => columns.map((column) => row[column] ?? null)) };
}
