// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the tooltip of the scene says.
import { log, multiply, type Numbers } from "../math/rotation.ts";
import type { CovarianceFrame, Spread } from "./spread.ts";
import { degText, mmText } from "./units.ts";

const NEAR_AXIS = 0.985;

export const FRAME_WORDS: Readonly<Record<CovarianceFrame, string>> = {
  world: "of T_world_object, along the world's axes",
  camera: "of T_camera_object, along the camera's axes",
  object: "of T_world_object, along the object's axes",
};

const three = (values: Numbers, text: (value: number) => string) => Array.from(values.slice(0, 3), text).join(", ");

/** The standard deviations of a pose. */
export function spreadLines(spread: Spread, which: CovarianceFrame): string[] {
  return [
    `sigma ${FRAME_WORDS[which]}:`,
    `position x y z ${three(spread.alongSd, mmText)} mm`,
    `rotation x y z ${three(spread.aboutSd, degText)} deg`,
    `principal axes of the position ${three(spread.lengths, mmText)} mm`,
  ];
}

/** The axis of a rotation vector: the object's own where it is near to one. */
export function axisText(v: Numbers): string {
  const angle = Math.hypot(v[0], v[1], v[2]);
  for (let i = 0; i < 3; ++i) if (Math.abs(v[i]) > NEAR_AXIS * angle) return "xyz"[i];
  return `(${three(v, (part) => (part / angle).toFixed(2))})`;
}

/** How a pose differs from another one: the turn in the object's axes, and the distance. */
export function differenceText(p: Numbers, q: Numbers, otherP: Numbers, otherQ: Numbers): string {
  const inverse = [-q[0], -q[1], -q[2], q[3]];
  const turn = [0, 0, 0, 1];
  multiply(inverse, otherQ, turn);
  const v = [0, 0, 0];
  log(turn, v);
  const angle = Math.hypot(v[0], v[1], v[2]);
  const moved = mmText(Math.hypot(otherP[0] - p[0], otherP[1] - p[1], otherP[2] - p[2]));
  return `${degText(angle)} deg${angle > 1e-3 ? ` about ${axisText(v)}` : ""}, ${moved} mm`;
}
