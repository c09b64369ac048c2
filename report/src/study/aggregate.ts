// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Points of a chart from the rows of a table. Where several rows make one point, the point says how many, and over what.
import { quantileOfSorted } from "../math/statistics.ts";
import type { Json } from "../payload.ts";
import type { Table } from "../ui/csv.ts";
import { columnOf, errorColumnOf, isNumber, isTotal, keyColumns, spoken, unitOfRow, valuesOf, wordColumns } from "./columns.ts";

export const MOST_GROUPS = 14;

export interface Choice {
  x: string;
  y: string;
  by: string;
  reduce: "mean" | "median";
  /** The only value of a column that is drawn, by column. */
  filters: Record<string, string>;
  /** Whether rows named all, mean or median are drawn beside those that they are made from. */
  totals: boolean;
}

export interface Point {
  x: string | number;
  value: number;
  /** The ends of the bar about the value. */
  low: number | undefined;
  high: number | undefined;
  rows: number;
}

export interface Line {
  group: string;
  /** The place among all groups of the table, so that a filter changes no colours. */
  index: number;
  points: Point[];
}

export interface Panel {
  unit: string;
  lines: Line[];
}

export interface Points {
  panels: Panel[];
  /** Whether x is words; else numbers. */
  words: boolean;
  names: string[];
  groups: string[];
  /** What a reader must know: how many rows a point is, what is left out. */
  notes: string[];
}

function pointOf(x: string | number, values: number[], errors: (number | null)[], reduce: Choice["reduce"]): Point {
  const rows = values.length;
  if (rows === 1) {
    const error = errors[0];
    return { x, value: values[0], rows, low: error === null ? undefined : values[0] - error, high: error === null ? undefined : values[0] + error };
  }
  if (reduce === "median") {
    const sorted = [...values].sort((a, b) => a - b);
    return { x, value: quantileOfSorted(sorted, 0.5), rows, low: quantileOfSorted(sorted, 0.25), high: quantileOfSorted(sorted, 0.75) };
  }
  const mean = values.reduce((sum, value) => sum + value, 0) / rows;
  const se = Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / (rows - 1) / rows);
  return { x, value: mean, rows, low: mean - se, high: mean + se };
}

/** The columns that a chart can be narrowed to one value of. */
export function filterColumns(table: Table, { x, by }: Pick<Choice, "x" | "by">): string[] {
  return keyColumns(table).filter((name) => ![x, by, "unit", "quantity"].includes(name)).slice(0, 8);
}

/** What totals there are in a column, each once. */
function totalsIn(rows: Json[][], k: number): string[] {
  return [...new Set(rows.filter((row) => isTotal(row[k])).map((row) => String(row[k])))];
}

/** The rows that are left after the filters and without totals, and what was left out. A total stays where it is what the reader chose. */
export function chosenRows(table: Table, choice: Choice): { rows: Json[][]; notes: string[] } {
  const notes: string[] = [];
  const filters = Object.entries(choice.filters).filter(([name, value]) => value !== "" && table.columns.includes(name));
  let rows = table.rows.filter((row) => filters.every(([name, value]) => String(row[table.columns.indexOf(name)]) === value));
  if (choice.totals) return { rows, notes };
  table.columns.forEach((name, k) => {
    if (["unit", "quantity"].includes(name) || filters.some(([filtered]) => filtered === name)) return;
    const totals = totalsIn(rows, k);
    if (totals.length === 0) return;
    const kept = rows.filter((row) => !isTotal(row[k]));
    if (kept.length > 0) {
      notes.push(`Left out: ${rows.length - kept.length} rows whose ${spoken(name)} is ${totals.join(" or ")}.`);
      rows = kept;
    } else if (totals.length > 1) {
      // A mean and a median of the same rows have no mean.
      const own = totals.find((total) => total.toLowerCase() === choice.reduce) ?? totals[0];
      rows = rows.filter((row) => String(row[k]) === own);
      notes.push(`Only rows whose ${spoken(name)} is ${own} are drawn, not those of ${totals.filter((total) => total !== own).join(" or ")}.`);
    }
  });
  return { rows, notes };
}

const isWhole = (value: string) => ["all", "total"].includes(value.toLowerCase());

/** Filters to begin with: where a column has a row over all, that one, so that the page need not average; not where only means of other columns have one. */
export function firstFilters(table: Table, choice: Choice): Record<string, string> {
  const filters: Record<string, string> = {};
  const names = filterColumns(table, choice);
  const under = (chosen: Record<string, string>): Table => ({ columns: table.columns, rows: chosenRows(table, { ...choice, totals: true, filters: chosen }).rows });
  for (const name of names) {
    const total = valuesOf(under(filters), name).find(isWhole);
    if (total === undefined) continue;
    const chosen = { ...filters, [name]: total };
    const left = under(chosen);
    const isMeans = (other: string) => !Object.hasOwn(chosen, other) && valuesOf(left, other).every((value) => isTotal(value) && !isWhole(value)) && valuesOf(left, other).length > 0;
    if (!names.some(isMeans)) filters[name] = total;
  }
  return filters;
}

/** The other columns whose values differ among the rows of one point. */
function averagedOver(table: Table, choice: Choice, cells: Json[][][]): string[] {
  return keyColumns(table).filter((name) => {
    if (name === choice.x || name === choice.by || name === choice.y) return false;
    const k = table.columns.indexOf(name);
    return cells.some((rows) => new Set(rows.map((row) => row[k])).size > 1);
  });
}

function countNote(choice: Choice, cells: Json[][][], over: string[]): string {
  const counts = cells.map((rows) => rows.length);
  const [least, most] = [Math.min(...counts), Math.max(...counts)];
  const range = least === most ? `${most}` : `${least} to ${most}`;
  const across = over.length > 0 ? `, over ${over.map((name) => spoken(name)).join(", ")}` : "";
  const bars = choice.reduce === "mean" ? "bars are one standard error of that mean" : "bars are the quartiles";
  return `Each point is the ${choice.reduce} of ${range} rows${across}; ${bars}.`;
}

/** The groups that are drawn, by their place in the table; more than fit are cut to those with the most rows. */
function shownGroups(groups: string[], cells: Map<string, Json[][]>[], all: boolean): string[] {
  if (all || groups.length <= MOST_GROUPS) return groups;
  const rows = (group: string) => cells.reduce((sum, one) => sum + (one.get(group)?.length ?? 0), 0);
  const top = [...groups].sort((a, b) => rows(b) - rows(a)).slice(0, MOST_GROUPS);
  return groups.filter((group) => top.includes(group));
}

/** `allGroups`: however many there are, as when each has a panel of its own. */
export function pointsOf(table: Table, choice: Choice, allGroups = false): Points {
  const { columns } = table;
  const [ix, iy, iby] = [choice.x, choice.y, choice.by].map((name) => columns.indexOf(name));
  const words = wordColumns(table).includes(choice.x);
  const { rows: left, notes } = chosenRows(table, choice);
  const rows = left.filter((row) => (words ? row[ix] !== null : isNumber(row[ix])) && isNumber(row[iy]));
  const everyGroup = iby < 0 ? [""] : valuesOf(table, choice.by).filter((value) => choice.totals || !isTotal(value));
  const groupOf = (row: Json[]) => (iby < 0 ? "" : String(row[iby] ?? "–"));
  const unitOf = unitOfRow(table, choice.x);
  const units = [...new Set(rows.map(unitOf))];
  const errorColumn = errorColumnOf(table, choice.y);
  const ie = errorColumn === undefined ? -1 : columns.indexOf(errorColumn);
  const present = [...new Set(rows.map(groupOf))];
  const byGroup = [new Map(present.map((group) => [group, rows.filter((row) => groupOf(row) === group)]))];
  const groups = shownGroups(present, byGroup, allGroups);
  if (groups.length < present.length) notes.push(`${groups.length} of ${present.length} groups are shown, those with the most rows; a panel per group shows all.`);
  const cells: Json[][][] = [];
  const panels = units.map((unit): Panel => ({
    unit,
    lines: groups.map((group): Line => {
      const own = (byGroup[0].get(group) ?? []).filter((row) => unitOf(row) === unit);
      const places = [...new Set(own.map((row) => row[ix] as string | number))];
      if (!words) places.sort((a, b) => (a as number) - (b as number));
      const points = places.map((x) => {
        const same = own.filter((row) => row[ix] === x);
        cells.push(same);
        return pointOf(x, same.map((row) => row[iy] as number), same.map((row) => (ie >= 0 && isNumber(row[ie]) ? (row[ie] as number) : null)), choice.reduce);
      });
      return { group, index: Math.max(0, everyGroup.indexOf(group)), points };
    }).filter(({ points }) => points.length > 0),
  }));
  if (cells.some((same) => same.length > 1)) notes.unshift(countNote(choice, cells, averagedOver(table, choice, cells)));
  else if (ie >= 0) notes.unshift("Each point is one row; bars are one standard error, as the table has it.");
  else notes.unshift("Each point is one row.");
  const names = words ? [...new Set(columnOf({ columns, rows }, choice.x).map(String))] : [];
  return { panels, words, names, groups, notes };
}
