// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Marks that are drawn point by point: dots, and carets at the edge for what is beyond it.
import type { Field, Pen } from "./pen.ts";
import type { ChartSeries } from "./chart.ts";

const DOT = 2.4;
const CARET = 7;

/** Small squares; only one is painted per place, so that many thousand are cheap. */
export function paintDots(pen: Pen, field: Field, xs: ArrayLike<number>, series: ChartSeries, colour: string): void {
  const size = Math.max(1, (series.size ?? DOT) * field.pixel);
  const grid = field.pixel >= 1 ? 1 : field.pixel;
  const taken = new Set<number>();
  const [right, bottom] = [field.left + field.width, field.top + field.height];
  for (let i = 0; i < xs.length; ++i) {
    const value = series.values[i];
    if (value === null || value === undefined || xs[i] < field.range[0] || xs[i] > field.range[1]) continue;
    const x = Math.round(field.x(xs[i]) / grid);
    const y = Math.round(field.y(value) / grid);
    if (x * grid < field.left || x * grid > right || y * grid < field.top || y * grid > bottom) continue;
    const place = x * 65536 + y;
    if (taken.has(place)) continue;
    taken.add(place);
    pen.rect(x * grid - size / 2, y * grid - size / 2, size, size, colour);
  }
}

export interface Beyond {
  above: number;
  below: number;
}

/** How many values of the shown part lie beyond a range. */
export function countBeyond(xs: ArrayLike<number>, values: ArrayLike<number | null | undefined>, range: [number, number], [low, high]: [number, number]): Beyond {
  const found = { above: 0, below: 0 };
  for (let i = 0; i < xs.length; ++i) {
    const value = values[i];
    if (value === null || value === undefined || xs[i] < range[0] || xs[i] > range[1]) continue;
    if (value > high) ++found.above;
    else if (value < low) ++found.below;
  }
  return found;
}

/** Carets at the edges where values lie beyond them; those that would overlap are one. */
export function paintCarets(pen: Pen, field: Field, xs: ArrayLike<number>, values: ChartSeries["values"], [low, high]: [number, number], colour: string): void {
  const size = CARET * field.pixel;
  const last = [-Infinity, -Infinity];
  for (let i = 0; i < xs.length; ++i) {
    const value = values[i];
    if (value === null || value === undefined || (value <= high && value >= low)) continue;
    if (xs[i] < field.range[0] || xs[i] > field.range[1]) continue;
    const [edge, way, side] = value > high ? [field.top, 1, 0] : [field.top + field.height, -1, 1];
    const x = field.x(xs[i]);
    if (x - last[side] < size) continue;
    last[side] = x;
    pen.shape([x, edge, x - size / 2, edge + way * size, x + size / 2, edge + way * size], colour);
  }
}

/** "5 frames beyond", or "" if there are none. */
export function beyondText(label: string, { above, below }: Beyond): string {
  const count = above + below;
  return count === 0 ? "" : `${label}: ${count} ${count === 1 ? "frame" : "frames"} beyond`;
}
