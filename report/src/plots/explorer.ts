// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Draws any two columns of a table, one line per value of a third, and says what every point is made of.
import { type Choice, filterColumns, firstFilters, type Points, pointsOf } from "../study/aggregate.ts";
import { isTotal, keyColumns, numericColumns, quantityColumns, spoken, valuesOf, wordColumns } from "../study/columns.ts";
import { shownName, shownTable } from "../study/shown.ts";
import { choice, element, toggle } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import type { Table } from "../ui/csv.ts";
import { key, responsive } from "./drawing.ts";
import { drawTable, type TableChart } from "./table_chart.ts";

interface Settings extends Choice {
  log: boolean;
  /** A panel for every group. */
  apart: boolean;
}

/** The choice that the chart of a table in shown units begins with, from names of columns as they are in files; undefined if there is nothing to draw. */
export function firstChoice(table: Table, preferred: Partial<Choice>): Choice | undefined {
  const numbers = quantityColumns(table);
  const across = [...new Set([...wordColumns(table), ...numericColumns(table)])];
  if (numbers.length < 1 || across.length < 2) return undefined;
  const pick = (wanted: string | undefined, list: string[], otherwise: string) => [wanted, wanted === undefined ? undefined : shownName(wanted)].find((name) => name !== undefined && list.includes(name)) ?? otherwise;
  const x = pick(preferred.x, across, across[0]);
  const y = pick(preferred.y, numbers, numbers.find((name) => name !== x) ?? numbers[0]);
  const keys = keyColumns(table).filter((name) => name !== x && name !== y);
  // A grouping that is wished for and is not there is none, rather than another one.
  const by = pick(preferred.by, keys, preferred.by !== undefined ? "" : (keys.find((name) => !numbers.includes(name) && name !== "unit") ?? ""));
  const first: Choice = { x, y, by, reduce: preferred.reduce ?? "mean", filters: {}, totals: false };
  return { ...first, filters: firstFilters(table, first) };
}

function unitLabel(points: Points, y: string, unit: string): string {
  const label = spoken(y);
  return unit === "" || points.panels.length === 0 || label.includes("[") ? label : `${label} [${unit}]`;
}

/** The panels of a choice. */
export function tableCharts(table: Table, choice: Choice, log = false, apart = false): { points: Points; charts: TableChart[] } {
  const points = pointsOf(table, choice, apart);
  const charts = points.panels.flatMap((panel): TableChart[] => {
    const yLabel = unitLabel(points, choice.y, panel.unit);
    const chart: TableChart = { title: `${yLabel}, by ${spoken(choice.x)}`, xLabel: spoken(choice.x), yLabel, names: points.names, words: points.words, panel, log };
    if (!apart) return [chart];
    return panel.lines.map((line) => ({ ...chart, title: `${line.group}: ${yLabel}`, panel: { unit: panel.unit, lines: [line] }, height: 220 }));
  });
  return { points, charts: charts.filter(({ panel }) => panel.lines.length > 0) };
}

export function chartFigure(chart: TableChart): HTMLElement {
  return element("figure", { class: "drawn-table" }, element("figcaption", {}, chart.title), responsive((width) => drawTable({ ...chart, isCaptioned: true }, width)));
}

/** The key of the groups, and what a point is. */
export function chartNotes(points: Points): HTMLElement[] {
  const lines = new Map(points.panels.flatMap(({ lines }) => lines.map(({ group, index }) => [group, index] as const)));
  const entries = [...lines].filter(([group]) => group !== "").map(([name, index]) => ({ name, colour: colourOf(index), shape: index }));
  return [
    ...(entries.length > 0 ? [key(entries)] : []),
    element("p", { class: "hint notes" }, points.notes.join(" ")),
  ];
}

const options = (list: string[]) => list.map((name) => [name, spoken(name)] as const);

class Explorer {
  readonly node = element("div", { class: "explorer" });
  private readonly place = element("div", { class: "panels" });
  private readonly filters = element("div", { class: "controls filters" });
  private readonly settings: Settings;

  constructor(private readonly table: Table, first: Choice) {
    this.settings = { ...first, log: false, apart: false };
    this.node.append(this.controls(), this.filters, this.place);
    this.showFilters();
    this.fill();
  }

  private controls(): HTMLElement {
    const { table, settings } = this;
    const numbers = quantityColumns(table);
    const across = [...new Set([...wordColumns(table), ...numericColumns(table)])];
    const set = (change: () => void) => this.set(change);
    const other = (change: () => void) => {
      change();
      settings.filters = firstFilters(table, settings);
      this.showFilters();
      this.fill();
    };
    return element("div", { class: "controls" },
      choice("Value", options(numbers), settings.y, (value) => other(() => (settings.y = value))),
      choice("Against", options(across), settings.x, (value) => other(() => (settings.x = value))),
      choice("Group by", [["", "nothing"], ...options(keyColumns(table))], settings.by, (value) => other(() => (settings.by = value))),
      choice("Scale", [["linear", "linear"], ["log", "logarithmic"]], "linear", (value) => set(() => (settings.log = value === "log"))),
      choice("Several rows", [["mean", "mean"], ["median", "median"]], settings.reduce, (value) => set(() => (settings.reduce = value as Choice["reduce"]))),
      toggle("A panel per group", settings.apart, (on) => set(() => (settings.apart = on))),
      ...(table.rows.some((row) => row.some(isTotal)) ? [toggle("Rows of all, mean, median", settings.totals, (on) => set(() => (settings.totals = on)))] : []));
  }

  private showFilters(): void {
    const { table, settings } = this;
    this.filters.replaceChildren(...filterColumns(table, settings).map((name) =>
      choice(`Only ${spoken(name)}`, [["", "every"], ...valuesOf(table, name).map((value) => [value, value] as const)], settings.filters[name] ?? "",
        (value) => this.set(() => (settings.filters[name] = value)))));
  }

  private set(change: () => void): void {
    change();
    this.fill();
  }

  private fill(): void {
    const { settings } = this;
    const { points, charts } = tableCharts(this.table, settings, settings.log, settings.apart);
    const isEmpty = charts.length === 0;
    this.place.classList.toggle("apart", settings.apart);
    this.place.replaceChildren(
      ...(isEmpty ? [element("p", { class: "notice" }, "No row has both values under these filters.")] : chartNotes(points)),
      element("div", { class: "panel-grid" }, ...charts.map(chartFigure)));
  }
}

/** A chart of a table with lists to choose its columns from; undefined if there is nothing to draw. */
export function explorer(plain: Table, preferred: Partial<Choice>): HTMLElement | undefined {
  const table = shownTable(plain);
  const first = firstChoice(table, preferred);
  return first && new Explorer(table, first).node;
}
