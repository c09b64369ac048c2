// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The uncertainty of a pose at a frame, in the frame that the reader chose, with all vectors along the axes of the world.
import { eigen3, sdAlong, turned3 } from "../math/principal_axes.ts";
import { matrixOf, type Numbers } from "../math/rotation.ts";
import type { Estimate } from "../trace/trace.ts";

/** Of T_world_object along the world's axes, of T_camera_object along the camera's, or of T_world_object along the object's. */
export type CovarianceFrame = "world" | "camera" | "object";

export class Spread {
  /** Covariance of the position [m^2] and of the rotation [rad^2]. */
  readonly position = new Float64Array(9);
  readonly rotation = new Float64Array(9);
  /** Standard deviations along the principal axes of the position [m], the largest first, and these as columns. */
  readonly lengths = new Float64Array(3);
  readonly directions = new Float64Array(9);
  /** The axes, as columns, and the standard deviations along them and about them [m, rad]. */
  readonly axes = new Float64Array(9);
  readonly alongSd = new Float64Array(3);
  readonly aboutSd = new Float64Array(3);
  private readonly turn = new Float64Array(9);

  /** @param reference, own the rotations of the frame of the covariance and of the object, in the world */
  read(estimate: Estimate, frame: number, which: CovarianceFrame, reference: Numbers, own: Numbers): boolean {
    if (!estimate.hasCovariance || !estimate.pose.has(frame)) return false;
    estimate.covariance(frame, this.position);
    estimate.rotationSd(frame, this.lengths);
    for (let i = 0; i < 9; ++i) this.rotation[i] = i % 4 === 0 && estimate.hasSd ? this.lengths[i / 4] ** 2 : 0;
    matrixOf(reference, this.turn);
    turned3(this.turn, this.position, this.position);
    turned3(this.turn, this.rotation, this.rotation);
    matrixOf(which === "object" ? own : reference, this.axes);
    for (let k = 0; k < 3; ++k) {
      this.alongSd[k] = sdAlong(this.position, this.axes, k);
      this.aboutSd[k] = sdAlong(this.rotation, this.axes, k);
    }
    eigen3(this.position, this.lengths, this.directions);
    for (let k = 0; k < 3; ++k) this.lengths[k] = Math.sqrt(Math.max(0, this.lengths[k]));
    return true;
  }
}
