// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How many times larger than true uncertainty is drawn, so that it is visible. It is one factor for a run: what shrinks is seen to shrink.
import { largestEigenvalue } from "../math/linear.ts";
import { median } from "../math/statistics.ts";
import type { Estimate, Trace } from "../trace/trace.ts";

export const FACTORS = [1, 10, 100] as const;
const SAMPLES = 400;

/** The smallest factor with which a size is visible, or a smaller one where it would let the largest hide the scene. */
export function factorFor(size: number, visible: number, largest: number, most: number): number {
  if (!(size > 0)) return FACTORS[0];
  const wanted = FACTORS.find((factor) => factor * size >= visible) ?? FACTORS[FACTORS.length - 1];
  return [...FACTORS].reverse().find((factor) => factor <= wanted && factor * largest <= most) ?? FACTORS[0];
}

/** The factor of a run, by the 3 sigma of the position of the median object: its median over the frames, and its largest. */
export function exaggerationOf(trace: Trace, of: (index: number) => Estimate | undefined, visible: number, most: number): number {
  const step = Math.max(1, Math.floor(trace.frames / SAMPLES));
  const covariance = new Float64Array(9);
  const medians: number[] = [];
  for (let frame = 0; frame < trace.frames; frame += step) {
    const sizes = trace.objects.flatMap((_, index) => {
      const estimate = of(index);
      if (!estimate?.hasCovariance || !estimate.pose.has(frame)) return [];
      estimate.covariance(frame, covariance);
      return [3 * Math.sqrt(Math.max(0, largestEigenvalue(covariance)))];
    });
    if (sizes.length > 0) medians.push(median(sizes));
  }
  return factorFor(median(medians), visible, Math.max(...medians), most);
}
