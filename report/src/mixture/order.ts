// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The components of a mixture by weight, and their colours.
import { colourOf } from "../ui/palette.ts";
import type { Mixture } from "./mixture.ts";

/** So many colours are distinct; lighter components share a grey. */
export const MOST_COLOURS = 10;
export const REST_COLOUR = "#78828C";

/** The numbers of the components, the heaviest first. */
export function byWeight({ components }: Mixture): number[] {
  return components.map((_, k) => k).sort((a, b) => components[b].weight - components[a].weight || a - b);
}

/** How much of white, or of black below zero, the tints of an object's colour have. */
const TINTS = [0, -0.4, 0.35, -0.65, 0.55];

/** A colour mixed with white, or below zero with black. */
export function tintOf(colour: string, share: number): string {
  const parts = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
  const end = share > 0 ? 255 : 0;
  return `#${parts.map((part) => Math.round(part + Math.abs(share) * (end - part)).toString(16).padStart(2, "0")).join("")}`.toUpperCase();
}

/** The colour of each component: the heaviest have their own. In a run they are tints of the object's, since the others are those of other objects. */
export function componentColours(mixture: Mixture): string[] {
  const { colour } = mixture;
  const own = colour === undefined ? Array.from({ length: MOST_COLOURS }, (_, rank) => colourOf(rank)) : TINTS.map((share) => tintOf(colour, share));
  const colours = mixture.components.map(() => REST_COLOUR);
  byWeight(mixture).slice(0, own.length).forEach((k, rank) => (colours[k] = own[rank]));
  return colours;
}
