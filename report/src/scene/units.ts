// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Lengths and angles as the scene writes them.

/** A length of a scale or grid: a round number with the unit that suits it. */
export function lengthText(metres: number): string {
  const text = (value: number, unit: string) => `${Number(value.toPrecision(2))} ${unit}`;
  if (metres >= 1) return text(metres, "m");
  return metres >= 0.01 ? text(100 * metres, "cm") : text(1000 * metres, "mm");
}

function digits(value: number): string {
  const size = Math.abs(value);
  return value.toFixed(size < 1 ? 2 : size < 10 ? 1 : 0);
}

/** Errors and standard deviations are in mm and deg everywhere. */
export function mmText(metres: number): string {
  return digits(1000 * metres);
}

export function degText(radians: number): string {
  return digits((radians * 180) / Math.PI);
}

/** A length of 1, 2 or 5 times a power of ten, at most a given one. */
export function roundLength(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  const share = most / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}
