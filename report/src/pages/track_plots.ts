// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The plots of tracks: health, existence, and models of motion.
import { Chart, type ChartSeries } from "../plots/chart.ts";
import type { ChartGroup } from "../plots/group.ts";
import { healthChart, marksLegend } from "../plots/statuses.ts";
import type { Trace } from "../trace/trace.ts";
import { element } from "../ui/dom.ts";
import { colourOf, HEALTH_MARKS } from "../ui/palette.ts";

type Seek = (seconds: number) => void;

function line(trace: Trace, label: string, colour: string, at: (frame: number) => number | undefined): ChartSeries {
  return { label, colour, values: Array.from({ length: trace.frames }, (_, frame) => at(frame) ?? null) };
}

function probabilities(trace: Trace, title: string, series: ChartSeries[], seek: Seek): Chart {
  return new Chart({ title, x: trace.seconds, series, range: [-0.02, 1.02], height: 200, seek });
}

/** Health and existence of every object, and the probabilities of the models of those that move. */
export function trackPlots(trace: Trace, group: ChartGroup, seek: Seek): HTMLElement {
  const charts: Chart[] = [];
  const hasHealth = trace.objects.some(({ health }) => health !== undefined);
  if (hasHealth) charts.push(healthChart(trace, seek));
  const existing = trace.objects.flatMap(({ id, existence }, i) => (existence ? [line(trace, id, colourOf(i), existence)] : []));
  if (existing.length > 0) charts.push(probabilities(trace, "probability that the object exists", existing, seek));
  for (const { id, models } of trace.objects) {
    if (!models) continue;
    const series = models.names.map((name, k) => line(trace, name, colourOf(k), (frame) => models.probability(k, frame)));
    charts.push(probabilities(trace, `models of motion of ${id}`, series, seek));
  }
  group.replace(charts);
  const again = trace.objects.some(({ registerAgain }) => registerAgain?.some((value) => value !== 0));
  const node = element("div", {}, group.node);
  if (hasHealth) node.append(marksLegend(trace.healths, HEALTH_MARKS));
  if (again) node.append(element("p", { class: "hint" }, "A line above a band: the object should be registered again."));
  return node;
}
