// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Errors against the ground truth with their standard deviations; without ground truth these alone, with residuals.
import { Chart, type ChartSeries, type Values } from "../plots/chart.ts";
import { DETECTED_COLOUR, OUTSIDE_COLOUR } from "../plots/colours.ts";
import { coverageOf, coverageText, EXPECTED, outside, percent, shareBelow } from "../plots/coverage.ts";
import { ChartGroup } from "../plots/group.ts";
import { errorComponents, errorNorms, type PoseSeries, type Spread, spreadOf, times, usualRange } from "../plots/series.ts";
import { CAMERA, type RunState } from "../state/run_state.ts";
import { estimateOf } from "../trace/squares.ts";
import type { Estimate, PoseTrack } from "../trace/trace.ts";
import { element, toggle } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { errorStatistics } from "./error_statistics.ts";
import { entityChoice, frameChoice, frameWords, type Plots, type PlotTab, Refill, rotationChoice } from "./plot_settings.ts";

const AXES = ["x", "y", "z"];

/** What is drawn of one pose. */
interface Drawn {
  estimate: Estimate;
  /** Errors, or without truth the residuals of detections. */
  deviation: PoseTrack | undefined;
  label: string;
  detection: PoseTrack | undefined;
  paint: { colour?: string };
  sigma: Spread;
}

function drawn(plots: Plots): Drawn | undefined {
  const { trace, selected } = plots.state;
  const estimate = estimateOf(trace, selected, plots.of.value);
  if (!estimate) return undefined;
  const detection = selected !== CAMERA && plots.of.value === "relative" ? trace.objects[selected].detection : undefined;
  const hasTruth = estimate.truth !== undefined;
  return {
    estimate, detection: hasTruth ? detection : undefined, deviation: estimate.truth ?? detection, label: hasTruth ? "error" : "innovation",
    paint: selected === CAMERA ? {} : { colour: colourOf(selected) }, sigma: spreadOf(estimate, trace.frames),
  };
}

const settingsOf = (state: RunState) => ({ x: state.trace.seconds, seek: (seconds: number) => state.seek(seconds) });

/** Frames outside a bound, to be marked. */
function marked(values: Values, label: string): ChartSeries {
  return { label, values, kind: "dots", colour: OUTSIDE_COLOUR, size: 3.4, quiet: true };
}

function normChart(plots: Plots, { estimate, deviation, detection, label, paint, sigma }: Drawn, of: "angle" | "distance", whole: boolean): Chart {
  const { state } = plots;
  const { frames } = state.trace;
  const what = of === "angle" ? "rotation" : "position";
  const norms = deviation && errorNorms(estimate.pose, deviation, frames);
  const seen = detection && errorNorms(detection, estimate.truth!, frames);
  const series: ChartSeries[] = [{ label: "99.7 % bound", values: sigma[of], kind: "shade", ...paint }];
  if (seen) series.push({ label: "detected", values: seen[of], colour: DETECTED_COLOUR, kind: "dots" });
  if (norms) {
    series.push({ label, values: norms[of], ...paint, ...(estimate.truth ? {} : { kind: "dots" as const }) });
    if (estimate.truth) series.push(marked(outside(norms[of], sigma[of]), "outside"));
  }
  const share = estimate.truth && norms ? shareBelow(norms[of], sigma[of]) : undefined;
  const title = `${what} ${estimate.truth ? "error" : "spread"} [${of === "angle" ? "deg" : "mm"}]`;
  return new Chart({
    title, series, ...settingsOf(state), ...(whole ? {} : { range: usualRange(series, true) }),
    ...(share !== undefined ? { note: `${percent(share)} below the bound (${percent(EXPECTED[2])} expected)` } : {}),
  });
}

function partChart(plots: Plots, { estimate, label, paint, sigma }: Drawn, parts: PoseSeries | undefined, title: string, half: "rotation" | "position", axis: number, whole: boolean): Chart {
  const one = sigma[half][axis];
  const limit = times(one, 3);
  const series: ChartSeries[] = [
    { label: "3 sigma", values: limit, lower: times(limit, -1), kind: "band", ...paint },
    { label: "1 sigma", values: one, lower: times(one, -1), kind: "band", ...paint, quiet: true },
  ];
  let note: string | undefined;
  if (parts) {
    const values = parts[half][axis];
    series.push({ label, values, ...paint, ...(estimate.truth ? {} : { kind: "dots" as const }) });
    if (estimate.truth) {
      series.push(marked(outside(values, limit), "outside"));
      const coverage = coverageOf(values, one);
      if (coverage) note = coverageText(coverage);
    }
  }
  return new Chart({ title, series, ...settingsOf(plots.state), ...(whole ? {} : { range: usualRange(series, false) }), ...(note !== undefined ? { note } : {}) });
}

function charts(plots: Plots, found: Drawn, whole: boolean): Chart[] {
  const as = plots.rotationAs.value;
  const parts = found.deviation && errorComponents(found.estimate.pose, found.deviation, plots.state.trace.frames, as);
  const names = as === "rpy" ? ["roll", "pitch", "yaw"] : AXES.map((axis) => `rotation about ${axis}`);
  return [
    normChart(plots, found, "angle", whole),
    normChart(plots, found, "distance", whole),
    ...names.map((name, i) => partChart(plots, found, parts, `${name} [deg]`, "rotation", i, whole)),
    ...AXES.map((name, i) => partChart(plots, found, parts, `position ${name} [mm]`, "position", i, whole)),
  ];
}

function noteOf(plots: Plots, { estimate, deviation }: Drawn): string {
  const frame = frameWords(plots.state.selected, plots.of.value);
  const norm = estimate.hasCovariance
    ? "The bound of the position's norm follows from its covariance; that of the angle takes the three axes as independent, as their correlations are not in the report."
    : "The bounds of the norms take the three axes as independent, as their correlations are not in the report.";
  if (estimate.truth) return `Truth minus estimate along the axes of the ${frame}. ${norm} Verdicts allow for frames that are alike.`;
  const rest = deviation ? " Dots: detection minus estimate, after the update." : "";
  return `There is no ground truth for this pose, so no error is known: shades are 1 and 3 sigma along the axes of the ${frame}.${rest} ${norm}`;
}

export function errorPlots(plots: Plots, group: ChartGroup): PlotTab {
  const { state } = plots;
  const note = element("p", { class: "hint" });
  const below = element("div", { class: "statistics" });
  const node = element("div", {});
  const shares = new ChartGroup();
  let whole = false;
  const refill = new Refill(node, () => {
    const found = drawn(plots);
    below.replaceChildren();
    if (!found) {
      note.textContent = `There is no estimate of ${state.nameOf(state.selected)} in the frame of the ${frameWords(state.selected, plots.of.value)}.`;
      group.replace([]);
      return;
    }
    note.textContent = noteOf(plots, found);
    group.replace(charts(plots, found, whole));
    if (found.estimate.truth) below.append(errorStatistics(plots, found.estimate, found.detection, shares));
  });
  const range = toggle("Whole range", whole, (on) => ((whole = on), refill.now()));
  node.append(element("div", { class: "controls" }, entityChoice(state, "Pose of", true), frameChoice(plots), rotationChoice(plots), range), note, group.node, below);
  refill.now();
  state.on("selection", () => refill.request());
  plots.of.onChange(() => refill.request());
  plots.rotationAs.onChange(() => refill.request());
  return { node, opened: () => refill.opened() };
}
