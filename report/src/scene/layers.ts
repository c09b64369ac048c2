// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

/** Parts of the scene that can be shown or hidden. */
export interface Layers {
  truth: boolean;
  ellipsoids: boolean;
  hypotheses: boolean;
  detections: boolean;
  labels: boolean;
  /** Of objects that move. */
  paths: boolean;
}

/** A pose at which something is drawn: x y z and a quaternion x y z w. */
export interface ShownPose {
  position: number[];
  quaternion: number[];
}
