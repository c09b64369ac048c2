// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The summary of a comparison for print.
import { type Failure, failureText } from "../compare/failures.ts";
import { failureSentence } from "../compare/verdict.ts";
import { cellNote, type MetricRow, valueText } from "../compare/metrics.ts";
import type { Comparison, Values } from "../compare/runs.ts";
import type { Payload } from "../payload.ts";
import { key } from "../plots/drawing.ts";
import { timePlot } from "../plots/time_plot.ts";
import type { Viewport } from "../scene/viewport.ts";
import { element } from "../ui/dom.ts";
import { onPrint, printHeader, scenePicture, sheetOf } from "../ui/print.ts";
import { provenanceLines } from "./provenance.ts";

const MOST_FAILURES = 3;
const MOST_ROWS = 18;
const PLOT = { width: 430, height: 190 };

function metricsOf({ runs }: Comparison, rows: MetricRow[]): HTMLElement {
  const names = runs.map(({ name }) => name);
  const shown = rows.slice(0, MOST_ROWS);
  const left = rows.length - shown.length;
  const body = shown.map((row) => element("tr", {}, element("th", {}, `${row.entity}: ${row.quantity}`), ...row.cells.map((cell) =>
    element("td", {}, element(cell.verdict === "best" ? "strong" : "span", {}, valueText(cell.value, row.unit)), " ", element("small", {}, cellNote(row, cell, names).split(";").slice(0, 2).join(";"))))));
  return element("div", { class: "print-table wrapped" }, element("h2", {}, left > 0 ? `Metrics (the first ${shown.length} of ${rows.length})` : "Metrics"),
    element("table", {}, element("thead", {}, element("tr", {}, element("th", {}, ""), ...names.map((name) => element("th", {}, name)))), element("tbody", {}, ...body)));
}

/** Errors of the camera, and of the object that failed or differs most; without truth the runs' own 99.7 % bound. */
function plots({ runs, timeline, hasTruth }: Comparison, id: string | undefined): HTMLElement {
  const what = hasTruth ? "error" : "own 99.7 % bound";
  const plot = (of: string | undefined, pick: "distance" | "angle", title: string) => {
    const series = runs.flatMap((run) => {
      const values: Values | undefined = (hasTruth ? run.error(of) : run.sigma(of))?.[pick];
      return values ? [{ name: run.name, colour: run.colour, values }] : [];
    });
    return series.length > 0 ? [timePlot({ title, seconds: timeline.seconds, series, ...PLOT })] : [];
  };
  return element("div", { class: "print-plots" },
    ...plot(undefined, "distance", `camera: position ${what} [mm]`), ...plot(undefined, "angle", `camera: rotation ${what} [deg]`),
    ...(id === undefined ? [] : [...plot(id, "distance", `${id} from the camera: position ${what} [mm]`), ...plot(id, "angle", `${id} from the camera: rotation ${what} [deg]`)]));
}

export function printComparison(
  payload: Payload, comparison: Comparison, rows: MetricRow[], failures: Failure[], sentences: string[], viewport: () => Viewport | undefined, moment: () => string,
): void {
  onPrint(() => {
    const { runs, cautions, ids } = comparison;
    const facts = runs.map((run) => [`${run.name}: ${run.trace.head.method}, ${run.trace.frames} frames`, provenanceLines(run.documents)[0] ?? ""].filter((text) => text !== "").join(" · "));
    const texts = [failureSentence(comparison, failures), ...failures.slice(0, MOST_FAILURES).map((failure) => `${failure.run.name}: ${failureText(failure)} — ${failure.why}.`), ...sentences, ...cautions];
    return [
      sheetOf(printHeader(payload.title, facts), ...texts.map((text) => element("p", { class: "sentence" }, text)), key(runs.map(({ name, colour }) => ({ name, colour }))),
        ...scenePicture(viewport(), `All runs at ${moment()}; grey: the truth`)),
      sheetOf(plots(comparison, failures[0]?.id ?? ids[0]), metricsOf(comparison, rows)),
    ];
  });
}
