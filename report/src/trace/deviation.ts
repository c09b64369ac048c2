// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Errors in units of their standard deviations, and NEES.
import { log, multiplyInverse } from "../math/rotation.ts";
import type { Estimate, Trace } from "./trace.ts";

export const AXIS_NAMES = ["rotation x", "rotation y", "rotation z", "position x", "position y", "position z"] as const;

/** Errors of an estimate against its truth. */
export interface Deviation {
  /** The largest of the six |error| / sigma; NaN where there is none. */
  largest: Float32Array;
  /** Frames with an error, and in how many of these each axis is beyond 3 sigma. */
  frames: number;
  outside: number[];
}

export function deviationOf(estimate: Estimate, frames: number): Deviation | undefined {
  const { pose, truth } = estimate;
  if (!truth || !estimate.hasSd || !estimate.hasPositionSd) return undefined;
  const largest = new Float32Array(frames).fill(NaN);
  const outside = [0, 0, 0, 0, 0, 0];
  const [p, t, e, sd] = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  let counted = 0;
  let most = 0;
  const take = (error: number, sigma: number, axis: number) => {
    const ratio = Math.abs(error) / Math.max(sigma, 1e-12);
    if (ratio > 3) ++outside[axis];
    if (ratio > most) most = ratio;
  };
  for (let frame = 0; frame < frames; ++frame) {
    if (!pose.has(frame) || !truth.has(frame)) continue;
    ++counted;
    most = 0;
    pose.quaternion(frame, q);
    truth.quaternion(frame, r);
    multiplyInverse(r, q, r);
    log(r, e);
    estimate.rotationSd(frame, sd);
    for (let i = 0; i < 3; ++i) take(e[i], sd[i], i);
    pose.position(frame, p);
    truth.position(frame, t);
    estimate.positionSdAt(frame, sd);
    for (let i = 0; i < 3; ++i) take(t[i] - p[i], sd[i], i + 3);
    largest[frame] = most;
  }
  return counted > 0 ? { largest, frames: counted, outside } : undefined;
}

/** A column of squares over the frames that have one; NaN elsewhere. */
function squares(trace: Trace, name: string, has: (frame: number) => boolean): Float32Array | undefined {
  const column = trace.columns.get(name);
  if (!column) return undefined;
  return Float32Array.from({ length: trace.frames }, (_, frame) => (has(frame) ? column.value(0, frame) : NaN));
}

/** NEES of six degrees of freedom of the camera, or of an object as seen from it or in the world. */
export function neesOf(trace: Trace, entity: number, of: "world" | "relative"): Float32Array | undefined {
  const estimate = entity < 0 ? trace.camera : trace.objects[entity][of];
  const truth = estimate?.truth;
  const name = entity < 0 ? "camera/nees" : `objects/${trace.objects[entity].id}/${of}/nees`;
  return truth && squares(trace, name, (frame) => truth.has(frame) && estimate.pose.has(frame));
}

const NIS_BIT = 1 << 8;

/** Squared Mahalanobis distances of the innovations of an object. */
export function nisOf(trace: Trace, index: number): Float32Array | undefined {
  const name = `objects/${trace.objects[index].id}`;
  const mask = trace.columns.get(`${name}/mask`)?.components[0];
  return mask && squares(trace, `${name}/nis`, (frame) => (mask[frame] & NIS_BIT) !== 0);
}
