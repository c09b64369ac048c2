// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether the covariances and probabilities of a run are worth what they say.
import { Chart, type Values } from "../plots/chart.ts";
import { EXPECTED, grossText, percent } from "../plots/coverage.ts";
import { ChartGroup } from "../plots/group.ts";
import { BINS, type Reliability, reliabilityOf } from "../plots/reliability.ts";
import { neesChart, nisChart } from "../plots/squares_chart.ts";
import type { RunFacts } from "../state/run_facts.ts";
import { CAMERA } from "../state/run_state.ts";
import { hasSquares } from "../trace/squares.ts";
import type { Trace } from "../trace/trace.ts";
import { element } from "../ui/dom.ts";
import { AXIS_COLOURS, colourOf } from "../ui/palette.ts";
import { table } from "../ui/table.ts";
import { themeColour } from "../ui/theme.ts";
import { type AxisCoverage, type Findings, findingsOf, sentences } from "./consistency_findings.ts";
import { entityChoice, frameChoice, frameWords, type Plots, type PlotTab, Refill } from "./plot_settings.ts";

/** Whether there is anything to say of consistency. */
export const hasConsistency = (trace: Trace): boolean => trace.hasTruth || hasSquares(trace, "nis");

/** A bar of the share that is within so many sigma, with a line where it should be. */
function shareCell(share: number, expected: number, axis: number): HTMLElement {
  const bar = element("span", { class: "bar" }, element("span", { class: "filled" }), element("span", { class: "expected" }));
  bar.style.setProperty("--share", String(share));
  bar.style.setProperty("--expected", String(expected));
  bar.style.setProperty("--swatch", AXIS_COLOURS[axis]);
  return element("td", { class: "number" }, percent(share), bar);
}

function coverageTable(axes: AxisCoverage[]): HTMLElement {
  const head = element("tr", {}, element("th", { scope: "col" }, "axis"),
    ...EXPECTED.map((share, i) => element("th", { scope: "col" }, `within ${i + 1} sigma, of ${percent(share)}`)),
    element("th", { scope: "col" }, "rms of error / sigma"), element("th", { scope: "col" }, "verdict"));
  const body = element("tbody", {}, ...axes.map(({ name, coverage }) => {
    const { shares, square } = coverage;
    const axis = ["x", "y", "z"].findIndex((letter) => new RegExp(` ${letter}(,|$)`).test(name));
    return element("tr", { "data-axis": name }, element("th", { scope: "row" }, name), ...shares.map((share, i) => shareCell(share, EXPECTED[i], axis)),
      element("td", { class: "number" }, Math.sqrt(square.mean).toFixed(2)), element("td", { class: `verdict ${square.verdict}` }, square.verdict + grossText(coverage)));
  }));
  const made = element("table", { class: "coverage" }, element("caption", {}, "Coverage by axis"), element("thead", {}, head), body);
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Coverage by axis" }, made);
}

function reliabilityChart(all: Reliability, own: Reliability | undefined, name: string, colour: string): Chart {
  const points = (found: Reliability | undefined) => (found?.bins ?? []).filter(({ frames }) => frames > 0).map(({ frames, said, right }) => [said / frames, right / frames] as const);
  const [pooled, single] = [points(all), points(own)];
  const x = [...new Set([0, 1, ...pooled.map(([at]) => at), ...single.map(([at]) => at)])].sort((a, b) => a - b);
  const at = (list: typeof pooled): Values => x.map((value) => list.find(([said]) => said === value)?.[1] ?? null);
  return new Chart({
    title: "reliability of the mode probability", x, xLabel: "mode probability, mean of the bin", range: [-0.03, 1.03], height: 260,
    note: `share of frames on the right mode; ${all.frames} frames, Brier score ${all.brier.toPrecision(2)} (0 is perfect)`,
    series: [
      { label: "as said", values: x, kind: "dashed" },
      { label: "all objects", values: at(pooled), kind: "points", colour: themeColour("--muted") },
      ...(own ? [{ label: name, values: at(single), kind: "points" as const, colour }] : []),
    ],
  });
}

function reliabilityTable(found: Reliability): HTMLElement {
  const rows = found.bins.flatMap(({ frames, said, right }, k) => frames === 0 ? [] : [{
    name: `${(100 * k) / BINS} to ${(100 * (k + 1)) / BINS} %`,
    cells: [frames, said / frames, right / frames].map((value, i) => ({ value, key: `reliability/${k}/${["frames", "said", "right"][i]}` })),
  }]);
  return table("Mode probability of all objects", ["bin", "frames", "mean probability", "share on the right mode"], rows);
}

const RIGHT_MODE = "On the right mode: the estimate, which is the leading hypothesis, is within 20 deg and 10 cm of the truth, as in right_mode_share of metrics.json.";

function introduction(trace: Trace, { nees, nis }: Findings): string {
  if (!trace.hasTruth) return "There is no ground truth: the NIS of the innovations takes the place of the NEES. It tells whether detections are as the filter expects them, not whether the estimate is right.";
  const missing = nees ? "" : " This report has no NEES of this pose; coverage follows from the errors and sigmas by axis.";
  return `NEES: squared error over covariance, ${nis ? "NIS: squared innovation over its covariance, " : ""}compared with chi-square of 6 degrees of freedom.${missing}`;
}

export function consistencyTab(plots: Plots, facts: RunFacts, group: ChartGroup): PlotTab {
  const { state } = plots;
  const { trace } = state;
  const hint = element("p", { class: "hint" });
  const list = element("ul", { class: "findings" });
  const tables = element("div", { class: "tables" });
  const modes = new ChartGroup();
  const below = element("div", {});
  const node = element("div", { class: "consistency" });
  let all: Reliability | undefined | null = null;
  const fill = () => {
    const { selected } = state;
    const colour = selected === CAMERA ? themeColour("--ink") : colourOf(selected);
    const found = findingsOf(trace, selected, plots.of.value);
    const verdict = facts.verdictIn(selected, plots.of.value);
    const said = sentences(found, verdict, frameWords(selected, plots.of.value));
    hint.textContent = introduction(trace, found);
    list.replaceChildren(...said.map((text) => element("li", {}, text)));
    group.replace([...(found.nees ? [neesChart(state, found.nees, colour)] : []), ...(found.nis ? [nisChart(state, found.nis, colour)] : [])]);
    tables.replaceChildren(...(found.axes.length > 0 ? [coverageTable(found.axes)] : []));
    all = all === null ? reliabilityOf(trace, trace.objects) : all;
    if (!all) return;
    const own = selected === CAMERA ? undefined : reliabilityOf(trace, [trace.objects[selected]]);
    modes.replace([reliabilityChart(all, own, state.nameOf(selected), colour)]);
    below.replaceChildren(reliabilityTable(all), element("p", { class: "hint" }, RIGHT_MODE));
  };
  const refill = new Refill(node, fill);
  node.append(element("div", { class: "controls" }, entityChoice(state, "Pose of", true), frameChoice(plots)), hint, list, group.node, tables, modes.node, below);
  refill.now();
  state.on("selection", () => refill.request());
  plots.of.onChange(() => refill.request());
  return { node, opened: () => refill.opened() };
}
