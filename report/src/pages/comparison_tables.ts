// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The tables of a comparison: metrics with their significance, failures with links, and what each run is.
import { type Failure, failureText, isJudged } from "../compare/failures.ts";
import { cellNote, LEVEL, type MetricRow, RIGHT_DEG, RIGHT_MM, TIE_FRAMES, TIE_POINTS, TIE_SHARE, valueText } from "../compare/metrics.ts";
import type { Comparison, Run } from "../compare/runs.ts";
import { element } from "../ui/dom.ts";
import { provenanceNode } from "./provenance.ts";

/** The part of an address after #, for a moment of an object on the timeline. */
export function momentAddress(seconds: number, id: string | undefined, tab = ""): string {
  const parts = new URLSearchParams({ t: String(Number(seconds.toFixed(3))), ...(id === undefined ? {} : { object: id }) });
  if (tab !== "") parts.set("tab", tab);
  return `#${parts.toString()}`;
}

/** A link to a moment on this page, and to the same in the run's own page where there is one. */
export function momentLinks(run: Run, seconds: number, id: string, text: string): (Node | string)[] {
  const here = element("a", { href: momentAddress(seconds, id, run.trace.hasTruth ? "errors" : "differences") }, text);
  if (run.report === undefined) return [here];
  // A page without the object may have something else of its name, such as the camera.
  const own = momentAddress(Math.max(0, seconds - run.span[0]), run.object(id)?.id);
  return [here, " (", element("a", { href: `${run.report}${own}` }, "in its own page"), ")"];
}

function runHead(run: Run): HTMLElement {
  const head = element("th", { scope: "col", class: "run" }, run.name);
  head.style.setProperty("--swatch", run.colour);
  return head;
}

const TEST = `Differences are tested by frame, on squares of errors, over the frames that all runs have. Neighbouring frames are alike, so that the test counts as many frames as are
 independent (n / (1 + 2 times the sum of the autocorrelations of the difference)) and uses Student's t. p values are raised for the number of tests in the table (Holm); with p above ${LEVEL} a
 difference is not told from chance. Runs tie only where at least ${TIE_FRAMES} frames are independent and the difference is within ${100 * TIE_SHARE} % (shares: ${TIE_POINTS} points)
 with 95 %; else they are not told apart. Right mode: within ${RIGHT_DEG} deg and ${RIGHT_MM} mm of the truth.`;

export function metricsTable({ runs, hasTruth }: Comparison, rows: MetricRow[]): HTMLElement {
  const names = runs.map(({ name }) => name);
  const head = element("tr", {}, element("th", { scope: "col" }, "quantity"), ...runs.map(runHead));
  const body = rows.flatMap((row, r) => {
    const cells = row.cells.map((cell, i) => {
      const value = valueText(cell.value, row.unit);
      const note = cellNote(row, cell, names);
      return element("td", { class: `metric ${cell.verdict}`, "data-key": `${row.entity}/${row.quantity}/${names[i]}`, "data-value": JSON.stringify(cell.value ?? null), "data-verdict": cell.verdict },
        element(cell.verdict === "best" ? "strong" : "span", {}, value), ...(note ? [element("small", {}, note)] : []));
    });
    const isFirst = r === 0 || rows[r - 1].entity !== row.entity;
    const group = isFirst ? [element("tr", { class: "first" }, element("th", { scope: "colgroup", colspan: runs.length + 1 }, row.entity))] : [];
    return [...group, element("tr", {}, element("th", { scope: "row" }, row.quantity), ...cells)];
  });
  const made = element("table", { class: "metrics" }, element("caption", { class: "hidden" }, "Metrics of the runs"), element("thead", {}, head), element("tbody", {}, ...body));
  const note = hasTruth ? TEST : `There is no ground truth: distances are between the runs and ${names[0]}, standard deviations are the runs' own, and small ones are not good ones.`;
  return element("div", {}, element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Metrics of the runs" }, made), element("p", { class: "hint notes" }, note));
}

const MOST_FAILURES = 60;

/** Where nothing failed: what was looked at, and what nobody can say. */
function noFailure({ runs, isOneRecording }: Comparison): string {
  const unjudged = runs.filter((run) => !isJudged(run)).map(({ name }) => name);
  const lacks = isOneRecording ? " No run lacks an estimate that another has." : "";
  const judged = unjudged.length < runs.length ? `No run${unjudged.length > 0 ? " with ground truth" : ""} was on a wrong mode for half a second.` : "";
  const rest = unjudged.length > 0 ? ` Without ground truth it cannot be said on which mode these are: ${unjudged.join(", ")}.` : "";
  return `${judged}${lacks}${rest}`.trim();
}

export function failureList(comparison: Comparison, failures: Failure[]): HTMLElement {
  if (failures.length === 0) return element("p", {}, noFailure(comparison));
  const items = failures.slice(0, MOST_FAILURES).map((failure) => {
    const { run, from, id, why } = failure;
    const name = element("strong", { class: "swatched" }, run.name);
    name.style.setProperty("--swatch", run.colour);
    return element("li", {}, name, ": ", ...momentLinks(run, from, id, failureText(failure)), why ? ` — ${why}.` : ".");
  });
  const left = failures.length - items.length;
  return element("div", {}, element("ul", { class: "failures" }, ...items), ...(left > 0 ? [element("p", { class: "hint" }, `${left} shorter ones are not listed.`)] : []));
}

export function runList({ runs, timeline }: Comparison): HTMLElement {
  return element("div", { class: "run-list" }, ...runs.map((run) => {
    const { trace, span: [from, until] } = run;
    const head = element("h2", { class: "swatched" }, run.name);
    head.style.setProperty("--swatch", run.colour);
    const truth = trace.hasTruth ? "with ground truth" : "without ground truth";
    const facts = `${trace.head.method}, ${trace.frames} frames, ${from.toFixed(1)} to ${until.toFixed(1)} of ${timeline.seconds[timeline.frames - 1].toFixed(1)} s, ${trace.objects.length} objects, ${truth}`;
    const provenance = provenanceNode(run.documents);
    const link = run.report === undefined ? [] : [element("p", {}, element("a", { href: run.report }, `The page of ${run.name}`))];
    return element("section", {}, head, element("p", {}, facts), ...link, ...(provenance ? [provenance] : []));
  }));
}
