// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Colours that people with any colour vision tell apart (Okabe and Ito; the last four after Tol).

const COLOURS = [
  "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#882255", "#44AA99", "#999933", "#AA4499",
] as const;

/** The colour of the object, component or series of a number. */
export function colourOf(index: number): string {
  return COLOURS[index % COLOURS.length];
}

export const AXIS_COLOURS = ["#D55E00", "#009E73", "#0072B2"] as const;
export const TRUTH_COLOUR = "#8A8A8A";

/** How the status of a detection is drawn: colour, and the share of its row's height, so that colour is not all. */
export const STATUS_MARKS: Readonly<Record<string, { colour: string; height: number; text: string }>> = {
  none: { colour: "", height: 0, text: "no detection" },
  started: { colour: "#009E73", height: 1, text: "the object entered" },
  used: { colour: "#56B4E9", height: 0.35, text: "used" },
  doubted: { colour: "#E69F00", height: 0.6, text: "used, but more likely a gross error" },
  birth: { colour: "#CC79A7", height: 0.8, text: "explained by no hypothesis, began one" },
  gated: { colour: "#D55E00", height: 0.7, text: "gated" },
  failed: { colour: "#882255", height: 0.9, text: "failed numerically" },
};

/** With an opacity from 0 to 1. */
export function faded(colour: string, opacity: number): string {
  return colour + Math.round(255 * opacity).toString(16).padStart(2, "0");
}
