// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Samples from mixtures, the same ones every time.
import { cholesky } from "../math/linear.ts";
import { multiply, quaternionOf, rotate } from "../math/rotation.ts";
import { type Component, type Mixture, project } from "./mixture.ts";

const MOST_TRIES = 10000;

/** Uniform numbers in [0, 1) (mulberry32). */
export function uniform(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Standard normal numbers (Box and Muller). */
export function normal(random: () => number): () => number {
  let spare = NaN;
  return () => {
    if (!Number.isNaN(spare)) {
      const value = spare;
      spare = NaN;
      return value;
    }
    const radius = Math.sqrt(-2 * Math.log(1 - random()));
    const angle = 2 * Math.PI * random();
    spare = radius * Math.sin(angle);
    return radius * Math.cos(angle);
  };
}

export interface Samples {
  count: number;
  /** Three numbers per sample. */
  positions: Float64Array;
  /** Four numbers per sample, x y z w. */
  quaternions: Float64Array;
  /** The component of each sample. */
  components: Int32Array;
}

/** Exp of xi = [phi; rho] on SE(3): rotation as a quaternion, translation J_l(phi) rho. */
export function expPose(xi: ArrayLike<number>, q: number[], t: number[]): void {
  const phi = [xi[0], xi[1], xi[2]];
  const angle = Math.hypot(phi[0], phi[1], phi[2]);
  const square = angle * angle;
  const a = angle < 1e-3 ? 0.5 - square / 24 : (1 - Math.cos(angle)) / square;
  const b = angle < 1e-3 ? 1 / 6 - square / 120 : (angle - Math.sin(angle)) / (square * angle);
  const cross = (v: number[], w: number[]) => [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
  const rho = [xi[3], xi[4], xi[5]];
  const once = cross(phi, rho);
  const twice = cross(phi, once);
  for (let i = 0; i < 3; ++i) t[i] = rho[i] + a * once[i] + b * twice[i];
  quaternionOf(phi, q);
}

/** Draws a sample of one component into q and t. */
class Drawer {
  private readonly z = new Float64Array(6);
  private readonly y = new Float64Array(6);
  private readonly root = new Float64Array(36);

  constructor(
    private readonly mixture: Mixture,
    private readonly component: Component,
    private readonly random: () => number,
    private readonly gauss: () => number,
  ) {
    cholesky(component.covariance, 6, this.root);
  }

  draw(q: number[], t: number[]): void {
    if (this.mixture.distribution === "projected") this.projected(q, t);
    else this.concentrated(q, t);
  }

  private gaussian(): void {
    for (let i = 0; i < 6; ++i) this.z[i] = this.gauss();
    for (let i = 0; i < 6; ++i) {
      this.y[i] = 0;
      for (let j = 0; j <= i; ++j) this.y[i] += this.root[6 * i + j] * this.z[j];
    }
  }

  /** Rejection sampling: the distribution is the Gaussian times (1 + u.u)^-2, up to a constant. */
  private projected(q: number[], t: number[]): void {
    const { translation, tangentPoint, u } = this.component;
    const { y } = this;
    for (let tries = 0; tries < MOST_TRIES; ++tries) {
      this.gaussian();
      for (let i = 0; i < 3; ++i) y[i] += u[i];
      if (this.random() < (1 + y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) ** -2) break;
    }
    project(tangentPoint, y, q);
    for (let i = 0; i < 3; ++i) t[i] = translation[i] + y[3 + i];
  }

  private concentrated(q: number[], t: number[]): void {
    const { translation, quaternion } = this.component;
    this.gaussian();
    expPose(this.y, q, t);
    if (this.mixture.side === "left") {
      const moved = [0, 0, 0];
      rotate(q, translation, moved);
      for (let i = 0; i < 3; ++i) t[i] += moved[i];
      multiply(q, quaternion, q);
    } else {
      rotate(quaternion, t, t);
      for (let i = 0; i < 3; ++i) t[i] += translation[i];
      multiply(quaternion, q, q);
    }
  }
}

/** Draws `count` poses under the distribution of the densities. */
export function sampleMixture(mixture: Mixture, count: number, seed = 1): Samples {
  const random = uniform(seed);
  const gauss = normal(random);
  const drawers = mixture.components.map((component) => new Drawer(mixture, component, random, gauss));
  const samples = {
    count,
    positions: new Float64Array(3 * count),
    quaternions: new Float64Array(4 * count),
    components: new Int32Array(count),
  };
  const q = [0, 0, 0, 1];
  const t = [0, 0, 0];
  for (let n = 0; n < count; ++n) {
    const k = pick(mixture, random());
    drawers[k].draw(q, t);
    samples.positions.set(t, 3 * n);
    samples.quaternions.set(q, 4 * n);
    samples.components[n] = k;
  }
  return samples;
}

function pick(mixture: Mixture, share: number): number {
  let sum = 0;
  for (let k = 0; k < mixture.components.length; ++k) {
    sum += mixture.components[k].weight;
    if (share < sum) return k;
  }
  return mixture.components.length - 1;
}
