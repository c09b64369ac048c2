// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How many times larger than true uncertainty is drawn, so that it is visible.
import { largestEigenvalue } from "../math/linear.ts";
import type { Estimate, Trace } from "../trace/trace.ts";

export const FACTORS = [1, 10, 100] as const;
const SAMPLES = 400;
/** What is drawn smaller than this by the last factor gets a larger one; and a smaller factor must show clearly more. */
const CALM = 1.6;

/** The smallest factor with which a size is visible; the last one is kept near the bound, so that it does not flicker. */
export function factorFor(size: number, visible: number, last: number): number {
  if (!(size > 0)) return last;
  const found = FACTORS.find((factor) => factor * size >= visible) ?? FACTORS[FACTORS.length - 1];
  return found < last && found * size < CALM * visible ? last : found;
}

/** The factor over the frames, by the median object's 3 sigma. */
export class Exaggeration {
  private readonly step: number;
  private readonly factors: Uint8Array;

  constructor(trace: Trace, of: (index: number) => Estimate | undefined, visible: number) {
    this.step = Math.max(1, Math.floor(trace.frames / SAMPLES));
    this.factors = new Uint8Array(Math.ceil(trace.frames / this.step));
    const covariance = new Float64Array(9);
    let last: number = FACTORS[0];
    for (let k = 0; k < this.factors.length; ++k) {
      const sizes: number[] = [];
      trace.objects.forEach((_, index) => {
        const estimate = of(index);
        if (!estimate?.hasCovariance || !estimate.pose.has(k * this.step)) return;
        estimate.covariance(k * this.step, covariance);
        sizes.push(3 * Math.sqrt(Math.max(0, largestEigenvalue(covariance))));
      });
      sizes.sort((a, b) => a - b);
      last = factorFor(sizes[Math.floor(sizes.length / 2)] ?? 0, visible, last);
      this.factors[k] = last;
    }
  }

  at(frame: number): number {
    return this.factors[Math.min(this.factors.length - 1, Math.floor(frame / this.step))];
  }
}
