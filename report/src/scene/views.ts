// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The directions of the scene's views, and how far away one must be to see all.
import { Vector3 } from "three";

export const VIEW_NAMES = ["fit", "near", "top", "front", "side", "eye", "x", "-x", "y", "-y", "z", "-z"] as const;
export type View = (typeof VIEW_NAMES)[number];

export function isView(name: string): name is View {
  return (VIEW_NAMES as readonly string[]).includes(name);
}

/** Views along an axis have no perspective, so that lengths can be compared. */
export function isFlat(view: View): boolean {
  return !["fit", "near", "eye"].includes(view);
}

/** The horizontal axis of the world that points to the right in "front": x, or y where x is up. */
export function acrossOf(up: Vector3): Vector3 {
  const across = Math.abs(up.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  return across.addScaledVector(up, -across.dot(up)).normalize();
}

/** The unit vector from what is looked at to the viewer. */
export function directionOf(view: View, up: Vector3): Vector3 {
  const across = acrossOf(up);
  const forward = new Vector3().crossVectors(up, across);
  // Straight from above, what is up in the picture would be undetermined.
  const tilted = (from: Vector3) => from.addScaledVector(forward, Math.abs(from.dot(up)) > 0.9 ? -1e-4 : 0).normalize();
  if (view === "top") return tilted(up.clone());
  if (view === "front") return forward.negate();
  if (view === "side") return across;
  const axis = ["x", "y", "z"].indexOf(view.replace("-", ""));
  if (axis >= 0) return tilted(new Vector3().setComponent(axis, view.startsWith("-") ? -1 : 1));
  return across.multiplyScalar(0.55).addScaledVector(forward, -0.75).addScaledVector(up, 0.6).normalize();
}

/** The world's axis along a direction, such as "-z"; "" where it is along none. */
export function axisName(direction: Vector3): string {
  const parts = direction.toArray();
  const axis = parts.findIndex((part) => Math.abs(part) > 0.999);
  return axis < 0 ? "" : `${parts[axis] < 0 ? "-" : "+"}${"xyz"[axis]}`;
}

export interface Fit {
  /** What the view looks at. */
  centre: Vector3;
  /** For a view with perspective. */
  distance: number;
  /** For one without: half of the height that must be seen. */
  half: number;
}

export interface FitSettings {
  /** From what is looked at to the viewer. */
  from: Vector3;
  up: Vector3;
  /** Around each point. */
  margin: number;
  aspect: number;
  /** Of half the angle of view; 0: no perspective. */
  tangent: number;
}

const ROUNDS = 6;

/** What shows all points, as near as possible: the middle of the picture is the middle of what is in it. */
export function fitOf(points: readonly Vector3[], start: Vector3, { from, up, margin, aspect, tangent }: FitSettings): Fit {
  const right = new Vector3().crossVectors(up, from).normalize();
  const above = new Vector3().crossVectors(from, right);
  const centre = start.clone();
  const arm = new Vector3();
  const fit: Fit = { centre, distance: 0, half: 0 };
  for (let round = 0; round < ROUNDS; ++round) {
    let half = margin;
    let distance = tangent > 0 ? margin / tangent : 1;
    for (const point of points) {
      arm.subVectors(point, centre);
      const size = 1.04 * Math.max((Math.abs(arm.dot(right)) + margin) / aspect, Math.abs(arm.dot(above)) + margin);
      half = Math.max(half, size);
      if (tangent > 0) distance = Math.max(distance, arm.dot(from) + size / tangent);
    }
    fit.half = half;
    fit.distance = distance;
    // Without the last shift, the distance would be that of the centre before.
    if (round === ROUNDS - 1) break;
    const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
    for (const point of points) {
      arm.subVectors(point, centre);
      const depth = tangent > 0 ? Math.max(distance - arm.dot(from), 1e-9) / distance : 1;
      [arm.dot(right) / depth, arm.dot(above) / depth].forEach((value, i) => {
        low[i] = Math.min(low[i], value);
        high[i] = Math.max(high[i], value);
      });
    }
    if (points.length === 0) break;
    centre.addScaledVector(right, (low[0] + high[0]) / 2).addScaledVector(above, (low[1] + high[1]) / 2);
  }
  return fit;
}
