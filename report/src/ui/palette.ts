// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The colours of objects, which readers with any colour vision can distinguish, and which have a contrast of three on white
// and on the dark page. None is like an axis or the ground truth. src/draw has the same, in the same order.

const COLOURS = [
  "#AA9117", "#B12CBE", "#296E79", "#DC68B5", "#4B9BCF", "#856224", "#9079FE", "#A27558", "#9249EB", "#CD3BA2",
] as const;

/** The colour of an object, component or series by its number. */
export function colourOf(index: number): string {
  return COLOURS[index % COLOURS.length];
}

/** x, y and z, and nothing else. */
export const AXIS_COLOURS = ["#D8232A", "#1E8E3E", "#2F62DC"] as const;
export const TRUTH_COLOUR = "#8A8A8A";

/** The mark of a status: a colour, and a share of the row's height, so that the colour is not the only difference. */
export const STATUS_MARKS: Readonly<Record<string, { colour: string; height: number; text: string }>> = {
  none: { colour: "", height: 0, text: "no detection" },
  started: { colour: "#009E73", height: 1, text: "the object entered" },
  used: { colour: "#56B4E9", height: 0.35, text: "used in the update" },
  doubted: { colour: "#E69F00", height: 0.6, text: "used, but probably a gross error" },
  birth: { colour: "#CC79A7", height: 0.8, text: "not explained by any hypothesis: began a new one" },
  gated: { colour: "#D55E00", height: 0.7, text: "outside the gate, not used" },
  failed: { colour: "#882255", height: 0.9, text: "numerical failure, not used" },
};

/** The mark of the health of a track, as of a status. */
export const HEALTH_MARKS: typeof STATUS_MARKS = {
  none: { colour: "", height: 0, text: "never seen" },
  tentative: { colour: "#56B4E9", height: 0.55, text: "not confirmed" },
  good: { colour: "#009E73", height: 0.35, text: "confirmed, and detections are as the noise says" },
  ambiguous: { colour: "#E69F00", height: 0.7, text: "the estimate may be on another mode" },
  inconsistent: { colour: "#CC79A7", height: 0.85, text: "detections are not as the noise says" },
  lost: { colour: "#D55E00", height: 1, text: "it should be seen, and is not" },
};

/** With an opacity from 0 to 1. */
export function faded(colour: string, opacity: number): string {
  return colour + Math.round(255 * opacity).toString(16).padStart(2, "0");
}
