// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Errors in units of their standard deviations.
import { log, multiplyInverse } from "../math/rotation.ts";
import type { Estimate } from "./trace.ts";

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
