// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Two or more runs over one recording: which is better where, by how much, and which failed, when and why.
import { type Failure, failuresOf, failureText } from "../compare/failures.ts";
import { type MetricRow, metricRows } from "../compare/metrics.ts";
import { type Comparison, readComparison, type Run, type Values } from "../compare/runs.ts";
import { failureSentence, verdictSentences } from "../compare/verdict.ts";
import type { Payload } from "../payload.ts";
import { Chart, type ChartSeries } from "../plots/chart.ts";
import { ChartGroup } from "../plots/group.ts";
import { key } from "../plots/drawing.ts";
import { bindAddress } from "../state/address.ts";
import { CAMERA, RunState } from "../state/run_state.ts";
import { choice, element, toggle } from "../ui/dom.ts";
import { Keys } from "../ui/keys.ts";
import { Player } from "../ui/player.ts";
import { tabs } from "../ui/tabs.ts";
import { makeScenes } from "./comparison_scenes.ts";
import { failureList, metricsTable, momentLinks, runList } from "./comparison_tables.ts";
import { footer, header, publish } from "./page.ts";
import { printComparison } from "./print_comparison.ts";

const MOST_FAILURES_ON_TOP = 4;

function topNode(comparison: Comparison, sentences: string[], failures: Failure[]): HTMLElement {
  const list = failures.slice(0, MOST_FAILURES_ON_TOP).map((failure) =>
    element("p", { class: "failed" }, ...momentLinks(failure.run, failure.from, failure.id, `${failure.run.name}: ${failureText(failure)}`), failure.why ? ` — ${failure.why}.` : "."));
  const left = failures.length - list.length;
  const first = [element("p", { class: "first" }, failureSentence(comparison, failures))];
  return element("section", { class: "story", "aria-label": "Result" },
    element("div", { class: "failures-first" }, ...first, ...list, ...(left > 0 ? [element("p", { class: "hint" }, `${left} more under "Failures".`)] : [])),
    element("div", {}, ...sentences.map((text) => element("p", {}, text)), ...comparison.cautions.map((text) => element("p", { class: "caution" }, text))));
}

/** The mode's probability of an object over the timeline. */
function modeOf(run: Run, id: string): Values | undefined {
  const probability = run.object(id)?.modeProbability;
  return probability && run.spread(Array.from({ length: run.trace.frames }, (_, frame) => probability(frame) ?? null));
}

/** Errors of all runs; where there is no truth the runs' distances to the first one, and their own standard deviations. */
function curves(comparison: Comparison, state: RunState, group: ChartGroup, { sigma, log }: { sigma: boolean; log: boolean }): Chart[] {
  const { runs, timeline, ids } = comparison;
  const id = state.selected === CAMERA ? undefined : ids[state.selected];
  const seek = (seconds: number) => state.seek(seconds);
  const hasError = runs.some((run) => run.error(id));
  const series = (pick: "distance" | "angle") => runs.flatMap((run): ChartSeries[] => {
    const [error, own] = [(hasError ? run.error(id) : run === runs[0] ? undefined : run.apart(runs[0], id))?.[pick], run.sigma(id)?.[pick]];
    return [
      ...(error ? [{ label: hasError ? run.name : `${run.name} to ${runs[0].name}`, values: error, colour: run.colour }] : []),
      ...(own && (sigma || !hasError) ? [{ label: `${run.name}, own 99.7 % bound`, values: own, colour: run.colour, kind: "dashed" as const }] : []),
    ];
  });
  const what = hasError ? "error" : `distance to ${runs[0].name}`;
  const chart = (title: string, list: ChartSeries[], more: { range?: [number, number]; yLog?: boolean }) =>
    list.length > 0 ? [new Chart({ title, x: timeline.seconds, series: list, height: 230, seek, ...more })] : [];
  const modes = id === undefined ? [] : runs.flatMap((run) => {
    const values = modeOf(run, id);
    return values ? [{ label: run.name, values, colour: run.colour }] : [];
  });
  const of = id === undefined ? "camera in the world" : `${id} from the camera`;
  const isPositive = (list: ChartSeries[]) => list.every(({ values }) => values.every((value) => value === null || value > 0));
  const scaled = (list: ChartSeries[]) => (log && isPositive(list) ? { yLog: true } : {});
  const [distance, angle] = [series("distance"), series("angle")];
  const charts = [
    ...chart(`${of}: position, ${what} [mm]`, distance, scaled(distance)), ...chart(`${of}: rotation, ${what} [deg]`, angle, scaled(angle)),
    ...chart(`${of}: probability of the mode`, modes, { range: [-0.02, 1.02] }),
  ];
  group.replace(charts);
  return charts;
}

function errorsTab(comparison: Comparison, state: RunState, group: ChartGroup): HTMLElement {
  const { runs, ids } = comparison;
  const look = { sigma: false, log: false };
  const note = element("p", { class: "hint" });
  const fill = () => {
    const charts = curves(comparison, state, group, look);
    note.textContent = charts.length === 0 ? `No run has an estimate of ${state.nameOf(state.selected)}.` : "";
  };
  const names = [["-1", state.nameOf(CAMERA)], ...ids.map((id, i) => [String(i), id])] as [string, string][];
  const chooser = choice(comparison.hasTruth ? "Errors of" : "Differences of", names, String(state.selected), (value) => state.select(Number(value)));
  const list = chooser.querySelector("select")!;
  state.on("selection", () => {
    list.value = String(state.selected);
    fill();
  });
  fill();
  const controls = element("div", { class: "controls" }, chooser,
    toggle("Own 99.7 % bound", look.sigma, (on) => ((look.sigma = on), fill())), toggle("Logarithmic", look.log, (on) => ((look.log = on), fill())), note);
  return element("div", {}, controls, key(runs.map(({ name, colour }) => ({ name, colour }))), group.node);
}

function addKeys(state: RunState, keys: Keys): void {
  const step = (by: number) => () => {
    const count = state.trace.objects.length + 1;
    state.select(((state.selected + 1 + by + count) % count) - 1);
  };
  keys.add(["]"], "select the next object", step(1));
  keys.add(["["], "select the object before", step(-1));
}

function probe(comparison: Comparison, rows: MetricRow[], failures: Failure[], state: RunState, scenes: ReturnType<typeof makeScenes>["scenes"]): void {
  publish({
    kind: "comparison",
    runs: comparison.runs.map(({ name, colour }) => ({ name, colour })),
    frames: comparison.timeline.frames,
    rows: rows.map(({ entity, quantity, best, cells, frames }) => ({ entity, quantity, best, frames, values: cells.map(({ value }) => value), verdicts: cells.map(({ verdict }) => verdict) })),
    failures: failures.map(({ run, id, kind, from, until }) => ({ run: run.name, id, kind, from, until })),
    get frame() { return state.frame; },
    get selected() { return state.nameOf(state.selected); },
    get scenes() { return scenes?.count ?? 0; },
    get drawn() { return scenes?.overlay.drawn; },
    get besideFrames() { return scenes?.frames; },
    get eyes() { return scenes?.eyes; },
  });
}

export async function comparisonPage(payload: Payload): Promise<HTMLElement> {
  const comparison = await readComparison(payload.runs!);
  const rows = metricRows(comparison);
  const failures = failuresOf(comparison);
  const sentences = verdictSentences(comparison, rows);
  const state = new RunState(comparison.timeline, failures.length > 0 ? Math.max(0, comparison.ids.indexOf(failures[0].id)) : 0);
  const keys = new Keys();
  addKeys(state, keys);
  const player = new Player(state, keys);
  const { node: stage, scenes } = makeScenes(comparison, state);
  const group = new ChartGroup();
  state.on("frame", () => group.update(state.seconds));
  const pages = tabs("Comparison", [
    { name: "Metrics", build: () => metricsTable(comparison, rows) },
    { name: comparison.hasTruth ? "Errors" : "Differences", build: () => errorsTab(comparison, state, group), open: () => group.mark() },
    { name: "Failures", build: () => failureList(comparison, failures) },
    { name: "Runs", build: () => runList(comparison) },
  ], (name) => state.setTab(name));
  state.on("tab", () => pages.show(state.tab));
  probe(comparison, rows, failures, state, scenes);
  printComparison(payload, comparison, rows, failures, sentences, () => scenes?.viewport, () => `${state.seconds.toFixed(2)} s`);
  const names = comparison.runs.map(({ name }) => name).join(", ");
  const node = element("div", { class: "page slam comparison" }, header(payload, `${names} · ${comparison.timeline.frames} frames, ${comparison.timeline.seconds[comparison.timeline.frames - 1].toFixed(1)} s`, keys),
    element("main", {}, topNode(comparison, sentences, failures),
      element("div", { class: "columns" }, element("div", { class: "stage" }, stage, player.node), pages.node)), footer(payload));
  bindAddress(state);
  return node;
}
