// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the columns of a study's table are: numbers, keys that tell rows apart, units, standard errors.
import type { Json } from "../payload.ts";
import type { Table } from "../ui/csv.ts";
import { titleOf } from "../ui/format.ts";

const MOST_KEYS = 60;
const MOST_NUMBERS_AS_KEYS = 14;
/** Numbers of what was counted tell rows apart by chance only. */
const COUNTED = /(^|_)(count|frames|detections|grasps|successes|failures|runs|rows|recordings|pairs|instances|views|n)$/;
/** Names of rows that are made from others. */
const TOTALS = new Set(["all", "mean", "median", "total", "mixed"]);

/** Where the column is that leads from a row to the page of its run; -1 where there is none. */
export function linkColumn({ columns, rows }: Table): number {
  const k = columns.indexOf("report");
  const isPath = (value: Json | undefined) => value === null || value === undefined || (typeof value === "string" && value.endsWith(".html"));
  return k >= 0 && rows.every((row) => isPath(row[k])) ? k : -1;
}

export const isNumber = (value: Json | undefined): value is number => typeof value === "number";
export const isTotal = (value: Json | undefined): boolean => typeof value === "string" && TOTALS.has(value.toLowerCase());

export function columnOf({ columns, rows }: Table, name: string): Json[] {
  const k = columns.indexOf(name);
  return rows.map((row) => (k < 0 ? null : (row[k] ?? null)));
}

/** The different values of a column, in the order of the table. */
export function valuesOf(table: Table, name: string): string[] {
  return [...new Set(columnOf(table, name).filter((value) => value !== null).map(String))];
}

export function numericColumns(table: Table): string[] {
  return table.columns.filter((name) => {
    const values = columnOf(table, name);
    return values.some(isNumber) && values.every((value) => value === null || isNumber(value));
  });
}

export function wordColumns(table: Table): string[] {
  const link = linkColumn(table);
  return table.columns.filter((name, k) => k !== link && columnOf(table, name).some((value) => typeof value === "string") && valuesOf(table, name).length <= MOST_KEYS);
}

/** Columns that tell rows apart: words, and whole numbers that come again and stand before what was measured. */
export function keyColumns(table: Table): string[] {
  const words = new Set(wordColumns(table));
  const measured = table.columns.findIndex((name) => columnOf(table, name).some((value) => isNumber(value) && !Number.isInteger(value)));
  return table.columns.filter((name, k) => {
    if (words.has(name)) return valuesOf(table, name).length > 1;
    if ((measured >= 0 && k > measured) || COUNTED.test(name)) return false;
    const values = columnOf(table, name).filter((value) => value !== null);
    const different = new Set(values).size;
    return different > 1 && different <= MOST_NUMBERS_AS_KEYS && different <= values.length / 2 && values.every((value) => Number.isInteger(value));
  });
}

/** Columns whose numbers are quantities of their own, not errors of others. */
export function quantityColumns(table: Table): string[] {
  return numericColumns(table).filter((name) => !/(^|_)(standard_error|band_low|band_high)$/.test(name));
}

/** The column with the standard errors of another. */
export function errorColumnOf({ columns }: Table, y: string): string | undefined {
  const bare = y.replace(/_(deg|mm|cm|m|rad)$/, "");
  const own = [`${y}_standard_error`, `${y}_error`, `${bare}_standard_error`, `${bare}_error`].find((name) => name !== y && columns.includes(name));
  if (own !== undefined) return own;
  return /(^|_)(difference|below_best)$/.test(y) && columns.includes("standard_error") ? "standard_error" : undefined;
}

/** What must not share an axis: the row's unit, its quantity, or the unit in its name. */
export function unitOfRow(table: Table, x: string): (row: Json[]) => string {
  const given = ["unit", "quantity"].map((name) => table.columns.indexOf(name)).find((k) => k >= 0);
  if (given !== undefined) return (row) => String(row[given] ?? "");
  const k = table.columns.indexOf(x);
  return (row) => {
    const name = row[k];
    if (typeof name !== "string") return "";
    return titleOf(name).unit || (/_share$/.test(name) ? "share" : "");
  };
}

const WORDS: Readonly<Record<string, string>> = {
  kl: "KL divergence", isd: "integrated squared difference", anees: "ANEES", nees: "NEES", rmse: "RMSE", sd: "standard deviation",
  auc: "AUC", mssd: "MSSD", brier: "Brier score", bic: "BIC", dof: "degrees of freedom", px: "px", std: "standard deviation",
};

/** A column's name in words, and its unit: "robot rotation RMSE [deg]". */
export function spoken(column: string): string {
  const { name, unit } = titleOf(column);
  const words = name.split(" ").map((word) => WORDS[word] ?? word).join(" ");
  return unit ? `${words} [${unit}]` : words;
}
