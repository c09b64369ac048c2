// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How many times larger than true uncertainty is drawn, so that it is visible. It is one factor for a run: what shrinks is seen to shrink.
import { largestEigenvalue } from "../math/linear.ts";
import type { Estimate, Trace } from "../trace/trace.ts";

export const FACTORS = [1, 10, 100] as const;
const SAMPLES = 400;

/** The smallest factor with which a size is visible. */
export function factorFor(size: number, visible: number): number {
  if (!(size > 0)) return FACTORS[0];
  return FACTORS.find((factor) => factor * size >= visible) ?? FACTORS[FACTORS.length - 1];
}

/** The factor of a run, by the median 3 sigma of the positions of its objects over its frames. */
export function exaggerationOf(trace: Trace, of: (index: number) => Estimate | undefined, visible: number): number {
  const step = Math.max(1, Math.floor(trace.frames / SAMPLES));
  const covariance = new Float64Array(9);
  const sizes: number[] = [];
  trace.objects.forEach((_, index) => {
    const estimate = of(index);
    if (!estimate?.hasCovariance) return;
    for (let frame = 0; frame < trace.frames; frame += step) {
      if (!estimate.pose.has(frame)) continue;
      estimate.covariance(frame, covariance);
      sizes.push(3 * Math.sqrt(Math.max(0, largestEigenvalue(covariance))));
    }
  });
  sizes.sort((a, b) => a - b);
  return factorFor(sizes[Math.floor(sizes.length / 2)] ?? 0, visible);
}
