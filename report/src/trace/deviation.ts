// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Errors in units of their standard deviations.
import { effectiveFrames } from "../math/statistics.ts";
import { log, multiplyInverse } from "../math/rotation.ts";
import type { Estimate } from "./trace.ts";

export const AXIS_NAMES = ["rotation x", "rotation y", "rotation z", "position x", "position y", "position z"] as const;
/** What is known as exactly is given, not estimated, as the camera's pose before it moved [rad, m]. */
const EXACT = 1e-9;

/** Errors of an estimate against its truth. */
export interface Deviation {
  /** By axis and frame error / sigma; NaN where there is none. */
  ratios: Float32Array[];
  /** The largest of the six |error| / sigma; NaN where there is none. */
  largest: Float32Array;
  /** Frames with an error, and in how many of these each axis is beyond 3 sigma. */
  frames: number;
  outside: number[];
}

export function deviationOf(estimate: Estimate, frames: number): Deviation | undefined {
  const { pose, truth } = estimate;
  if (!truth || !estimate.hasSd || !estimate.hasPositionSd) return undefined;
  const empty = () => new Float32Array(frames).fill(NaN);
  const ratios = AXIS_NAMES.map(empty);
  const largest = empty();
  const outside = [0, 0, 0, 0, 0, 0];
  const [p, t, e, sd] = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  let counted = 0;
  let most = -1;
  const take = (error: number, sigma: number, axis: number, frame: number) => {
    if (!(sigma > EXACT)) return;
    ratios[axis][frame] = error / sigma;
    const size = Math.abs(error / sigma);
    if (size > 3) ++outside[axis];
    if (size > most) most = size;
  };
  for (let frame = 0; frame < frames; ++frame) {
    if (!pose.has(frame) || !truth.has(frame)) continue;
    most = -1;
    pose.quaternion(frame, q);
    truth.quaternion(frame, r);
    multiplyInverse(r, q, r);
    log(r, e);
    estimate.rotationSd(frame, sd);
    for (let i = 0; i < 3; ++i) take(e[i], sd[i], i, frame);
    pose.position(frame, p);
    truth.position(frame, t);
    estimate.positionSdAt(frame, sd);
    for (let i = 0; i < 3; ++i) take(t[i] - p[i], sd[i], i + 3, frame);
    if (most < 0) continue;
    ++counted;
    largest[frame] = most;
  }
  return counted > 0 ? { ratios, largest, frames: counted, outside } : undefined;
}

/** The axis with the most errors beyond 3 sigma, and their share. */
export function worstAxis({ frames, outside }: Pick<Deviation, "frames" | "outside">): { name: string; share: number } {
  const most = Math.max(...outside);
  return { name: AXIS_NAMES[outside.indexOf(most)], share: most / frames };
}

/** All frames in which an error is beyond 3 sigma. */
export const framesBeyond = ({ largest }: Deviation): number => largest.reduce((count, size) => count + (size > 3 ? 1 : 0), 0);

/** The number of independent frames that say as much as those that are taken. */
export function effectiveOf({ ratios, largest }: Deviation, take: (frame: number) => boolean = () => true): number {
  const taken: number[] = [];
  largest.forEach((size, frame) => {
    if (!Number.isNaN(size) && take(frame)) taken.push(frame);
  });
  const lists = ratios.map((list) => Float64Array.from(taken, (frame) => list[frame])).filter((list) => !list.some(Number.isNaN));
  return effectiveFrames(lists);
}
