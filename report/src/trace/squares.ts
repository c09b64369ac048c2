// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Squared normalised errors and innovations that the program computed with the whole covariance.
import { chiSquareQuantile } from "../math/chi_square.ts";
import { CAMERA, type Entity } from "../state/run_state.ts";
import type { Estimate, Trace } from "./trace.ts";

/** Which pose of an object: as seen from the camera, or in the world. */
export type Of = "relative" | "world";
export type Square = (frame: number) => number | undefined;

/** Degrees of freedom of NEES and NIS. */
export const POSE_DOF = 6;
/** Where 95 % of the frames of a consistent pose lie. */
export const BAND: readonly [number, number] = [chiSquareQuantile(0.025, POSE_DOF), chiSquareQuantile(0.975, POSE_DOF)];
const NIS_BIT = 1 << 8;

export function estimateOf(trace: Trace, entity: Entity, of: Of): Estimate | undefined {
  return entity === CAMERA ? trace.camera : trace.objects[entity]?.[of];
}

/** NEES of a pose over the frames that have an estimate and a truth; undefined where the run does not say. */
export function neesOf(trace: Trace, entity: Entity, of: Of): Square | undefined {
  const name = entity === CAMERA ? "camera" : `objects/${trace.objects[entity].id}/${of}`;
  const column = trace.columns.get(`${name}/nees`);
  const estimate = estimateOf(trace, entity, of);
  if (!column || !estimate?.truth) return undefined;
  const { pose, truth } = estimate;
  return (frame) => (pose.has(frame) && truth.has(frame) ? column.value(0, frame) : undefined);
}

/** NIS of the detections of an object that were used. */
export function nisOf(trace: Trace, entity: Entity): Square | undefined {
  if (entity === CAMERA) return undefined;
  const name = `objects/${trace.objects[entity].id}`;
  const column = trace.columns.get(`${name}/nis`);
  const mask = trace.columns.get(`${name}/mask`)?.components[0];
  if (!column || !mask) return undefined;
  return (frame) => ((mask[frame] & NIS_BIT) !== 0 ? column.value(0, frame) : undefined);
}

export const hasSquares = (trace: Trace, end: "nees" | "nis"): boolean => [...trace.columns.keys()].some((name) => name.endsWith(`/${end}`));

/** The values of all frames, NaN where there is none. */
export function squaresOf(trace: Trace, square: Square | undefined): Float32Array | undefined {
  return square && Float32Array.from({ length: trace.frames }, (_, frame) => square(frame) ?? NaN);
}

export interface Within {
  frames: number;
  within: number;
  above: number;
}

/** How many values are in the band, and above it; a frame without one has null or NaN. */
export function withinBand(values: Iterable<number | null>): Within {
  const found = { frames: 0, within: 0, above: 0 };
  for (const value of values) {
    if (value === null || Number.isNaN(value)) continue;
    ++found.frames;
    if (value > BAND[1]) ++found.above;
    else if (value >= BAND[0]) ++found.within;
  }
  return found;
}
