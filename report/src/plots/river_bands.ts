// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The bands of a river in the pixels of a plot.
import type { Field } from "./pen.ts";
import type { River } from "./river.ts";
import { placeOf } from "./ticks.ts";

/** The upper and the lower edge of a hypothesis while it lives. */
export interface Part {
  lane: number;
  upper: number[];
  lower: number[];
}

/** The frames in a column of pixels: at least the one that is shown there. */
function framesOf(seconds: Float64Array, from: number, to: number): [number, number] {
  const first = placeOf(seconds, from);
  return [first, Math.max(first, placeOf(seconds, to))];
}

/** Adds the weights of the lanes over some frames, as their mean; returns the lanes from below. */
function weightsOver(river: River, first: number, last: number, sums: Map<number, number>): [number, number][] {
  sums.clear();
  river.laneOf.forEach((list, k) => {
    for (let frame = first; frame <= last; ++frame) {
      const lane = list[frame];
      if (lane >= 0) sums.set(lane, (sums.get(lane) ?? 0) + river.slots[k].probability(frame) / (last - first + 1));
    }
  });
  return [...sums].sort((a, b) => a[0] - b[0]);
}

/** The bands of all lanes, column by column. */
export function bandsOf(river: River, seconds: Float64Array, field: Field): Part[] {
  const parts: Part[] = [];
  const open = new Map<number, { part: Part; column: number }>();
  const sums = new Map<number, number>();
  const [low, high] = [Math.max(field.range[0], seconds[0]), Math.min(field.range[1], seconds[seconds.length - 1])];
  const [start, end] = [field.x(low), field.x(high)];
  const columns = Math.max(1, Math.min(Math.round((end - start) / field.pixel), 4000));
  for (let column = 0; column <= columns; ++column) {
    const at = (share: number) => low + ((high - low) * Math.max(0, Math.min(columns, share))) / columns;
    const [first, last] = framesOf(seconds, at(column - 0.5), at(column + 0.5));
    const x = start + ((end - start) * column) / columns;
    let below = 0;
    for (const [lane, weight] of weightsOver(river, first, last, sums)) {
      const before = open.get(lane);
      const part = before && before.column === column - 1 ? before.part : { lane, upper: [], lower: [] };
      if (part.upper.length === 0) parts.push(part);
      open.set(lane, { part, column });
      part.lower.push(x, field.y(below));
      below += weight;
      part.upper.push(x, field.y(below));
    }
  }
  return parts;
}
