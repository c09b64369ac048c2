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

const STRUCTURE_BINS = 60;
/** Less than this is a single Gaussian, as far as so many samples can tell [nat]. */
const LEAST_STRUCTURE = 0.03;

/** How far angles are from one Gaussian: its entropy less theirs [nat], and their standard deviation. */
export function structureOf(angles: Float64Array): { excess: number; sd: number } {
  const mean = angles.reduce((sum, angle) => sum + angle, 0) / angles.length;
  const sd = Math.sqrt(angles.reduce((sum, angle) => sum + (angle - mean) ** 2, 0) / angles.length);
  const { x, density } = histogram(angles, new Int32Array(angles.length), 1, STRUCTURE_BINS);
  const width = x[1] - x[0];
  const entropy = density[0].reduce((sum, value) => (value > 0 ? sum - value * width * Math.log(value) : sum), 0);
  return { excess: sd > 0 ? 0.5 * Math.log(2 * Math.PI * Math.E * sd * sd) - entropy : 0, sd };
}

/** The axis about which there is most to see: several peaks, or else the widest one. */
export function axisOfInterest(mixture: Mixture, samples: Samples, frame: AngleFrame): number {
  const found = [0, 1, 2].map((axis) => structureOf(anglesOf(mixture, samples, axis, frame)));
  const best = [0, 1, 2].reduce((a, b) => (found[b].excess > found[a].excess ? b : a));
  if (found[best].excess > LEAST_STRUCTURE) return best;
  return [0, 1, 2].reduce((a, b) => (found[b].sd > found[a].sd ? b : a));
}
