// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

/** What can be shown or hidden. */
export interface Layers {
  truth: boolean;
  ellipsoids: boolean;
  hypotheses: boolean;
  detections: boolean;
  labels: boolean;
}

/** Where something is drawn: x y z and a quaternion x y z w. */
export interface ShownPose {
  position: number[];
  quaternion: number[];
}
