// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Cones that hold the direction of an axis whose rotation is uncertain.
import { eigen3, turned3 } from "./principal_axes.ts";
import type { Numbers } from "./rotation.ts";

/** A wider cone would look like a plane, and then point backwards. */
export const MOST_HALF_ANGLE = (75 * Math.PI) / 180;

const cross = new Float64Array(9);
const spread = new Float64Array(9);
const values = new Float64Array(3);
const vectors = new Float64Array(9);

/**
 * The linear map that takes a cone with its tip at zero and the unit circle at z = 1 for base to the one around `axis`, a
 * unit vector, whose half angles are `times` standard deviations. A rotation phi moves the axis by phi x axis, so that its
 * covariance there is [a] P [a]^T, which is flat along the axis.
 * @return whether it would be wider than cones are drawn
 */
export function coneMap(axis: Numbers, rotation: Numbers, times: number, length: number, out: Numbers): boolean {
  cross[0] = cross[4] = cross[8] = 0;
  cross[1] = axis[2];
  cross[2] = -axis[1];
  cross[3] = -axis[2];
  cross[5] = axis[0];
  cross[6] = axis[1];
  cross[7] = -axis[0];
  turned3(cross, rotation, spread);
  // The axis is last, whatever rounding does to the other two.
  for (let i = 0; i < 3; ++i) for (let j = 0; j < 3; ++j) spread[3 * i + j] -= axis[i] * axis[j];
  eigen3(spread, values, vectors);
  let isCapped = false;
  for (let k = 0; k < 3; ++k) {
    const wanted = times * Math.sqrt(Math.max(0, values[k]));
    const angle = Math.min(MOST_HALF_ANGLE, wanted);
    if (k < 2 && wanted > MOST_HALF_ANGLE) isCapped = true;
    const size = length * (k < 2 ? Math.tan(angle) : 1);
    for (let i = 0; i < 3; ++i) out[3 * i + k] = k < 2 ? size * vectors[3 * i + k] : length * axis[i];
  }
  return isCapped;
}
