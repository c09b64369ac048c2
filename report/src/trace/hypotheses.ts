// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The hypotheses of an object at a frame, in words relative to the one that leads.
import { percent } from "../ui/numbers.ts";
import { differenceOf, inWords } from "./difference.ts";
import type { HypothesisSlot } from "./trace.ts";

const MOST = 8;
const LEAST = 0.01;

/** "as is 57 %; turned 180 deg about z, 12 mm apart 43 %"; undefined where there are none. */
export function hypothesesInWords(slots: readonly HypothesisSlot[], frame: number): string[] | undefined {
  const living = slots.filter((slot) => slot.pose.has(frame)).sort((a, b) => b.probability(frame) - a.probability(frame));
  if (living.length === 0) return undefined;
  const pose = (slot: HypothesisSlot) => {
    const [p, q] = [[0, 0, 0], [0, 0, 0, 1]];
    slot.pose.position(frame, p);
    slot.pose.quaternion(frame, q);
    return { p, q };
  };
  const leader = pose(living[0]);
  // Joint hypotheses may differ in other objects only: for this one they are the same.
  const weights = new Map<string, number>();
  let shown = 0;
  for (const slot of living.slice(0, MOST)) {
    const weight = slot.probability(frame);
    if (slot !== living[0] && weight < LEAST) continue;
    shown += weight;
    const { p, q } = pose(slot);
    const words = inWords(differenceOf(leader.p, leader.q, p, q));
    weights.set(words, (weights.get(words) ?? 0) + weight);
  }
  const parts = [...weights].map(([words, weight]) => `${words}: ${percent(weight)}`);
  if (1 - shown >= LEAST) parts.push(`others, or none of them: ${percent(1 - shown)}`);
  return parts;
}
