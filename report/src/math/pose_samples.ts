// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Poses drawn from a concentrated Gaussian, T = Exp(xi) T0, of which standard deviations and the covariance of the position
// are known. The same draws at every frame, so that a cloud moves smoothly over time.
import { normal, uniform } from "../mixture/sample.ts";
import { cholesky } from "./linear.ts";
import { eigen3 } from "./principal_axes.ts";
import { multiply, type Numbers, quaternionOf, rotate } from "./rotation.ts";

const TRIES = 24;
const SHRINK = 0.8;

export class PoseSamples {
  private readonly normals: Float64Array;
  private readonly turnSd = new Float64Array(3);
  private readonly share = new Float64Array(3);
  private readonly rest = new Float64Array(9);
  private readonly root = new Float64Array(9);
  private readonly values = new Float64Array(3);
  private readonly vectors = new Float64Array(9);
  private readonly phi = new Float64Array(3);
  private readonly error = new Float64Array(3);
  private readonly arm = new Float64Array(3);
  private readonly quaternion = new Float64Array(4);

  constructor(readonly count: number, seed = 5) {
    const gauss = normal(uniform(seed));
    this.normals = Float64Array.from({ length: 6 * count }, () => gauss());
  }

  /**
   * The error of the position is e = rho + phi x t. What the variances of rho, phi and e say of how e goes with phi is used:
   * e_i = s_i (phi x t)_i + rest, the regression that has all of these variances; correlations beyond are taken as zero. So
   * s = 1 where rotation is about the frame's origin, and the cloud is an arc about it; s = 0 where e has nothing of it.
   */
  prepare(t: Numbers, covariance: Numbers, rotationSd: Numbers, tangentSd: Numbers): void {
    for (let i = 0; i < 3; ++i) this.turnSd[i] = rotationSd[i];
    for (let i = 0; i < 3; ++i) {
      const [j, k] = [(i + 1) % 3, (i + 2) % 3];
      const lever = (rotationSd[j] * t[k]) ** 2 + (rotationSd[k] * t[j]) ** 2;
      const common = 0.5 * (covariance[4 * i] + lever - tangentSd[i] ** 2);
      this.share[i] = lever > 0 ? Math.max(0, Math.min(1, common / lever)) : 0;
    }
    for (let tries = 0; tries < TRIES; ++tries) {
      if (this.subtract(t, covariance)) break;
      for (let i = 0; i < 3; ++i) this.share[i] *= tries === TRIES - 2 ? 0 : SHRINK;
    }
    cholesky(this.rest, 3, this.root);
  }

  /** The covariance of the rest; false if it is none. */
  private subtract(t: Numbers, covariance: Numbers): boolean {
    const { share, turnSd, rest } = this;
    const [x, y, z] = [turnSd[0] ** 2, turnSd[1] ** 2, turnSd[2] ** 2];
    rest[0] = y * t[2] * t[2] + z * t[1] * t[1];
    rest[4] = x * t[2] * t[2] + z * t[0] * t[0];
    rest[8] = x * t[1] * t[1] + y * t[0] * t[0];
    rest[1] = rest[3] = -z * t[0] * t[1];
    rest[2] = rest[6] = -y * t[0] * t[2];
    rest[5] = rest[7] = -x * t[1] * t[2];
    for (let i = 0; i < 3; ++i) {
      for (let j = 0; j < 3; ++j) rest[3 * i + j] = covariance[3 * i + j] - share[i] * share[j] * rest[3 * i + j];
    }
    eigen3(rest, this.values, this.vectors);
    return this.values[2] >= -1e-9 * Math.abs(this.values[0]);
  }

  /** Draw i, its distance from the mean times `factor`. */
  draw(i: number, t: Numbers, q: Numbers, factor: number, outP: Numbers, outQ: Numbers): void {
    const { normals, phi, error, arm, root, share, turnSd, quaternion } = this;
    for (let k = 0; k < 3; ++k) phi[k] = turnSd[k] * normals[6 * i + k];
    for (let k = 0; k < 3; ++k) arm[k] = phi[(k + 1) % 3] * t[(k + 2) % 3] - phi[(k + 2) % 3] * t[(k + 1) % 3];
    for (let k = 0; k < 3; ++k) {
      error[k] = (share[k] - 1) * arm[k];
      for (let j = 0; j <= k; ++j) error[k] += root[3 * k + j] * normals[6 * i + 3 + j];
    }
    // error is rho; the position is Exp(phi) t + J_l(phi) rho.
    this.leftJacobian(error);
    quaternionOf(phi, quaternion);
    rotate(quaternion, t, arm);
    for (let k = 0; k < 3; ++k) outP[k] = t[k] + factor * (arm[k] + error[k] - t[k]);
    for (let k = 0; k < 3; ++k) phi[k] *= factor;
    quaternionOf(phi, quaternion);
    multiply(quaternion, q, outQ);
  }

  private leftJacobian(v: Float64Array): void {
    const { phi, arm, values } = this;
    const square = phi[0] ** 2 + phi[1] ** 2 + phi[2] ** 2;
    const angle = Math.sqrt(square);
    const a = angle < 1e-3 ? 0.5 - square / 24 : (1 - Math.cos(angle)) / square;
    const b = angle < 1e-3 ? 1 / 6 - square / 120 : (angle - Math.sin(angle)) / (square * angle);
    for (let k = 0; k < 3; ++k) arm[k] = phi[(k + 1) % 3] * v[(k + 2) % 3] - phi[(k + 2) % 3] * v[(k + 1) % 3];
    for (let k = 0; k < 3; ++k) values[k] = phi[(k + 1) % 3] * arm[(k + 2) % 3] - phi[(k + 2) % 3] * arm[(k + 1) % 3];
    for (let k = 0; k < 3; ++k) v[k] += a * arm[k] + b * values[k];
  }
}
