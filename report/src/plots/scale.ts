// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Scales and round numbers for drawings.
import { ticks } from "./ticks.ts";

export interface Scale {
  low: number;
  high: number;
  log: boolean;
  ticks: number[];
  /** Where a value stands, from 0 at the low end to 1. */
  at: (value: number) => number;
}

/** Within few decades also parts of them, so that a narrow range has ticks too. */
function logTicks(low: number, high: number, most: number): number[] {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const parts = last - first <= 1 ? [1, 2, 3, 5] : last - first <= 3 ? [1, 3] : [1];
  const step = Math.max(1, Math.ceil((last - first) / most));
  const found: number[] = [];
  for (let power = first; power <= last; power += step) for (const part of parts) found.push(part * 10 ** power);
  return found.filter((tick) => tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9));
}

/** A scale over all values. Zero is in it where that costs less than half of the room; logarithmic only if all are positive. */
export function scaleOf(values: Iterable<number>, { log = false, most = 6, tight = false } = {}): Scale {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) [low, high] = [0, 1];
  const isLog = log && low > 0;
  if (isLog) {
    [low, high] = tight ? [low, high] : [low / 1.15, high * 1.15];
    if (low === high) [low, high] = [low / 2, 2 * high];
    const size = Math.log(high / low);
    return { low, high, log: true, ticks: logTicks(low, high, most), at: (value) => Math.log(Math.max(value, 1e-300) / low) / size };
  }
  if (!tight) {
    if (low > 0 && low < 0.5 * high) low = 0;
    if (high < 0 && high > 0.5 * low) high = 0;
    const margin = 0.06 * (high - low);
    [low, high] = [low === 0 ? 0 : low - margin, high === 0 ? 0 : high + margin];
  }
  if (low === high) [low, high] = low === 0 ? [0, 1] : [low - 0.5 * Math.abs(low), high + 0.5 * Math.abs(high)];
  return { low, high, log: false, ticks: ticks(low, high, most), at: (value) => (value - low) / (high - low) };
}

/** A tick's number: without digits that only rounding made. */
export function tickText(value: number): string {
  const size = Math.abs(value);
  if (value !== 0 && (size < 1e-3 || size >= 1e5)) return value.toExponential(1).replace(".0e", "e").replace("e+", "e");
  return String(Number(value.toPrecision(6)));
}
