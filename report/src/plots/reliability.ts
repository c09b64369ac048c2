// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether what is said to be right with a probability is right as often.
import { rightAt } from "../trace/right_mode.ts";
import type { ObjectTrack, Trace } from "../trace/trace.ts";

export const BINS = 10;

export interface Bin {
  frames: number;
  /** Sum of the probabilities. */
  said: number;
  /** Frames on the right mode. */
  right: number;
}

export interface Reliability {
  bins: Bin[];
  frames: number;
  /** Mean squared difference of probability and outcome. */
  brier: number;
}

const estimateWithTruth = ({ relative, world }: ObjectTrack) => [relative, world].find((one) => one?.truth !== undefined);

/** Of some objects together; undefined where there is no probability or no truth. */
export function reliabilityOf(trace: Trace, objects: readonly ObjectTrack[]): Reliability | undefined {
  const bins: Bin[] = Array.from({ length: BINS }, () => ({ frames: 0, said: 0, right: 0 }));
  let [frames, squares] = [0, 0];
  for (const object of objects) {
    const estimate = estimateWithTruth(object);
    if (!estimate || !object.modeProbability) continue;
    const right = rightAt(estimate);
    for (let frame = 0; frame < trace.frames; ++frame) {
      const said = object.modeProbability(frame);
      const is = right(frame);
      if (said === undefined || is === undefined) continue;
      const bin = bins[Math.min(BINS - 1, Math.floor(said * BINS))];
      ++bin.frames;
      bin.said += said;
      if (is) ++bin.right;
      ++frames;
      squares += (said - Number(is)) ** 2;
    }
  }
  return frames > 0 ? { bins, frames, brier: squares / frames } : undefined;
}
