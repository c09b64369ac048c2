// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Where the estimate of an object steps to another place, or turns, by more than its noise.
import { DEGREES, log, multiplyInverse, samePose } from "../math/rotation.ts";
import { type Difference, differenceOf, stepInWords } from "./difference.ts";
import type { RunEvent } from "./events.ts";
import type { ObjectTrack, Trace } from "./trace.ts";

/** A step of a filter that is consistent is hardly ever as many standard deviations of the estimate before it. */
const SIGMAS = 6;
/** Smaller steps are corrections, however sure the filter was [deg, mm]. */
const LEAST_ANGLE = 10;
const LEAST_DISTANCE = 10;
const LEAST_COSINE = Math.cos(LEAST_ANGLE / 2 / DEGREES);

const at = () => ({ p: [0, 0, 0], q: [0, 0, 0, 1] });
const step = [0, 0, 0];
const turn = [0, 0, 0, 1];
const ghost = at();

/** The id of the hypothesis at a pose, -1 if there is none. */
function leadingId({ hypotheses }: ObjectTrack, frame: number, { p, q }: { p: number[]; q: number[] }): number {
  for (const slot of hypotheses) {
    if (!slot.pose.has(frame)) continue;
    slot.pose.position(frame, ghost.p);
    slot.pose.quaternion(frame, ghost.q);
    if (samePose(p, q, ghost.p, ghost.q)) return slot.id(frame);
  }
  return -1;
}

/** How bad a step is: half a turn is as bad as half a metre. */
const sizeOf = ({ angle, distance }: Difference) => angle / 180 + distance / 500;

export function flips(trace: Trace, object: ObjectTrack): Omit<RunEvent, "entity">[] {
  const estimate = object.world;
  if (!estimate) return [];
  const out: Omit<RunEvent, "entity">[] = [];
  let [before, now] = [at(), at()];
  let last = -1;
  const [turnSd, placeSd] = [[0, 0, 0], [0, 0, 0]];
  const isBeyondNoise = () => {
    // Nearly all steps are small, and cheap to see as such.
    const [dx, dy, dz] = [now.p[0] - before.p[0], now.p[1] - before.p[1], now.p[2] - before.p[2]];
    const distance = 1000 * Math.sqrt(dx * dx + dy * dy + dz * dz);
    const dot = now.q[0] * before.q[0] + now.q[1] * before.q[1] + now.q[2] * before.q[2] + now.q[3] * before.q[3];
    if (distance <= LEAST_DISTANCE && Math.abs(dot) >= LEAST_COSINE) return false;
    multiplyInverse(now.q, before.q, turn);
    log(turn, step);
    const wide = (sd: number) => SIGMAS * (sd > 0 ? sd : 0);
    estimate.rotationSd(last, turnSd);
    estimate.positionSdAt(last, placeSd);
    const turned = Math.hypot(step[0], step[1], step[2]) * DEGREES > LEAST_ANGLE && step.some((value, i) => Math.abs(value) > wide(turnSd[i]));
    return turned || (distance > LEAST_DISTANCE && now.p.some((value, i) => Math.abs(value - before.p[i]) > wide(placeSd[i])));
  };
  for (let frame = 0; frame < trace.frames; ++frame) {
    if (!estimate.pose.has(frame)) {
      last = -1;
      continue;
    }
    estimate.pose.position(frame, now.p);
    estimate.pose.quaternion(frame, now.q);
    // An object that moves makes steps of its own; there another hypothesis must lead.
    const isFlip = last >= 0 && isBeyondNoise()
      && (!object.models || leadingId(object, frame, now) !== leadingId(object, last, before));
    if (isFlip) {
      const difference = differenceOf(before.p, before.q, now.p, now.q);
      out.push({ kind: "flipped", from: frame, to: frame, count: 1, peak: frame, size: sizeOf(difference), detail: stepInWords(difference) });
    }
    [before, now] = [now, before];
    last = frame;
  }
  return out;
}
