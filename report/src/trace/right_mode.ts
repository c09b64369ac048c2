// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Whether an estimate is on the right mode.
import { angleBetween, DEGREES } from "../math/rotation.ts";
import type { Estimate } from "./trace.ts";

/** Two poses nearer than this are the same mode, as in right_mode_share of metrics.json. */
export const REACH_DEG = 20;
export const REACH_M = 0.1;

/** Whether an estimate is on the right mode, within 20 deg and 10 cm of the truth; undefined where there is none of either. */
export function rightAt({ pose, truth }: Estimate): (frame: number) => boolean | undefined {
  const [p, t] = [[0, 0, 0], [0, 0, 0]];
  const [q, r] = [[0, 0, 0, 1], [0, 0, 0, 1]];
  return (frame) => {
    if (!truth || !pose.has(frame) || !truth.has(frame)) return undefined;
    pose.position(frame, p);
    truth.position(frame, t);
    pose.quaternion(frame, q);
    truth.quaternion(frame, r);
    return angleBetween(q, r) * DEGREES <= REACH_DEG && Math.hypot(p[0] - t[0], p[1] - t[1], p[2] - t[2]) <= REACH_M;
  };
}
