// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The hypotheses of the selected object over time, and the mode probability of every object.
import { Chart } from "../plots/chart.ts";
import { percent } from "../plots/coverage.ts";
import { ChartGroup } from "../plots/group.ts";
import { type River, riverOf, supportOf } from "../plots/river.ts";
import { riverChart } from "../plots/river_chart.ts";
import { hypothesisColour } from "../plots/river_colours.ts";
import { valuesOf } from "../plots/series.ts";
import type { RunState } from "../state/run_state.ts";
import { element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { hypothesisTable } from "./hypothesis_table.ts";
import { entityChoice, notice, type Plots, type PlotTab, Refill, selectedObject } from "./plot_settings.ts";

/** While playing, the table is written a few times a second. */
const EVERY_MS = 120;

interface Shown {
  river: River;
  support: Int32Array;
}

/** The river of an object and its support, computed once. */
function riversOf(state: RunState): (index: number) => Shown {
  const { trace } = state;
  const made = new Map<number, Shown>();
  return (index) => {
    const found = made.get(index);
    if (found) return found;
    const object = trace.objects[index];
    const river = riverOf(object.hypotheses, trace.frames, trace.cameraHypotheses.length === 0);
    const one = { river, support: supportOf(river, trace, object) };
    made.set(index, one);
    return one;
  };
}

/** One small chart per object, so that lines that coincide are told apart. */
function modeCharts(state: RunState): Chart[] {
  const { trace } = state;
  return trace.objects.flatMap(({ id, modeProbability }, i) => {
    if (!modeProbability) return [];
    const values = valuesOf(trace.frames, modeProbability);
    const least = values.reduce<number>((best, value, frame) => (value !== null && (best < 0 || value < values[best]!) ? frame : best), -1);
    return [new Chart({
      title: id, x: trace.seconds, range: [-0.04, 1.04], height: 112, yTicks: [0, 0.5, 1],
      series: [{ label: "mode probability", values, colour: colourOf(i) }],
      ...(least >= 0 ? { note: `lowest ${percent(values[least]!)} at ${trace.seconds[least].toFixed(2)} s` } : {}),
      seek: (seconds) => {
        state.seek(seconds);
        state.select(i);
      },
    })];
  });
}

const HINT = "A band is a hypothesis, as high as its weight, stacked in the order of births. ▲ birth, ◆ merge into another of the same mode (within 20 deg and 10 cm), ✕ dropped.";
const JOINT = "These are joint hypotheses of all objects; their numbers are ranks at each frame, so bands say nothing of births and ends.";
const SUPPORT = "Turn, its axis in the object's frame, and distance: from the leading hypothesis. Support: a detection within 20 deg and 10 cm, and nearer to it than to any other.";

/** Writes the table at every frame, but not too often, and not where it is not seen. */
function whenFrame(node: HTMLElement, state: RunState, write: () => void): void {
  let last = -Infinity;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const now = () => {
    clearTimeout(timer);
    timer = undefined;
    last = performance.now();
    if (!node.closest("[hidden]")) write();
  };
  state.on("frame", () => {
    const wait = last + EVERY_MS - performance.now();
    if (wait <= 0) now();
    else timer ??= setTimeout(now, wait);
  });
}

export function hypothesisPlots(plots: Plots, group: ChartGroup, modes: ChartGroup): PlotTab {
  const { state } = plots;
  const { trace } = state;
  if (trace.objects.length === 0) return { node: notice("The run has no objects."), opened: () => {} };
  const chosen = selectedObject(state);
  const riverAt = riversOf(state);
  const colour = (lane: number) => hypothesisColour(chosen(), lane);
  let highlight: (lane: number | undefined) => void = () => {};
  const pointed = (lane: number | undefined) => {
    highlight(lane);
    made.highlight(lane);
  };
  const made = hypothesisTable(colour, pointed);
  const node = element("div", {});
  const write = () => {
    const { river, support } = riverAt(chosen());
    made.show(river, support, trace.seconds, state.frame);
  };
  let filled = -1;
  const refill = new Refill(node, () => {
    if (filled !== chosen()) {
      filled = chosen();
      const { river } = riverAt(filled);
      const drawn = riverChart(state, `hypotheses of ${state.nameOf(filled)}: weight`, river, colour, pointed);
      highlight = drawn.highlight;
      group.replace([drawn.chart]);
    }
    write();
  });
  const hint = element("p", { class: "hint" }, trace.cameraHypotheses.length === 0 ? HINT : JOINT);
  const small = modeCharts(state);
  node.append(element("div", { class: "controls" }, entityChoice(state, "Object", false), hint), group.node, made.node, element("p", { class: "hint" }, SUPPORT));
  modes.node.classList.add("small");
  modes.replace(small);
  if (small.length > 0) {
    node.append(element("h2", {}, "Mode probability"),
      element("p", { class: "hint" }, "How sure the filter is that its estimate is on the right mode. It is the filter's own belief; the tab Consistency compares it with the truth, where there is one."), modes.node);
  }
  refill.now();
  state.on("selection", () => refill.request());
  whenFrame(node, state, write);
  return { node, opened: () => (refill.opened(), write()) };
}
