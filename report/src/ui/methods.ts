// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The colours of methods: the same in all charts, and in the figures of studies. src/draw/method_colours.hpp has the same table,
// which a test compares.

import { colourOf, TRUTH_COLOUR } from "./palette.ts";

/** The number of a method's colour among those of objects; -1: what methods are compared with. */
const METHODS: Readonly<Record<string, { colour: number; dashed: boolean }>> = {
  "detector": { colour: -1, dashed: false },
  "odometry": { colour: -1, dashed: false },
  "published: ACT": { colour: -1, dashed: true },
  "default": { colour: 2, dashed: false },
  "multi-object": { colour: 2, dashed: false },
  "default_smoothed": { colour: 2, dashed: true },
  "multi-object, smoothed": { colour: 2, dashed: true },
  "riekf": { colour: 0, dashed: false },
  "iterated_riekf": { colour: 0, dashed: true },
  "midway": { colour: 1, dashed: false },
  "gm-iekf": { colour: 1, dashed: false },
  "midway_iterated": { colour: 4, dashed: false },
  "iterated": { colour: 4, dashed: false },
  "tangent_of_larger": { colour: 5, dashed: false },
  "iterated_tangent_of_larger": { colour: 5, dashed: true },
  "tangent_of_larger_anchor_1": { colour: 5, dashed: false },
  "tangent_of_larger_anchor_2": { colour: 5, dashed: true },
  "riekf_cauchy": { colour: 3, dashed: false },
  "moment_matched": { colour: 3, dashed: false },
  "riekf_gated": { colour: 7, dashed: false },
  "no_merge_64": { colour: 7, dashed: false },
  "max_mixture": { colour: 8, dashed: false },
  "largest_with_smallest": { colour: 8, dashed: false },
  "rbpf": { colour: 6, dashed: false },
  "runnalls_pairs": { colour: 6, dashed: false },
  "published": { colour: 9, dashed: false },
};

/** The colour and dash of a method, also of one with its settings, as "gm-iekf (midway)"; undefined for one that is not known. */
export function methodLook(method: string): { colour: string; dashed: boolean } | undefined {
  const name = Object.hasOwn(METHODS, method) ? method : method.split(" (")[0];
  if (!Object.hasOwn(METHODS, name)) return undefined;
  const { colour, dashed } = METHODS[name];
  return { colour: colour < 0 ? TRUTH_COLOUR : colourOf(colour), dashed };
}

/** The colour of a method; of one that is not known that of its number. */
export function methodColour(method: string, index: number): string {
  return methodLook(method)?.colour ?? colourOf(index);
}
