// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Runs of three filters over one recording that nobody made: the same truth, errors of known size, and one that fails.
import { normal, uniform } from "../src/mixture/sample.ts";
import type { JsonObject } from "../src/payload.ts";
import { packTrace, type TraceJson } from "./pack.ts";

export interface RunShape {
  name: string;
  seed: number;
  /** Standard deviation of the camera's position by axis [m]. */
  cameraNoise: number;
  /** Of the objects as seen from the camera. */
  objectNoise: number;
  /** From when on the tea-box is turned by half a turn about z [s]; never if undefined. */
  flipsAt?: number;
  frames?: number;
  truth?: boolean;
  /** The stamp of the first frame [s]. */
  start?: number;
  report?: string;
  /** Of the run, as the program writes it; else one of its own. */
  id?: string;
  /** Of another number are other detections. */
  recording?: number;
  /** By how much the true poses are others than those of the other runs [m]. */
  truthShift?: number;
  /** By how much its poses of objects are off [m]. */
  offset?: number;
  /** What the run believes of the positions of objects and camera, by axis [m]. */
  positionSd?: number;
}

export const PERIOD = 0.1;
export const IDS = ["mug", "tea-box"];

type Pose = number[];

function turned(pose: Pose, z: number): Pose {
  const [x, y, w0, w] = pose.slice(3);
  const [s, c] = [Math.sin(z / 2), Math.cos(z / 2)];
  return [...pose.slice(0, 3), x * c + y * s, y * c - x * s, w0 * c + w * s, w * c - w0 * s];
}

const still = (i: number): Pose => [0.2 * i, 0.1, 0.05, 0, 0, 0, 1];
const path = (t: number): Pose => [Math.cos(0.3 * t), Math.sin(0.3 * t), 0.6, 0, 1, 0, 0];
const seen = (i: number): Pose => [0.05 * i, 0.02, 0.9, 0.5, 0.5, 0.5, 0.5];

export function runTrace({ seed, cameraNoise, objectNoise, flipsAt, frames = 200, truth = true, start = 50, name, recording = 1, truthShift = 0, positionSd = 0.005, offset = 0 }: RunShape): TraceJson {
  const gauss = normal(uniform(seed));
  const shaken = (pose: Pose, size: number) => pose.map((value, k) => (k < 3 ? value + size * gauss() : value));
  // All runs are of one recording: they have the same detections.
  const chance = normal(uniform(recording));
  const detected = (pose: Pose) => pose.map((value, k) => (k < 3 ? value + 0.004 * chance() : value));
  const every = <T>(make: (i: number) => T) => Array.from({ length: frames }, (_, i) => make(i));
  const sd = every(() => [0.02, 0.02, 0.02, positionSd, positionSd, positionSd]);
  const covariance = every(() => [positionSd ** 2, 0, 0, positionSd ** 2, 0, positionSd ** 2]);
  const track = (pose: Pose[], true_: Pose[]) => ({ pose, sd, position_covariance: covariance, truth: truth ? true_.map((pose) => [pose[0] + truthShift, ...pose.slice(1)]) : null });
  const moved = (pose: Pose) => [pose[0] + offset, ...pose.slice(1)];
  const at = (i: number) => start - 50 + PERIOD * i;
  const object = (id: string, k: number) => {
    const flip = (i: number) => (id === "tea-box" && flipsAt !== undefined && at(i) >= flipsAt - 1e-9 ? Math.PI : 0);
    return {
      world: track(every((i) => turned(shaken(still(k), objectNoise), flip(i))), every(() => still(k))),
      relative: track(every((i) => turned(shaken(moved(seen(k)), objectNoise), flip(i))), every(() => seen(k))),
      detection: every(() => detected(seen(k))), status: every((i) => (i === 0 ? "started" : flip(i) ? "gated" : "used")),
      mode_probability: every((i) => (flip(i) ? 0.98 : 0.9)),
      alternatives: every(() => [{ id: k, probability: 0.9, pose: still(k) }]),
    };
  };
  return {
    name: "table", method: name, frames, stamps_s: every((i) => start + PERIOD * i), order: IDS,
    camera: track(every((i) => shaken(path(at(i)), cameraNoise)), every((i) => path(at(i)))),
    objects: Object.fromEntries(IDS.map((id, k) => [id, object(id, k)])), hypotheses: every(() => []),
  };
}

export const GOOD: RunShape = { name: "multi-object", seed: 3, cameraNoise: 0.002, objectNoise: 0.001, report: "multi-object/report.html" };
export const EQUAL: RunShape = { name: "gm-iekf", seed: 14, cameraNoise: 0.002, objectNoise: 0.001 };
export const FAILING: RunShape = { name: "riekf", seed: 5, cameraNoise: 0.006, objectNoise: 0.001, flipsAt: 12.3, report: "riekf/report.html" };

function provenance(shape: RunShape): JsonObject {
  return {
    program: "posemix", version: "0.2.0", command: ["posemix", "slam", "sequence.toml", "--set", `filter.method=${shape.name}`, "--out", shape.name], seed: 1,
    started: "2026-03-01T12:00:00Z", settings: { filter: { method: shape.name, components: 4 } }, inputs: [{ path: "sequence.toml", sha256: "ab12" }],
  };
}

export function comparisonReport(shapes: RunShape[] = [GOOD, EQUAL, FAILING], more: JsonObject = {}): JsonObject {
  const runs = shapes.map((shape): JsonObject => ({
    name: shape.name, trace: packTrace(runTrace(shape)) as unknown as JsonObject,
    documents: { "metrics.json": { schema: 1, method: shape.name, consistency: { relative_anees: { mug: 1.1, "tea-box": shape.flipsAt === undefined ? 1.2 : 900 } }, timing: { frame_median_us: 100 * shape.seed }, provenance: provenance(shape), run: shape.id ?? `run of ${shape.seed}` } },
    ...(shape.report ? { report: shape.report } : {}),
  }));
  return { schema: 1, type: "posemix.report", kind: "comparison", title: "Three filters on a table", program: "posemix 0.2.0", documents: {}, tables: {}, pictures: {}, texts: {}, runs, ...more };
}
