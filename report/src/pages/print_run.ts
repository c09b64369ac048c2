// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The summary of a run for print: what was estimated and how well, the scene, and the plots that matter.
import { median } from "../math/statistics.ts";
import { isObject, type Json, type Payload } from "../payload.ts";
import { errorNorms, spreadOf } from "../plots/series.ts";
import { timePlot, type TimeSeries } from "../plots/time_plot.ts";
import type { Viewport } from "../scene/viewport.ts";
import type { Estimate, Trace } from "../trace/trace.ts";
import { element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { key } from "../plots/drawing.ts";
import { markedForPrint, onPrint, printHeader, type PrintTable, printTable, scenePicture, sheetOf } from "../ui/print.ts";
import { provenanceLines } from "./provenance.ts";

const INK = "#1d2125";
const BOUND = "99.7 % bound";
const MOST_OBJECTS = 15;
const MOST_TROUBLES = 8;
const PLOT = { width: 430, height: 200 };

type Values = (number | null)[];

const rms = (values: Values): number | null => {
  const known = values.filter((value): value is number => value !== null);
  return known.length === 0 ? null : Math.sqrt(known.reduce((sum, value) => sum + value * value, 0) / known.length);
};
const middle = (values: Values): number | null => {
  const known = values.filter((value): value is number => value !== null);
  return known.length === 0 ? null : median(known);
};

interface Entity {
  name: string;
  colour: string;
  estimate: Estimate | undefined;
  mode: Values | undefined;
}

function entitiesOf(trace: Trace): Entity[] {
  const objects = trace.objects.slice(0, MOST_OBJECTS).map(({ id, relative, modeProbability }, i): Entity => ({
    name: id, colour: colourOf(i), estimate: relative,
    mode: modeProbability && Array.from({ length: trace.frames }, (_, frame) => modeProbability(frame) ?? null),
  }));
  return [{ name: trace.cameraName, colour: INK, estimate: trace.camera, mode: undefined }, ...objects];
}

function aneesOf(payload: Payload, id: string | undefined): Json {
  const metrics = payload.documents["metrics.json"];
  if (id === undefined) {
    const camera = isObject(metrics) ? metrics["camera_consistency"] : undefined;
    return isObject(camera) ? (camera["anees"] ?? null) : null;
  }
  const consistency = isObject(metrics) ? metrics["consistency"] : undefined;
  const anees = isObject(consistency) ? consistency["relative_anees"] : undefined;
  return isObject(anees) && Object.hasOwn(anees, id) ? anees[id] : null;
}

interface Measured extends Entity {
  distance: Values;
  angle: Values;
}

/** Errors where there is truth, else what their norm should exceed in 0.27 % of the frames. */
function measured(trace: Trace, entity: Entity): Measured | undefined {
  const { estimate } = entity;
  if (!estimate) return undefined;
  const { truth } = estimate;
  const found = truth ? errorNorms(estimate.pose, truth, trace.frames) : spreadOf(estimate, trace.frames);
  return { ...entity, distance: found.distance, angle: found.angle };
}

function summary(payload: Payload, trace: Trace, list: Measured[]): PrintTable {
  const hasTruth = trace.hasTruth;
  const [what, of] = hasTruth ? ["error", rms] : [BOUND, middle];
  const kind = hasTruth ? "rms" : "median";
  return {
    name: hasTruth ? "Errors: the camera in the world, objects as seen from the camera" : "Uncertainty; there is no ground truth, so that errors are not known",
    columns: ["", "frames", `position ${what}, ${kind}_mm`, `rotation ${what}, ${kind}_deg`, "ANEES (expected 1)", "mode probability at the end"],
    rows: list.map(({ name, estimate, distance, angle, mode }) => {
      const end = mode?.filter((value) => value !== null).pop() ?? null;
      return [name, distance.filter((value) => value !== null).length, of(distance), of(angle), aneesOf(payload, estimate === trace.camera ? undefined : name), end];
    }),
  };
}

function plots(trace: Trace, list: Measured[]): HTMLElement {
  const what = trace.hasTruth ? "error" : BOUND;
  const camera = list.find(({ estimate }) => estimate === trace.camera);
  const objects = list.filter((one) => one !== camera);
  const plot = (title: string, series: TimeSeries[], range?: [number, number]) =>
    series.length > 0 ? [timePlot({ title, seconds: trace.seconds, series, ...PLOT, ...(range ? { range } : {}) })] : [];
  const line = ({ name, colour }: Entity, values: Values): TimeSeries => ({ name, colour, values });
  // The bounds of many objects would hide their errors.
  const bound = trace.hasTruth && camera?.estimate ? spreadOf(camera.estimate, trace.frames) : undefined;
  const dashed = (values: Values): TimeSeries => ({ name: BOUND, colour: INK, values, look: "dashed" });
  const title = (part: string, unit: string) => `${trace.cameraName}: ${part} ${what}${bound ? `, dashed: ${BOUND}` : ""} [${unit}]`;
  return element("div", { class: "print-plots" },
    ...plot(title("position", "mm"), camera ? [line(camera, camera.distance), ...(bound ? [dashed(bound.distance)] : [])] : []),
    ...plot(title("rotation", "deg"), camera ? [line(camera, camera.angle), ...(bound ? [dashed(bound.angle)] : [])] : []),
    ...plot(`objects from the camera: position ${what} [mm]`, objects.map((one) => line(one, one.distance))),
    ...plot(`objects from the camera: rotation ${what} [deg]`, objects.map((one) => line(one, one.angle))),
    ...plot("probability of the mode", objects.flatMap((one) => (one.mode ? [line(one, one.mode)] : [])), [0, 1.02]));
}

/** A list that is too long for its sheet ends with how many are left. */
function shortened(part: Node): Node {
  if (!(part instanceof Element)) return part;
  for (const list of part.querySelectorAll(".troubles")) {
    const left = [...list.children].slice(MOST_TROUBLES);
    if (left.length < 2) continue;
    left.forEach((item) => item.remove());
    list.append(element("li", {}, `${left.length} more are in the page.`));
  }
  return part;
}

export function printRun(payload: Payload, trace: Trace, viewport: () => Viewport | undefined, moment: () => string): void {
  onPrint(() => {
    const list = entitiesOf(trace).flatMap((entity) => measured(trace, entity) ?? []);
    const left = trace.objects.length - MOST_OBJECTS;
    const duration = (trace.seconds[trace.frames - 1] ?? 0).toFixed(1);
    const lines = [`${trace.head.method}, ${trace.frames} frames, ${duration} s`, ...provenanceLines(payload.documents)];
    const entries = list.map(({ name, colour }) => ({ name, colour }));
    return [
      sheetOf(printHeader(payload.title, lines), ...markedForPrint().map(shortened), ...scenePicture(viewport(), `The scene at ${moment()}`),
        printTable(summary(payload, trace, list), MOST_OBJECTS + 1)),
      sheetOf(plots(trace, list), key(entries), ...(left > 0 ? [element("p", { class: "hint" }, `${left} more objects are in the page.`)] : [])),
    ];
  });
}
