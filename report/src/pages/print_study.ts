// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The summary of a study for print.
import type { Payload } from "../payload.ts";
import { chartNotes, firstChoice, tableCharts } from "../plots/explorer.ts";
import { drawTable } from "../plots/table_chart.ts";
import { linkColumn } from "../study/columns.ts";
import { shownTable } from "../study/shown.ts";
import { questionOf, storyOf } from "../study/stories.ts";
import type { Table } from "../ui/csv.ts";
import { element } from "../ui/dom.ts";
import { onPrint, printHeader, printTable, sheetOf } from "../ui/print.ts";
import { picture } from "./page.ts";
import { provenanceLines } from "./provenance.ts";
import { firstColumns } from "./study.ts";

const MOST_PANELS = 2;
const MOST_LINES = 26;
const WIDTH = 860;

function chartOf(study: string, plain: Table | undefined): Node[] {
  const table = plain && shownTable(plain);
  const first = table && firstChoice(table, firstColumns(study));
  if (!table || !first) return [];
  const { points, charts } = tableCharts(table, first);
  const shown = charts.slice(0, MOST_PANELS);
  const left = charts.length - shown.length;
  return [
    element("div", { class: "print-charts" }, ...shown.map((chart) => drawTable({ ...chart, height: 230 }, shown.length > 1 ? WIDTH / 2 - 8 : WIDTH))),
    ...chartNotes(points), ...(left > 0 ? [element("p", { class: "hint" }, `${left} more panels are in the page.`)] : []),
  ];
}

/** What is printed of a table: not standard errors, bands and links, which the page has. */
function forPrint(table: Table): Table {
  const { columns, rows } = shownTable(table);
  const link = linkColumn(table);
  const kept = columns.flatMap((name, k) => ((/(_standard_error|_error|_band_low|_band_high)$/.test(name) && k > 0) || k === link ? [] : [k]));
  return { columns: kept.map((k) => columns[k]), rows: rows.map((row) => kept.map((k) => row[k] ?? null)) };
}

/** Pictures for print are loaded when the page is, since print does not wait for them. */
export function loaded(pictures: Record<string, string>, most: number): HTMLElement[] {
  return Object.entries(pictures).slice(0, most).map(([name, svg]) => {
    const figure = picture(name, svg);
    figure.querySelector("img")?.setAttribute("loading", "eager");
    return figure;
  });
}

export function printStudy(payload: Payload, study: string, found: Record<string, Table>): void {
  const pictures = loaded(payload.pictures, 1);
  const more = Object.keys(payload.pictures).length - pictures.length;
  onPrint(() => {
    const story = storyOf(study, found).map((text) => element("p", { class: "sentence" }, text));
    const main = found["summary"] ?? found["rows"];
    const name = found["summary"] ? "summary" : "rows";
    return [
      sheetOf(printHeader(payload.title, [questionOf(study), ...provenanceLines(payload.documents)]), ...story, ...chartOf(study, found["rows"])),
      sheetOf(...pictures, ...(more > 0 ? [element("p", { class: "hint" }, `${more} more figures are in the page.`)] : []),
        ...(main ? [printTable({ name, ...forPrint(main) }, MOST_LINES)] : [])),
    ];
  });
}
