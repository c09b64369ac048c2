// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Round numbers for axes, and places along them.

/** Multiples of 1, 2 or 5 times a power of ten within a range, at most so many. */
export function ticks(low: number, high: number, most: number): number[] {
  const width = high - low;
  if (!(width > 0) || most < 1) return [];
  const rough = width / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= rough * (1 - 1e-9)) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  const found: number[] = [];
  for (let k = first; k * step <= high + 1e-9 * step; ++k) found.push(Number((k * step).toPrecision(12)));
  return found;
}

/** Powers of ten within a range, every so many that there are not too many. */
export function logTicks(low: number, high: number, most: number): number[] {
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  if (last <= first) return ticks(low, high, most);
  const step = Math.max(1, Math.ceil((last - first + 1) / most));
  const found: number[] = [];
  for (let k = first; k <= last; k += step) found.push(10 ** k);
  return found;
}

/** A number on an axis or beside a plot. */
export function short(value: number, digits = 4): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(1);
  return String(Number(value.toPrecision(digits)));
}

/** The place of the last x that is not above a value. */
export function placeOf(x: ArrayLike<number>, value: number): number {
  let [low, high] = [0, x.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (x[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}
