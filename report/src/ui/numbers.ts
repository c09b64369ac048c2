// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Numbers as the page writes them.

/** With fixed decimals; what rounds to zero has no sign. */
export function fixed(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text;
}

/** With three significant digits and no exponent: 0.0123, 1.23, 123, 1235. */
export function short(value: number): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size < 1e-4) return fixed(value, 0);
  return fixed(value, Math.max(0, Math.min(5, 2 - Math.floor(Math.log10(size)))));
}

/** A share; one that is not quite nothing or all is not written as such. */
export function percent(share: number | undefined, digits = 0): string {
  if (share === undefined || !Number.isFinite(share)) return "–";
  const least = 10 ** -digits;
  if (share > 0 && 100 * share < 0.5 * least) return `<${least} %`;
  if (share < 1 && 100 * share > 100 - 0.5 * least) return `>${fixed(100 - least, digits)} %`;
  return `${fixed(100 * share, digits)} %`;
}

/** A duration or a time since the start. */
export function time(seconds: number): string {
  return `${fixed(seconds, Math.abs(seconds) < 100 ? 2 : 1)} s`;
}

/** One of two words by number. */
export function plural(count: number, one: string, many = `${one}s`): string {
  return `${count} ${count === 1 ? one : many}`;
}

/** How many decimals a column needs: four significant digits of its largest number, three of a usual one, at most four. */
export function decimalsOf(values: readonly number[]): number {
  const sizes = values.map(Math.abs).filter((size) => size > 0 && Number.isFinite(size)).sort((a, b) => a - b);
  if (sizes.length === 0) return 0;
  const order = (size: number) => Math.floor(Math.log10(size));
  const usual = 2 - order(sizes[(sizes.length - 1) >> 1]);
  const largest = 3 - order(sizes[sizes.length - 1]);
  return Math.max(0, Math.min(4, Math.max(usual, largest - 1), largest));
}
