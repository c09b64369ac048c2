// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { CovarianceFrame } from "./spread.ts";

/** Parts of the scene that can be shown or hidden. */
export interface Layers {
  truth: boolean;
  hypotheses: boolean;
  detections: boolean;
  labels: boolean;
  /** Of objects that move. */
  paths: boolean;
  /** Where the run has images of the camera. */
  images: boolean;
  ellipsoids: boolean;
  /** Of the rotation, at the ends of the axes. */
  cones: boolean;
  /** Poses drawn from the Gaussian of the selected object. */
  samples: boolean;
  /** The selected object's principal axes with their lengths. */
  lengths: boolean;
}

/** How uncertainty is drawn. */
export interface UncertaintyLook {
  /** How many standard deviations; 0: one, two and three. */
  sigma: 0 | 1 | 2 | 3;
  /** How many times larger than true; 0: so many that it is visible. */
  factor: 0 | 1 | 10 | 100;
  frame: CovarianceFrame;
}

/** A pose at which something is drawn: x y z and a quaternion x y z w. */
export interface ShownPose {
  position: number[];
  quaternion: number[];
}
