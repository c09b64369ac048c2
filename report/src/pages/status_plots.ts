// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The status of the detections over time, and counted.
import type { ChartGroup } from "../plots/group.ts";
import { countStatuses, marksLegend, statusChart, wordsThatOccur } from "../plots/statuses.ts";
import type { RunState } from "../state/run_state.ts";
import { button, element } from "../ui/dom.ts";
import { STATUS_MARKS } from "../ui/palette.ts";
import { notice, type Plots, type PlotTab } from "./plot_settings.ts";

/** Frames by status; a press on a name selects the object. */
function countTable(state: RunState, words: readonly string[]): HTMLElement {
  const { trace } = state;
  const counts = countStatuses(trace);
  const columns = words.map((word) => trace.statuses.indexOf(word));
  const rows = trace.objects.map(({ id }, i) => element("tr", {},
    element("th", { scope: "row" }, button(id, () => state.select(i), { class: "plain", title: `Select ${id}` })),
    ...columns.map((k) => element("td", { class: "number" }, String(counts[i][k])))));
  const mark = () => rows.forEach((row, i) => row.classList.toggle("highlighted", state.selected === i));
  state.on("selection", mark);
  mark();
  const head = element("tr", {}, element("th", { scope: "col" }, "object"), ...words.map((word) => element("th", { scope: "col" }, word)));
  const made = element("table", { class: "counts" }, element("caption", {}, "Frames by status"), element("thead", {}, head), element("tbody", {}, ...rows));
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Frames by status" }, made);
}

export function statusPlots({ state }: Plots, group: ChartGroup): PlotTab {
  const { trace } = state;
  if (trace.objects.length === 0) return { node: notice("The run has no objects."), opened: () => {} };
  const words = wordsThatOccur(trace.objects.map(({ status }) => ({ values: status })), trace.statuses);
  group.replace([statusChart(state)]);
  state.on("selection", () => group.redraw());
  const hint = element("p", { class: "hint" }, "A row per object; a press goes to that time and selects the object. Short marks are drawn at least 3 pixels wide.");
  return { node: element("div", {}, hint, group.node, marksLegend(words, STATUS_MARKS), countTable(state, words)), opened: () => {} };
}
