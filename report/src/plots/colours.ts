// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
/** Of frames outside their bounds, as gated detections. */
export const OUTSIDE_COLOUR = "#D55E00";
export const DETECTED_COLOUR = "#8A8A8A";
