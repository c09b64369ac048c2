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

/** The colour of each component: the heaviest have their own. */
export function componentColours(mixture: Mixture): string[] {
  const colours = mixture.components.map(() => REST_COLOUR);
  byWeight(mixture).slice(0, MOST_COLOURS).forEach((k, rank) => (colours[k] = colourOf(rank)));
  return colours;
}
