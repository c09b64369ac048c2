// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The table of statistics that evo gives, and the distribution of the errors.
import { quantileOfSorted, summaryOf } from "../math/statistics.ts";
import { Chart, type ChartSeries } from "../plots/chart.ts";
import { DETECTED_COLOUR } from "../plots/colours.ts";
import { aligned, ape, type Errors, type Motion, type Pairs, pairsOf, rpe, stepsFor, umeyama } from "../plots/evo.ts";
import type { ChartGroup } from "../plots/group.ts";
import { CAMERA } from "../state/run_state.ts";
import type { Estimate, PoseTrack } from "../trace/trace.ts";
import { choice, element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { table } from "../ui/table.ts";
import type { Plots } from "./plot_settings.ts";

const COLUMNS = ["rmse", "mean", "median", "std", "min", "max", "count"] as const;
const POINTS = 200;
type Alignment = "none" | "se3";

function rows(name: string, key: string, { distance, angle }: Errors) {
  const row = (what: string, unit: string, values: Float64Array) => {
    const found = summaryOf(values);
    return { name: `${name}, ${what} [${unit}]`, cells: COLUMNS.map((column) => ({ value: values.length > 0 ? found[column] : null, key: `${key}/${what}/${column}` })) };
  };
  return [row("translation", "mm", distance), row("rotation", "deg", angle)];
}

/** The share of the values that are at most x, at as many places for every series. */
function distribution(title: string, lists: { label: string; values: Float64Array; colour?: string }[]): Chart | undefined {
  const sorted = lists.map(({ values }) => values.slice().sort());
  const top = Math.max(...sorted.map((values) => (values.length > 0 ? quantileOfSorted(values, 0.99) : 0)));
  if (!(top > 0)) return undefined;
  const x = Array.from({ length: POINTS + 1 }, (_, i) => (top * i) / POINTS);
  const series = lists.flatMap(({ label, colour }, k): ChartSeries[] => {
    let count = 0;
    const values = x.map((limit) => {
      while (count < sorted[k].length && sorted[k][count] <= limit) ++count;
      return count / sorted[k].length;
    });
    return sorted[k].length > 0 ? [{ label, values, ...(colour ? { colour } : {}) }] : [];
  });
  return new Chart({ title: `share of frames by ${title}`, x, xLabel: `at most [${title.includes("rotation") ? "deg" : "mm"}]`, series, range: [0, 1.02] });
}

/** The motion between the worlds of estimate and truth, by the camera's path. */
function alignmentOf({ state }: Plots): Motion | undefined {
  const { camera, seconds } = state.trace;
  return camera?.truth && umeyama(pairsOf(camera.pose, camera.truth, seconds));
}

const WORDS: Record<Alignment, string> = {
  none: "Estimate and truth are compared as they are, in one world.",
  se3: "The estimate is moved by one rotation and translation (SE(3), Umeyama, no scale) that brings the camera's path nearest to the true one; objects in the world are moved with it. An offset of the whole map is no error then. The plots above are not aligned.",
};

/** The section below the plots; `group` holds its charts. */
export function errorStatistics(plots: Plots, estimate: Estimate, detection: PoseTrack | undefined, group: ChartGroup): HTMLElement {
  const { state } = plots;
  const { seconds } = state.trace;
  const pairs = pairsOf(estimate.pose, estimate.truth!, seconds);
  const isWorld = state.selected === CAMERA || plots.of.value === "world";
  const motion = isWorld ? alignmentOf(plots) : undefined;
  const steps = stepsFor(pairs);
  let alignment: Alignment = "none";
  let step = Math.max(0, steps.findIndex(({ name }) => name === "1 s"));
  const place = element("div");
  const note = element("p", { class: "hint" });
  const seen = detection && ape(pairsOf(detection, estimate.truth!, seconds));
  const colour = state.selected === CAMERA ? undefined : colourOf(state.selected);
  const fill = () => {
    const used: Pairs = alignment === "se3" && motion ? aligned(pairs, motion) : pairs;
    const errors = ape(used);
    const { name, step: by } = steps[step];
    place.replaceChildren(table(`Statistics of ${state.nameOf(state.selected)}`, ["", ...COLUMNS], [
      ...rows("APE", "ape", errors), ...rows(`RPE over ${name}`, "rpe", rpe(used, by)),
    ]));
    const one = (title: string, of: keyof Errors) => distribution(title, [
      { label: "error", values: errors[of], ...(colour ? { colour } : {}) },
      ...(seen ? [{ label: "detected", values: seen[of], colour: DETECTED_COLOUR }] : []),
    ]);
    group.replace([one("rotation error [deg]", "angle"), one("position error [mm]", "distance")].filter((chart) => chart !== undefined));
    const why = isWorld && !motion ? " The camera does not move enough to align by." : "";
    note.textContent = (isWorld ? WORDS[alignment] + why : "Poses as seen from the camera need no alignment.") + " RPE: from every frame to the first that is so far on along the truth.";
  };
  const controls = element("div", { class: "controls" },
    choice("RPE over", steps.map(({ name }, i) => [String(i), name] as const), String(step), (value) => ((step = Number(value)), fill())));
  if (motion) controls.append(choice("Alignment", [["none", "none"], ["se3", "SE(3) Umeyama"]], alignment, (value) => ((alignment = value as Alignment), fill())));
  fill();
  return element("section", {}, element("h2", {}, "Statistics"), controls, note, place, group.node);
}
