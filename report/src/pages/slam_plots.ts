// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The plots of a run, tab by tab.
import { Chart, type ChartSeries } from "../plots/chart.ts";
import { countStatuses, marksLegend, statusChart } from "../plots/statuses.ts";
import { ChartGroup } from "../plots/group.ts";
import {
  errorComponents, errorNorms, hypothesisSeries, negative, poseSeries, ROTATION_NAMES, type RotationAs, threeSigma, usualRange,
} from "../plots/series.ts";
import type { Estimate, PoseTrack, Trace } from "../trace/trace.ts";
import { choice, element, toggle } from "../ui/dom.ts";
import { colourOf, STATUS_MARKS } from "../ui/palette.ts";
import { table } from "../ui/table.ts";

export type Seek = (seconds: number) => void;
const AXES = ["x", "y", "z"];

function objectChoice(trace: Trace, change: (index: number) => void): HTMLElement {
  return choice("Object", trace.objects.map(({ id }, i) => [String(i), id] as const), "0", (value) => change(Number(value)));
}

/** Detections against filtered poses, T_camera_object by component (midway-merge paper, Figs. 6 and 7). */
export function detectionPlots(trace: Trace, group: ChartGroup, seek: Seek): HTMLElement {
  if (trace.objects.length === 0) return element("p", { class: "notice" }, "The run has no objects.");
  let index = 0;
  let as: RotationAs = "vector";
  const fill = () => {
    const { relative, detection } = trace.objects[index];
    const colour = colourOf(index);
    const own = relative && poseSeries(relative.pose, trace.frames, as);
    const seen = detection && poseSeries(detection, trace.frames, as, own);
    const truth = relative?.truth && poseSeries(relative.truth, trace.frames, as, own ?? seen);
    const chart = (title: string, half: "position" | "rotation", axis: number) => {
      const series: ChartSeries[] = [];
      if (seen) series.push({ label: "detected", values: seen[half][axis], colour: "#8A8A8A", kind: "dots" });
      if (own) series.push({ label: "filtered", values: own[half][axis], colour });
      if (truth) series.push({ label: "truth", values: truth[half][axis], kind: "dashed" });
      return new Chart({ title, x: trace.seconds, series, seek });
    };
    group.replace([
      ...AXES.map((name, i) => chart(`translation ${name} [m]`, "position", i)),
      ...ROTATION_NAMES[as].map((name, i) => chart(`${name} [deg]`, "rotation", i)),
    ]);
  };
  fill();
  const controls = element("div", { class: "controls" },
    objectChoice(trace, (value) => ((index = value), fill())),
    choice("Rotation as", [["vector", "rotation vector"], ["rpy", "roll, pitch, yaw"]], as, (value) => ((as = value as RotationAs), fill())),
    element("p", { class: "hint" }, "T_camera_object: the object as seen from the camera."));
  return element("div", {}, controls, group.node);
}

interface Target {
  name: string;
  estimate: Estimate;
  detection: PoseTrack | undefined;
  colour: string | undefined;
}

function targets(trace: Trace): Target[] {
  const list: Target[] = [];
  const add = (name: string, estimate: Estimate | undefined, detection?: PoseTrack, colour?: string) => {
    if (estimate) list.push({ name, estimate, detection, colour });
  };
  trace.objects.forEach(({ id, relative, detection }, i) => add(`${id} from the camera`, relative, detection, colourOf(i)));
  trace.objects.forEach(({ id, world }, i) => add(`${id} in the world`, world, undefined, colourOf(i)));
  add("camera in the world", trace.camera);
  return list;
}

/** Errors against the ground truth with three standard deviations; without ground truth the deviations alone. */
export function errorPlots(trace: Trace, group: ChartGroup, seek: Seek): HTMLElement {
  const list = targets(trace);
  const note = element("p", { class: "hint" });
  let index = 0;
  let whole = false;
  const fill = () => {
    const { estimate, detection, colour } = list[index];
    const paint = colour ? { colour } : {};
    const sigma = threeSigma(estimate, trace.frames);
    const { truth } = estimate;
    const norms = truth && errorNorms(estimate.pose, truth, trace.frames);
    const seen = truth && detection && errorNorms(detection, truth, trace.frames);
    const parts = truth && errorComponents(estimate.pose, truth, trace.frames);
    note.textContent = truth
      ? "Shade: three standard deviations, in the norms of the least certain direction."
      : "There is no ground truth for this pose: the shade is three standard deviations.";
    const norm = (title: string, of: "angle" | "distance") => {
      const series: ChartSeries[] = [{ label: "3 sigma", values: sigma[of], kind: "shade", ...paint }];
      if (seen) series.push({ label: "detected", values: seen[of], colour: "#8A8A8A", kind: "dots" });
      if (norms) series.push({ label: "error", values: norms[of], ...paint });
      return new Chart({ title, x: trace.seconds, series, seek, ...(whole ? {} : { range: usualRange(series, true) }) });
    };
    const part = (title: string, half: "rotation" | "position", axis: number) => {
      const values = sigma[half][axis];
      const series: ChartSeries[] = [{ label: "3 sigma", values, lower: negative(values), kind: "band", ...paint }];
      if (parts) series.push({ label: "error", values: parts[half][axis], ...paint });
      return new Chart({ title, x: trace.seconds, series, seek, ...(whole ? {} : { range: usualRange(series, false) }) });
    };
    group.replace([
      norm("rotation error [deg]", "angle"),
      norm("position error [mm]", "distance"),
      ...AXES.map((name, i) => part(`rotation about ${name} [deg]`, "rotation", i)),
      ...AXES.map((name, i) => part(`position ${name} [mm]`, "position", i)),
    ]);
  };
  if (list.length === 0) return element("p", { class: "notice" }, "The run has no estimates.");
  fill();
  const chooser = choice("Pose", list.map(({ name }, i) => [String(i), name] as const), "0", (value) => ((index = Number(value)), fill()));
  const range = toggle("Whole range", whole, (on) => ((whole = on), fill()));
  return element("div", {}, element("div", { class: "controls" }, chooser, range, note), group.node);
}

/** Probability of the modes, and of every hypothesis of an object. */
export function hypothesisPlots(trace: Trace, group: ChartGroup, seek: Seek): HTMLElement {
  const fill = (index: number) => {
    const charts: Chart[] = [];
    const modes = trace.objects.flatMap(({ id, modeProbability }, i) => {
      if (!modeProbability) return [];
      const values = Array.from({ length: trace.frames }, (_, frame) => modeProbability(frame) ?? null);
      return [{ label: id, values, colour: colourOf(i) }];
    });
    const slots = hypothesisSeries(trace, index).map((values, k) => ({
      label: `slot ${k + 1}`, values, colour: colourOf(k),
    }));
    const { id } = trace.objects[index];
    charts.push(new Chart({ title: `weights of the hypotheses of ${id}`, x: trace.seconds, series: slots, range: [-0.02, 1.02], height: 240, seek }));
    if (modes.length > 0) {
      charts.push(new Chart({ title: "probability that the estimate is on the right mode", x: trace.seconds, series: modes, range: [-0.02, 1.02], height: 240, seek }));
    }
    group.replace(charts);
  };
  if (trace.objects.length === 0) return element("p", { class: "notice" }, "The run has no objects.");
  fill(0);
  const hint = element("p", { class: "hint" }, "A hypothesis keeps its slot, and its colour, as long as it lives.");
  return element("div", {}, element("div", { class: "controls" }, objectChoice(trace, fill), hint), group.node);
}

/** Status of the detections, over time and counted. */
export function statusPlots(trace: Trace, group: ChartGroup, seek: Seek): HTMLElement {
  const counts = countStatuses(trace);
  const legend = marksLegend(trace.statuses, STATUS_MARKS);
  group.replace(trace.objects.length > 0 ? [statusChart(trace, seek)] : []);
  const rows = trace.objects.map(({ id }, i) => ({ name: id, cells: counts[i].map((value) => ({ value })) }));
  return element("div", {}, group.node, legend, table("Frames by status", ["", ...trace.statuses], rows));
}
