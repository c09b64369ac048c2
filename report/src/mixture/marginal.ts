// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The angle of a mixture's rotation about an axis.
import { DEGREES, multiply, multiplyInverse, twistAngle, type Vec3 } from "../math/rotation.ts";
import type { Mixture } from "./mixture.ts";
import type { Samples } from "./sample.ts";

export type AngleFrame = "body" | "reference";

/** The angle of every sample about an axis, relative to the heaviest component's mean [deg]. */
export function anglesOf(mixture: Mixture, samples: Samples, axis: number, frame: AngleFrame): Float64Array {
  const heaviest = mixture.components.reduce((best, one) => (one.weight > best.weight ? one : best));
  const direction: Vec3 = [0, 0, 0];
  direction[axis] = 1;
  const turned = [0, 0, 0, 1];
  const inverse = heaviest.quaternion.map((value, i) => (i < 3 ? -value : value));
  const angles = new Float64Array(samples.count);
  for (let i = 0; i < samples.count; ++i) {
    const q = samples.quaternions.subarray(4 * i, 4 * i + 4);
    if (frame === "body") multiply(inverse, q, turned);
    else multiplyInverse(q, heaviest.quaternion, turned);
    angles[i] = twistAngle(turned, direction) * DEGREES;
  }
  return angles;
}

/** Share per degree in bins over the range of the angles: for all samples, then by component. */
export function histogram(angles: Float64Array, components: Int32Array, count: number, bins: number): { x: number[]; density: number[][] } {
  const [low, high] = [angles.reduce((a, b) => Math.min(a, b), 180), angles.reduce((a, b) => Math.max(a, b), -180)];
  const width = Math.max((high - low) / bins, 1e-6);
  const density = Array.from({ length: 1 + count }, () => new Array<number>(bins).fill(0));
  angles.forEach((angle, i) => {
    const bin = Math.min(bins - 1, Math.floor((angle - low) / width));
    density[0][bin] += 1 / (angles.length * width);
    density[1 + components[i]][bin] += 1 / (angles.length * width);
  });
  return { x: Array.from({ length: bins }, (_, i) => low + (i + 0.5) * width), density };
}
