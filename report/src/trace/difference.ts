// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How far one pose is from another, in words.
import { DEGREES, log, multiply, type Numbers } from "../math/rotation.ts";
import { fixed, short } from "../ui/numbers.ts";

export interface Difference {
  /** The axis in the frame of the first body, and the angle about it [deg]. */
  axis: number[];
  angle: number;
  /** Between the positions [mm]. */
  distance: number;
}

/** Smaller differences are not worth words. */
const LEAST_ANGLE = 1;
const LEAST_DISTANCE = 1;
/** An axis within this cosine of x, y or z is called by that name. */
const ALONG = Math.cos(15 / DEGREES);

const inverse = [0, 0, 0, 1];
const turn = [0, 0, 0, 1];
const vector = [0, 0, 0];

export function differenceOf(p: Numbers, q: Numbers, otherP: Numbers, otherQ: Numbers): Difference {
  for (let i = 0; i < 3; ++i) inverse[i] = -q[i];
  inverse[3] = q[3];
  multiply(inverse, otherQ, turn);
  log(turn, vector);
  const angle = Math.hypot(vector[0], vector[1], vector[2]);
  return {
    axis: vector.map((value) => (angle > 0 ? value / angle : 0)),
    angle: angle * DEGREES,
    distance: 1000 * Math.hypot(otherP[0] - p[0], otherP[1] - p[1], otherP[2] - p[2]),
  };
}

function turned({ axis, angle }: Difference): string {
  const along = axis.findIndex((value) => Math.abs(value) > ALONG);
  // Half a turn is the same in both directions.
  const sign = along >= 0 && axis[along] < 0 && angle < 175 ? -1 : 1;
  const name = along >= 0 ? "xyz"[along] : `(${axis.map((value) => fixed(value, 2)).join(", ")})`;
  return `turned ${fixed(sign * angle, angle < 10 ? 1 : 0)} deg about ${name}`;
}

/** "turned 180 deg about z, 12 mm apart"; "as is" where there is nothing to tell. */
export function inWords(difference: Difference): string {
  const parts: string[] = [];
  if (difference.angle >= LEAST_ANGLE) parts.push(turned(difference));
  if (difference.distance >= LEAST_DISTANCE) parts.push(`${short(difference.distance)} mm apart`);
  return parts.length > 0 ? parts.join(", ") : "as is";
}

/** The same of a step from one frame to the next. */
export function stepInWords(difference: Difference): string {
  const parts: string[] = [];
  if (difference.angle >= LEAST_ANGLE) parts.push(turned(difference));
  if (difference.distance >= LEAST_DISTANCE) parts.push(`moved ${short(difference.distance)} mm`);
  return parts.join(", ");
}
