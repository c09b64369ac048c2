// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How sure a filter is of the mode of an object, over a run.
import type { Trace } from "./trace.ts";

/** Probability of the mode; where the filter has none, the weight of its heaviest hypothesis, or one. NaN: not there. */
export function sureness(trace: Trace, index: number, frame: number): number {
  const { modeProbability, hypotheses, world, relative } = trace.objects[index];
  if (!(world ?? relative)?.pose.has(frame)) return NaN;
  const mode = modeProbability?.(frame);
  if (mode !== undefined) return mode;
  let heaviest = -1;
  for (const slot of hypotheses) if (slot.pose.has(frame)) heaviest = Math.max(heaviest, slot.probability(frame));
  return heaviest >= 0 ? heaviest : 1;
}

/** The least of every group of frames that falls on one pixel, so that a dip of one frame is seen. */
export function leastByPixel(trace: Trace, index: number, pixels: number): Float32Array {
  const out = new Float32Array(pixels).fill(NaN);
  const { frames } = trace;
  for (let x = 0; x < pixels; ++x) {
    const last = Math.max(Math.floor((x * frames) / pixels) + 1, Math.floor(((x + 1) * frames) / pixels));
    for (let frame = Math.floor((x * frames) / pixels); frame < last; ++frame) {
      const value = sureness(trace, index, frame);
      if (!Number.isNaN(value) && !(value > out[x])) out[x] = value;
    }
  }
  return out;
}
