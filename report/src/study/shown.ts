// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Small lengths are shown in mm, in whichever unit a table has them, so that columns beside each other can be compared.
import { median } from "../math/statistics.ts";
import type { Json } from "../payload.ts";
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
  const sizes = [...scales].flatMap(([name, scale]) => columnOf(table, name).filter(isNumber).map((value) => scale * Math.abs(value)));
  return median(sizes) < MOST_MM ? scales : new Map<string, number>();
}

export const shownName = (name: string): string => name.replace(LENGTH, "_mm");

/** Columns whose numbers have the unit that their row names, if it names one. */
const OF_ROW = /(^|_)(mean|sd|rms|median|value)(_of_recordings)?(_standard_error|_error)?$|^standard_error$/;

/** What numbers of a row are multiplied by to be in mm, 1 where they are no lengths; undefined where no row has lengths, or they are large. */
function rowScale(table: Table): ((row: Json[]) => number) | undefined {
  const unit = table.columns.indexOf("unit");
  const scale = (row: Json[]) => (row[unit] === "m" || row[unit] === "cm" ? MM[row[unit]] : 1);
  const sizes = table.rows.filter((row) => scale(row) !== 1).flatMap((row) =>
    row.filter((value, k): value is number => isNumber(value) && OF_ROW.test(table.columns[k])).map((value) => scale(row) * Math.abs(value)));
  return median(sizes) < MOST_MM ? scale : undefined;
}

/** A table as the page shows it, with its lengths in mm. */
export function shownTable(table: Table): Table {
  const [scales, ofRow] = [lengthScales(table), rowScale(table)];
  if (scales.size === 0 && ofRow === undefined) return table;
  const factors = table.columns.map((name) => scales.get(name));
  const hasUnit = table.columns.map((name) => OF_ROW.test(name));
  const shown = (value: Json, k: number, own: number): Json => {
    if (isNumber(value)) return (factors[k] ?? (hasUnit[k] ? own : 1)) * value;
    return own !== 1 && table.columns[k] === "unit" ? "mm" : value;
  };
  return {
    columns: table.columns.map((name) => (scales.has(name) ? shownName(name) : name)),
    rows: table.rows.map((row) => {
      const own = ofRow?.(row) ?? 1;
      return row.map((value, k) => shown(value, k, own));
    }),
  };
}
