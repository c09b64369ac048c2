// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Draws any two columns of a table, one line per value of a third.
import { choice, element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import type { Table } from "../ui/csv.ts";
import { titleOf } from "../ui/format.ts";
import { Chart, type ChartSeries } from "./chart.ts";
import { ChartGroup } from "./group.ts";
import { type Choice, groupColumns, nameColumns, numericColumns, pivot } from "./pivot.ts";

function withUnit(column: string): string {
  const { name, unit } = titleOf(column);
  return unit ? `${name} [${unit}]` : name;
}

/** A chart of a table with lists to choose its columns from; undefined if there is nothing to draw. */
export function explorer(table: Table, preferred: Partial<Choice>): HTMLElement | undefined {
  const numeric = numericColumns(table);
  const groups = groupColumns(table);
  const across = [...nameColumns(table), ...numeric];
  if (numeric.length < 1 || across.length < 2) return undefined;
  const pick = (wanted: string | undefined, list: string[], otherwise: string) => (wanted !== undefined && list.includes(wanted) ? wanted : otherwise);
  const chosen: Choice = {
    x: pick(preferred.x, across, across[0]),
    y: pick(preferred.y, numeric, numeric.find((name) => name !== across[0])!),
    by: pick(preferred.by, groups, groups.find((name) => !numeric.includes(name)) ?? ""),
  };
  let log = false;
  const group = new ChartGroup();
  const fill = () => {
    const { x, names, groups: lines, values } = pivot(table, chosen);
    const positive = values.every((list) => list.every((value) => value === null || value > 0));
    const series = lines.map((label, k): ChartSeries => ({ label: label || withUnit(chosen.y), values: values[k], colour: colourOf(k), kind: names ? "points" : "both" }));
    group.replace([new Chart({ title: withUnit(chosen.y), x, series, yLog: log && positive,
      height: names ? 360 : 300, ...(names ? { xNames: names } : { xLabel: withUnit(chosen.x) }) })]);
  };
  const options = (list: string[]) => list.map((name) => [name, withUnit(name)] as const);
  fill();
  return element("div", { class: "explorer" },
    element("div", { class: "controls" },
      choice("Up", options(numeric), chosen.y, (value) => ((chosen.y = value), fill())),
      choice("Across", options(across), chosen.x, (value) => ((chosen.x = value), fill())),
      choice("By", [["", "–"], ...options(groups)], chosen.by, (value) => ((chosen.by = value), fill())),
      choice("Scale", [["linear", "linear"], ["log", "logarithmic"]], "linear", (value) => ((log = value === "log"), fill()))),
    group.node);
}
