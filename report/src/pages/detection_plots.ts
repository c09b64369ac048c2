// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Detections against the estimate, or both as they are.
import { Chart, type ChartSeries } from "../plots/chart.ts";
import type { ChartGroup } from "../plots/group.ts";
import { errorComponents, poseSeries, ROTATION_NAMES, times, usualRange, valuesOf, type PoseSeries, type Spread, spreadOf } from "../plots/series.ts";
import { nisChart } from "../plots/squares_chart.ts";
import { nisOf } from "../trace/squares.ts";
import { choice, element, toggle } from "../ui/dom.ts";
import { colourOf, STATUS_MARKS, TRUTH_COLOUR } from "../ui/palette.ts";
import { entityChoice, notice, type Plots, type PlotTab, Refill, rotationChoice, selectedObject } from "./plot_settings.ts";

const AXES = ["x", "y", "z"];
type Shown = "innovation" | "pose";

const HINTS: Record<Shown, string> = {
  innovation: "Detection minus estimate of T_camera_object, by the status of the detection. The estimate is that after the update, so these are residuals, smaller than the innovation against the prediction. Shade: 3 sigma of the estimate alone.",
  pose: "T_camera_object: the object as seen from the camera.",
};

/** The values of the frames with one status. */
function withStatus(plots: Plots, index: number, values: PoseSeries["position"][number], word: string): PoseSeries["position"][number] {
  const { statuses, objects } = plots.state.trace;
  const { status } = objects[index];
  return status ? values.map((value, frame) => (statuses[status[frame]] === word ? value : null)) : values;
}

/** Statuses of detections that the object has in this run. */
function statusesOf(plots: Plots, index: number): string[] {
  const { statuses, objects } = plots.state.trace;
  const seen = new Set(objects[index].status ?? []);
  return statuses.filter((word, k) => seen.has(k) && word !== "none");
}

function innovations(plots: Plots, index: number, whole: boolean): Chart[] {
  const { trace } = plots.state;
  const { relative, detection } = trace.objects[index];
  if (!relative || !detection) return [];
  const as = plots.rotationAs.value;
  const rest = errorComponents(relative.pose, detection, trace.frames, as);
  const sigma: Spread = spreadOf(relative, trace.frames);
  const words = statusesOf(plots, index);
  const seek = (seconds: number) => plots.state.seek(seconds);
  const chart = (title: string, half: "position" | "rotation", axis: number) => {
    const limit = times(sigma[half][axis], 3);
    const series: ChartSeries[] = [{ label: "3 sigma of the estimate", values: limit, lower: times(limit, -1), kind: "band", colour: colourOf(index) }];
    for (const word of words.length > 0 ? words : ["used"]) {
      const mark = STATUS_MARKS[word];
      series.push({ label: word, values: withStatus(plots, index, rest[half][axis], word), kind: "dots", colour: mark?.colour || "#8A8A8A", size: word === "used" ? 2.4 : 4 });
    }
    return new Chart({ title, x: trace.seconds, series, seek, ...(whole ? {} : { range: usualRange(series, false) }) });
  };
  const names = as === "rpy" ? ROTATION_NAMES.rpy : AXES.map((axis) => `rotation about ${axis}`);
  const nis = nisOf(trace, index);
  return [
    ...(nis ? [nisChart(plots.state, valuesOf(trace.frames, nis), colourOf(index))] : []),
    ...AXES.map((name, i) => chart(`innovation: translation ${name} [mm]`, "position", i)),
    ...names.map((name, i) => chart(`innovation: ${name} [deg]`, "rotation", i)),
  ];
}

/** Detected and estimated poses by component (midway-merge paper, Figs. 6 and 7). */
function poses(plots: Plots, index: number): Chart[] {
  const { trace } = plots.state;
  const { relative, detection } = trace.objects[index];
  const as = plots.rotationAs.value;
  const own = relative && poseSeries(relative.pose, trace.frames, as);
  const seen = detection && poseSeries(detection, trace.frames, as, own);
  const truth = relative?.truth && poseSeries(relative.truth, trace.frames, as, own ?? seen);
  const chart = (title: string, half: "position" | "rotation", axis: number) => {
    const series: ChartSeries[] = [];
    if (seen) series.push({ label: "detected", values: seen[half][axis], colour: "#8A8A8A", kind: "dots" });
    if (own) series.push({ label: "estimated", values: own[half][axis], colour: colourOf(index) });
    if (truth) series.push({ label: "truth", values: truth[half][axis], kind: "dashed", colour: TRUTH_COLOUR });
    return new Chart({ title, x: trace.seconds, series, seek: (seconds) => plots.state.seek(seconds) });
  };
  return [
    ...AXES.map((name, i) => chart(`translation ${name} [m]`, "position", i)),
    ...ROTATION_NAMES[as].map((name, i) => chart(`${name} [deg]`, "rotation", i)),
  ];
}

export function detectionPlots(plots: Plots, group: ChartGroup): PlotTab {
  const { state } = plots;
  if (state.trace.objects.length === 0) return { node: notice("The run has no objects."), opened: () => {} };
  const chosen = selectedObject(state);
  let shown: Shown = "innovation";
  let whole = false;
  let filled = "";
  const hint = element("p", { class: "hint" });
  const node = element("div", {});
  const refill = new Refill(node, () => {
    const index = chosen();
    const now = [index, shown, whole, plots.rotationAs.value].join();
    if (now === filled) return;
    filled = now;
    const { relative, detection } = state.trace.objects[index];
    hint.textContent = shown === "innovation" && !(relative && detection) ? "There are no detections of this object." : HINTS[shown];
    group.replace(shown === "innovation" ? innovations(plots, index, whole) : poses(plots, index));
  });
  const show = choice("Show", [["innovation", "innovation (detection against estimate)"], ["pose", "absolute pose"]], shown, (value) => ((shown = value as Shown), refill.now()));
  node.append(element("div", { class: "controls" }, entityChoice(state, "Object", false), show, rotationChoice(plots),
    toggle("Whole range", whole, (on) => ((whole = on), refill.now()))), hint, group.node);
  refill.now();
  state.on("selection", () => refill.request());
  plots.rotationAs.onChange(() => refill.request());
  return { node, opened: () => refill.opened() };
}
