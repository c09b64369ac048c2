// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Converts a table to lines: one column is x, one is y, one separates the lines.
import type { Json } from "../payload.ts";
import type { Table } from "../ui/csv.ts";

type Values = (number | null)[];

const MOST_GROUPS = 14;
const MOST_NAMES = 60;

export interface Choice {
  x: string;
  y: string;
  by: string;
}

const isNumber = (value: Json): value is number => typeof value === "number";

export function numericColumns({ columns, rows }: Table): string[] {
  return columns.filter((_, k) => rows.some((row) => isNumber(row[k])) && rows.every((row) => row[k] === null || isNumber(row[k])));
}

/** Columns by which rows may be grouped: words, or numbers with few values. */
export function groupColumns({ columns, rows }: Table): string[] {
  return columns.filter((_, k) => {
    const different = new Set(rows.map((row) => row[k]));
    return different.size <= MOST_GROUPS && (rows.some((row) => typeof row[k] === "string") || different.size < rows.length / 2);
  });
}

/** Columns of words that may stand on the x axis. */
export function nameColumns({ columns, rows }: Table): string[] {
  return columns.filter((_, k) => rows.some((row) => typeof row[k] === "string") && new Set(rows.map((row) => row[k])).size <= MOST_NAMES);
}

export interface Pivot {
  x: number[];
  /** The words on the x axis, if x is words; x is then 1, 2, ... */
  names: string[] | undefined;
  groups: string[];
  values: Values[];
}

/** Mean of y over the rows with the same x and group. */
export function pivot({ columns, rows }: Table, { x, y, by }: Choice): Pivot {
  const [ix, iy, iby] = [x, y, by].map((name) => columns.indexOf(name));
  const groupOf = (row: Json[]) => (iby < 0 ? "" : String(row[iby] ?? "–"));
  const words = rows.some((row) => typeof row[ix] === "string");
  const shown = rows.filter((row) => (words ? row[ix] !== null : isNumber(row[ix])) && isNumber(row[iy]));
  const places = [...new Set(shown.map((row) => row[ix]))];
  if (!words) places.sort((a, b) => (a as number) - (b as number));
  const groups = [...new Set(shown.map(groupOf))];
  const values = groups.map((group) =>
    places.map((at) => {
      const same = shown.filter((row) => groupOf(row) === group && row[ix] === at).map((row) => row[iy] as number);
      return same.length === 0 ? null : same.reduce((sum, value) => sum + value, 0) / same.length;
    }),
  );
  return { x: places.map((at, i) => (words ? i + 1 : (at as number))), names: words ? places.map(String) : undefined, groups, values };
}
