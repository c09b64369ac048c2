// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Colours of the hypotheses of one object: near the colour of the object, so that none looks like another object's.
import { colourOf } from "../ui/palette.ts";

const HUES = [0, 18, -18];
const LIGHTER = [0, 0.22, -0.14, 0.11, -0.07];

function hslOf(hex: string): [number, number, number] {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
  const [high, low] = [Math.max(r, g, b), Math.min(r, g, b)];
  const chroma = high - low;
  const light = 0.5 * (high + low);
  if (chroma === 0) return [0, 0, light];
  const sixth = high === r ? ((g - b) / chroma + 6) % 6 : high === g ? (b - r) / chroma + 2 : (r - g) / chroma + 4;
  return [60 * sixth, chroma / (1 - Math.abs(2 * light - 1)), light];
}

function hexOf(hue: number, saturation: number, light: number): string {
  const part = (n: number) => {
    const k = (n + hue / 30) % 12;
    const value = light - saturation * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
    return Math.round(255 * value).toString(16).padStart(2, "0");
  };
  return `#${part(0)}${part(8)}${part(4)}`;
}

/** The colour of a hypothesis by the order of its birth; that of the first is the object's own. */
export function hypothesisColour(object: number, lane: number): string {
  const [hue, saturation, light] = hslOf(colourOf(object));
  const shifted = (hue + HUES[lane % HUES.length] + 360) % 360;
  return hexOf(shifted, saturation, Math.max(0.25, Math.min(0.78, light + LIGHTER[lane % LIGHTER.length])));
}
