// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The plots of tracks: health, existence, and models of motion.
import { Chart, type ChartSeries } from "../plots/chart.ts";
import type { ChartGroup } from "../plots/group.ts";
import { valuesOf } from "../plots/series.ts";
import { healthChart, marksLegend, wordsThatOccur } from "../plots/statuses.ts";
import type { RunState } from "../state/run_state.ts";
import { element } from "../ui/dom.ts";
import { colourOf, HEALTH_MARKS } from "../ui/palette.ts";
import type { Plots, PlotTab } from "./plot_settings.ts";

function probabilities(state: RunState, title: string, series: ChartSeries[]): Chart {
  return new Chart({ title, x: state.trace.seconds, series, range: [-0.02, 1.02], height: 200, seek: (seconds) => state.seek(seconds) });
}

/** Health and existence of every object, and the probabilities of the models of those that move. */
export function trackPlots({ state }: Plots, group: ChartGroup): PlotTab {
  const { trace } = state;
  const charts: Chart[] = [];
  const hasHealth = trace.objects.some(({ health }) => health !== undefined);
  if (hasHealth) charts.push(healthChart(state));
  const existing = trace.objects.flatMap(({ id, existence }, i): ChartSeries[] =>
    existence ? [{ label: id, colour: colourOf(i), values: valuesOf(trace.frames, existence), select: () => state.select(i) }] : []);
  if (existing.length > 0) charts.push(probabilities(state, "probability that the object exists", existing));
  for (const { id, models } of trace.objects) {
    if (!models) continue;
    const series = models.names.map((name, k) => ({ label: name, colour: colourOf(k), values: valuesOf(trace.frames, (frame) => models.probability(k, frame)) }));
    charts.push(probabilities(state, `models of motion of ${id}`, series));
  }
  group.replace(charts);
  state.on("selection", () => group.redraw());
  const again = trace.objects.some(({ registerAgain }) => registerAgain?.some((value) => value !== 0));
  const node = element("div", {}, group.node);
  if (hasHealth) node.append(marksLegend(wordsThatOccur(trace.objects.map(({ health }) => ({ values: health })), trace.healths), HEALTH_MARKS));
  if (again) node.append(element("p", { class: "hint" }, "A line above a band: the object should be registered again."));
  return { node, opened: () => {} };
}
