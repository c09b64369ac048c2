// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Births and ends of the hypotheses of an object.
import { type Difference, differenceOf, inWords } from "./difference.ts";
import type { RunEvent } from "./events.ts";
import type { HypothesisSlot, ObjectTrack, Trace } from "./trace.ts";

/** A hypothesis that never was as probable is not worth an event. */
const LEAST_TOP = 0.05;
/** Two hypotheses that end as one agreed about as well [deg, mm]. */
const SAME_ANGLE = 10;
const SAME_DISTANCE = 10;
/** A lighter hypothesis is dropped for its weight, even where another is near. */
const LEAST_MERGED = 0.01;

interface Life {
  first: { frame: number; slot: HypothesisSlot };
  last: { frame: number; slot: HypothesisSlot };
  top: number;
}

/** The lives by id; one that was out of the list for a while goes on. */
function livesOf(frames: number, hypotheses: readonly HypothesisSlot[]): Life[] {
  const lives = new Map<number, Life>();
  for (const slot of hypotheses) {
    let from = -1;
    let top = 0;
    const end = (to: number) => {
      const id = slot.id(from);
      const life = lives.get(id) ?? { first: { frame: from, slot }, last: { frame: to, slot }, top };
      lives.set(id, life);
      if (from < life.first.frame) life.first = { frame: from, slot };
      if (to > life.last.frame) life.last = { frame: to, slot };
      life.top = Math.max(life.top, top);
      from = -1;
    };
    for (let frame = 0; frame < frames; ++frame) {
      const has = slot.pose.has(frame);
      if (from >= 0 && (!has || slot.id(frame) !== slot.id(from))) end(frame - 1);
      if (!has) continue;
      const weight = slot.probability(frame);
      top = from < 0 ? weight : Math.max(top, weight);
      if (from < 0) from = frame;
    }
    if (from >= 0) end(frames - 1);
  }
  return [...lives.values()];
}

const poseOf = (slot: HypothesisSlot, frame: number) => {
  const [p, q] = [[0, 0, 0], [0, 0, 0, 1]];
  slot.pose.position(frame, p);
  slot.pose.quaternion(frame, q);
  return { p, q };
};

/** The difference from a hypothesis at one frame to the nearest at another. */
function toNearest(hypotheses: readonly HypothesisSlot[], slot: HypothesisSlot, frame: number, other: number): Difference | undefined {
  const own = poseOf(slot, frame);
  const size = ({ angle, distance }: Difference) => Math.max(angle / SAME_ANGLE, distance / SAME_DISTANCE);
  let nearest: Difference | undefined;
  for (const one of hypotheses) {
    if (!one.pose.has(other) || (one === slot && other === frame)) continue;
    const { p, q } = poseOf(one, other);
    const difference = differenceOf(p, q, own.p, own.q);
    if (!nearest || size(difference) < size(nearest)) nearest = difference;
  }
  return nearest;
}

/** Born, merged and pruned hypotheses; ids must be kept over time, so joint hypotheses have no such events. */
export function hypothesisEvents(trace: Trace, { hypotheses }: ObjectTrack): Omit<RunEvent, "entity">[] {
  if (trace.cameraHypotheses.length > 0) return [];
  const lives = livesOf(trace.frames, hypotheses);
  const start = Math.min(...lives.map(({ first }) => first.frame));
  const end = Math.max(...lives.map(({ last }) => last.frame));
  const out: Omit<RunEvent, "entity">[] = [];
  const add = (kind: "born" | "merged" | "pruned", frame: number, size: number, detail?: string) =>
    out.push({ kind, from: frame, to: frame, count: 1, peak: frame, size, ...(detail === undefined ? {} : { detail }) });
  for (const { first, last, top } of lives) {
    if (top < LEAST_TOP) continue;
    if (first.frame > start) {
      const difference = toNearest(hypotheses, first.slot, first.frame, first.frame);
      add("born", first.frame, top, difference ? `${inWords(difference)} from the nearest` : "the only one");
    }
    if (last.frame >= end) continue;
    const nearest = toNearest(hypotheses, last.slot, last.frame, last.frame + 1);
    const isNear = nearest !== undefined && nearest.angle < SAME_ANGLE && nearest.distance < SAME_DISTANCE;
    add(isNear && last.slot.probability(last.frame) >= LEAST_MERGED ? "merged" : "pruned", last.frame + 1, top);
  }
  return out;
}
