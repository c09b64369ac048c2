// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Draws any two columns of a table, one line per value of a third.
import type { Json } from "../payload.ts";
import type { Table } from "../pages/files.ts";
import { choice, element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { titleOf } from "../ui/table.ts";
import { Chart, type ChartSeries, type Values } from "./chart.ts";
import { ChartGroup } from "./group.ts";

const MOST_GROUPS = 14;

export interface Choice {
  x: string;
  y: string;
  by: string;
}

const isNumber = (value: Json): value is number => typeof value === "number";

export function numericColumns({ columns, rows }: Table): string[] {
  return columns.filter((_, k) => rows.some((row) => isNumber(row[k])) && rows.every((row) => row[k] === null || isNumber(row[k])));
}

/** Columns by which rows may be grouped: words, or numbers of few values. */
export function groupColumns({ columns, rows }: Table): string[] {
  return columns.filter((_, k) => {
    const different = new Set(rows.map((row) => row[k]));
    return different.size <= MOST_GROUPS && (rows.some((row) => typeof row[k] === "string") || different.size < rows.length / 2);
  });
}

/** Mean of y over the rows with the same x and group. */
export function pivot({ columns, rows }: Table, { x, y, by }: Choice): { x: number[]; groups: string[]; values: Values[] } {
  const [ix, iy, iby] = [x, y, by].map((name) => columns.indexOf(name));
  const groupOf = (row: Json[]) => (iby < 0 ? "" : String(row[iby] ?? "–"));
  const shown = rows.filter((row) => isNumber(row[ix]) && isNumber(row[iy]));
  const xs = [...new Set(shown.map((row) => row[ix] as number))].sort((a, b) => a - b);
  const groups = [...new Set(shown.map(groupOf))];
  const values = groups.map((group) =>
    xs.map((at) => {
      const same = shown.filter((row) => groupOf(row) === group && row[ix] === at).map((row) => row[iy] as number);
      return same.length === 0 ? null : same.reduce((sum, value) => sum + value, 0) / same.length;
    }),
  );
  return { x: xs, groups, values };
}

function withUnit(column: string): string {
  const { name, unit } = titleOf(column);
  return unit ? `${name} [${unit}]` : name;
}

/** A chart of a table with lists to choose its columns from; nothing where no two columns are numbers. */
export function explorer(table: Table, preferred: Partial<Choice>): HTMLElement | undefined {
  const numeric = numericColumns(table);
  const groups = groupColumns(table);
  if (numeric.length < 2) return undefined;
  const pick = (wanted: string | undefined, list: string[], otherwise: string) => (wanted !== undefined && list.includes(wanted) ? wanted : otherwise);
  const chosen: Choice = {
    x: pick(preferred.x, numeric, numeric[0]),
    y: pick(preferred.y, numeric, numeric[1]),
    by: pick(preferred.by, groups, groups.find((name) => !numeric.includes(name)) ?? ""),
  };
  let log = false;
  const group = new ChartGroup();
  const fill = () => {
    const { x, groups: names, values } = pivot(table, chosen);
    const positive = values.every((list) => list.every((value) => value === null || value > 0));
    const series = names.map((label, k): ChartSeries => ({ label: label || withUnit(chosen.y), values: values[k], colour: colourOf(k), kind: "both" }));
    group.replace([new Chart({ title: withUnit(chosen.y), x, xLabel: withUnit(chosen.x), series, height: 300, yLog: log && positive })]);
  };
  const options = (list: string[]) => list.map((name) => [name, withUnit(name)] as const);
  fill();
  return element("div", { class: "explorer" },
    element("div", { class: "controls" },
      choice("Up", options(numeric), chosen.y, (value) => ((chosen.y = value), fill())),
      choice("Across", options(numeric), chosen.x, (value) => ((chosen.x = value), fill())),
      choice("By", [["", "–"], ...options(groups)], chosen.by, (value) => ((chosen.by = value), fill())),
      choice("Scale", [["linear", "linear"], ["log", "logarithmic"]], "linear", (value) => ((log = value === "log"), fill()))),
    group.node);
}
