// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The chi-square distribution with any number of degrees of freedom, also a fractional one.
const SMALL = 1e-15;
const MOST_TERMS = 20000;

const LANCZOS = [
  676.5203681218851, -1259.1392167224028, 771.32342877765313, -176.61502916214059, 12.507343278686905, -0.13857109526572012,
  9.9843695780195716e-6, 1.5056327351493116e-7,
];

/** The logarithm of the gamma function for positive arguments (Lanczos, g = 7). */
export function logGamma(x: number): number {
  if (x < 0.5) return Math.log(Math.PI / Math.sin(Math.PI * x)) - logGamma(1 - x);
  let sum = 0.99999999999980993;
  LANCZOS.forEach((term, i) => (sum += term / (x + i)));
  const t = x + 6.5;
  return 0.5 * Math.log(2 * Math.PI) + (x - 0.5) * Math.log(t) - t + Math.log(sum);
}

function bySeries(a: number, x: number): number {
  let term = 1 / a;
  let sum = term;
  for (let n = 1; n < MOST_TERMS && term > SMALL * sum; ++n) sum += term *= x / (a + n);
  return sum * Math.exp(a * Math.log(x) - x - logGamma(a));
}

/** The upper part, by Lentz' method for the continued fraction. */
function byFraction(a: number, x: number): number {
  let b = x + 1 - a;
  let c = 1e300;
  let d = 1 / b;
  let value = d;
  for (let n = 1; n < MOST_TERMS; ++n) {
    const factor = -n * (n - a);
    b += 2;
    d = 1 / (factor * d + b || 1e-300);
    c = b + factor / c || 1e-300;
    value *= c * d;
    if (Math.abs(c * d - 1) < SMALL) break;
  }
  return value * Math.exp(a * Math.log(x) - x - logGamma(a));
}

/** The regularised lower incomplete gamma function P(a, x). */
export function gammaP(a: number, x: number): number {
  if (!(x > 0)) return 0;
  return x < a + 1 ? bySeries(a, x) : 1 - byFraction(a, x);
}

/** The probability that a chi-square variable is at most x. */
export function chiSquareCdf(x: number, dof: number): number {
  return gammaP(dof / 2, x / 2);
}

/** The value that a chi-square variable does not exceed with a probability: bisection, so that every tail is safe. */
export function chiSquareQuantile(probability: number, dof: number): number {
  if (!(probability > 0)) return 0;
  if (!(probability < 1)) return Infinity;
  let low = 0;
  let high = dof + 10 * Math.sqrt(2 * dof) + 10;
  while (chiSquareCdf(high, dof) < probability) high *= 2;
  for (let i = 0; i < 200 && high - low > 1e-13 * high; ++i) {
    const middle = 0.5 * (low + high);
    if (chiSquareCdf(middle, dof) < probability) low = middle;
    else high = middle;
  }
  return 0.5 * (low + high);
}

/** The share of a Gaussian within so many standard deviations. */
export function shareWithin(sigmas: number): number {
  return chiSquareCdf(sigmas * sigmas, 1);
}
