// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The hypotheses of one object over time: when each begins and ends, and what they are at a frame.
import { DEGREES, log, multiply, multiplyInverse, rotate } from "../math/rotation.ts";
import { REACH_DEG, REACH_M } from "../trace/right_mode.ts";
import type { HypothesisSlot, ObjectTrack, Trace } from "../trace/trace.ts";

export interface Lane {
  /** As in trace.json. */
  id: number;
  /** The first and the last frame in which it lives. */
  first: number;
  last: number;
  /** Its largest weight. */
  peak: number;
  end: "alive" | "merged" | "dropped";
  /** The lane that it merged into. */
  into: number | undefined;
}

export interface River {
  /** In the order of their births: the order in which they are stacked. */
  lanes: Lane[];
  /** By slot and frame the lane in it; -1 where there is none. */
  laneOf: Int32Array[];
  slots: readonly HypothesisSlot[];
  frames: number;
  /** Whether ids are kept over time; those of joint hypotheses are ranks. */
  kept: boolean;
}

/** How far two poses are apart: the angle [rad] and the distance [m]. */
class Gap {
  private readonly p = [[0, 0, 0], [0, 0, 0]];
  private readonly q = [[0, 0, 0, 1], [0, 0, 0, 1]];
  readonly turn = [0, 0, 0];
  distance = 0;

  get angle(): number {
    return Math.hypot(this.turn[0], this.turn[1], this.turn[2]);
  }

  /** From one slot to another, the rotation vector in the frame of the first. */
  between(from: HypothesisSlot, to: HypothesisSlot, frame: number): void {
    [from, to].forEach((slot, k) => {
      slot.pose.position(frame, this.p[k]);
      slot.pose.quaternion(frame, this.q[k]);
    });
    const [a, b] = this.q;
    multiply([-a[0], -a[1], -a[2], a[3]], b, a);
    log(a, this.turn);
    this.distance = Math.hypot(this.p[1][0] - this.p[0][0], this.p[1][1] - this.p[0][1], this.p[1][2] - this.p[0][2]);
  }
}

const isNear = (gap: Gap) => gap.angle * DEGREES < REACH_DEG && gap.distance < REACH_M;

/** A lane that ends before the run does: merged where another of the same mode lives on, else dropped. */
function endOf(river: River, lane: number): void {
  const { slots, laneOf, lanes, frames } = river;
  const own = lanes[lane];
  const frame = own.last;
  if (frame >= frames - 1) return;
  own.end = "dropped";
  const slot = slots[laneOf.findIndex((list) => list[frame] === lane)];
  const gap = new Gap();
  let least = Infinity;
  slots.forEach((other, k) => {
    const next = laneOf[k][frame];
    if (next < 0 || next === lane || lanes[next].last <= frame) return;
    gap.between(slot, other, frame);
    if (!isNear(gap) || gap.distance / REACH_M + (gap.angle * DEGREES) / REACH_DEG >= least) return;
    least = gap.distance / REACH_M + (gap.angle * DEGREES) / REACH_DEG;
    own.end = "merged";
    own.into = next;
  });
}

export function riverOf(slots: readonly HypothesisSlot[], frames: number, kept: boolean): River {
  const lanes: Lane[] = [];
  const laneOf = slots.map(() => new Int32Array(frames).fill(-1));
  const byId = new Map<number, number>();
  for (let frame = 0; frame < frames; ++frame) {
    for (let k = 0; k < slots.length; ++k) {
      if (!slots[k].pose.has(frame)) continue;
      const id = slots[k].id(frame);
      const weight = slots[k].probability(frame);
      let lane = byId.get(id);
      if (lane === undefined) {
        lane = lanes.length;
        byId.set(id, lane);
        lanes.push({ id, first: frame, last: frame, peak: 0, end: "alive", into: undefined });
      }
      laneOf[k][frame] = lane;
      lanes[lane].last = frame;
      if (weight > lanes[lane].peak) lanes[lane].peak = weight;
    }
  }
  const river = { lanes, laneOf, slots, frames, kept };
  lanes.forEach((_, lane) => endOf(river, lane));
  return river;
}

/** The weight of a lane at a frame; 0 where it does not live. */
export function weightAt(river: River, lane: number, frame: number): number {
  const slot = river.laneOf.findIndex((list) => list[frame] === lane);
  return slot < 0 ? 0 : river.slots[slot].probability(frame);
}

/** The lane at a height of the stack, from 0 to 1; undefined above it. */
export function laneAt(river: River, frame: number, height: number): number | undefined {
  const living = river.laneOf.map((list, k) => ({ lane: list[frame], weight: list[frame] < 0 ? 0 : river.slots[k].probability(frame) }));
  let below = 0;
  for (const { lane, weight } of living.filter((one) => one.lane >= 0).sort((a, b) => a.lane - b.lane)) {
    below += weight;
    if (height < below) return height < 0 ? undefined : lane;
  }
  return undefined;
}

export interface Living {
  lane: number;
  id: number;
  weight: number;
  /** Of the turn from the leading hypothesis, in the object's frame; 0 0 0 for the leading one. */
  turn: [number, number, number];
  angleDeg: number;
  distanceMm: number;
}

/** What lives at a frame, the heaviest first. */
export function livingAt(river: River, frame: number): Living[] {
  const found: { slot: HypothesisSlot; living: Living }[] = [];
  river.slots.forEach((slot, k) => {
    const lane = river.laneOf[k][frame];
    if (lane < 0) return;
    found.push({ slot, living: { lane, id: river.lanes[lane].id, weight: slot.probability(frame), turn: [0, 0, 0], angleDeg: 0, distanceMm: 0 } });
  });
  found.sort((a, b) => b.living.weight - a.living.weight);
  const gap = new Gap();
  for (const { slot, living } of found.slice(1)) {
    gap.between(found[0].slot, slot, frame);
    living.turn = [gap.turn[0], gap.turn[1], gap.turn[2]];
    living.angleDeg = gap.angle * DEGREES;
    living.distanceMm = 1000 * gap.distance;
  }
  return found.map(({ living }) => living);
}

/** By frame the lane of the nearest hypothesis that a detection is within reach of; -1 where there is none. */
export function supportOf(river: River, trace: Trace, object: ObjectTrack): Int32Array {
  const support = new Int32Array(river.frames).fill(-1);
  const { detection } = object;
  const camera = trace.camera?.pose;
  if (!detection || !camera) return support;
  const [p, c, t] = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const [q, r, e] = [[0, 0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 1]];
  const turn = [0, 0, 0];
  for (let frame = 0; frame < river.frames; ++frame) {
    if (!detection.has(frame) || !camera.has(frame)) continue;
    detection.position(frame, p);
    detection.quaternion(frame, q);
    camera.position(frame, c);
    camera.quaternion(frame, r);
    rotate(r, p, p);
    multiply(r, q, q);
    let least = Infinity;
    river.slots.forEach((slot, k) => {
      if (river.laneOf[k][frame] < 0) return;
      slot.pose.position(frame, t);
      slot.pose.quaternion(frame, e);
      multiplyInverse(q, e, e);
      log(e, turn);
      const angle = (Math.hypot(turn[0], turn[1], turn[2]) * DEGREES) / REACH_DEG;
      const distance = Math.hypot(p[0] + c[0] - t[0], p[1] + c[1] - t[1], p[2] + c[2] - t[2]) / REACH_M;
      if (angle < 1 && distance < 1 && angle + distance < least) [least, support[frame]] = [angle + distance, river.laneOf[k][frame]];
    });
  }
  return support;
}

const NAMES = ["x", "y", "z"];
/** Within ten degrees of an axis its name says enough. */
const ALONG = Math.cos(10 / DEGREES);

/** "z", "-z" or a unit vector; "" where there is no turn. */
export function axisName(turn: readonly number[]): string {
  const size = Math.hypot(...turn);
  if (size * DEGREES < 0.05) return "";
  const unit = turn.map((value) => value / size);
  // Half a turn about an axis is half a turn about its opposite.
  const isHalf = size * DEGREES > 179;
  const main = unit.findIndex((value) => Math.abs(value) > ALONG);
  if (main >= 0) return unit[main] < 0 && !isHalf ? `-${NAMES[main]}` : NAMES[main];
  return `(${unit.map((value) => value.toFixed(2)).join(", ")})`;
}
