// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Small lengths are shown in mm, in whichever unit a table has them, so that columns beside each other can be compared.
import type { Table } from "../ui/csv.ts";
import { columnOf, isNumber } from "./columns.ts";

const LENGTH = /_(m|cm)(?=$|_(standard_error|error|band_low|band_high)$)/;
const MM: Readonly<Record<string, number>> = { m: 1000, cm: 10 };
/** Beyond this a table is of distances rather than of errors [mm]. */
const MOST_MM = 1000;

/** What the values of columns are multiplied by to be in mm, by their names; empty where lengths are large. */
export function lengthScales(table: Table): Map<string, number> {
  const scales = new Map(table.columns.flatMap((name) => {
    const unit = LENGTH.exec(name)?.[1];
    return unit === undefined || !columnOf(table, name).every((value) => value === null || isNumber(value)) ? [] : [[name, MM[unit]] as const];
  }));
  const sizes = [...scales].flatMap(([name, scale]) => columnOf(table, name).filter(isNumber).map((value) => scale * Math.abs(value))).sort((a, b) => a - b);
  return sizes.length > 0 && sizes[Math.floor(sizes.length / 2)] < MOST_MM ? scales : new Map<string, number>();
}

export const shownName = (name: string): string => name.replace(LENGTH, "_mm");

/** A table with its lengths in mm, as charts and print have it. */
export function shownTable(table: Table): Table {
  const scales = lengthScales(table);
  if (scales.size === 0) return table;
  const factors = table.columns.map((name) => scales.get(name) ?? 1);
  return {
    columns: table.columns.map((name) => (scales.has(name) ? shownName(name) : name)),
    rows: table.rows.map((row) => row.map((value, k) => (isNumber(value) ? factors[k] * value : value))),
  };
}
