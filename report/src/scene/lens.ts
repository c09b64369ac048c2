// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The intrinsics of the recording's camera, and where its image lies in a view.
import { BadPayload, isObject } from "../payload.ts";

/** Pixels, in OpenCV's camera frame: the centre of the first pixel is (0, 0). */
export interface Intrinsics {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  width: number;
  height: number;
}

/** Left, top, right and bottom of a view at a distance. */
export interface Window {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Reads them if they are there. */
export function readIntrinsics(value: unknown): Intrinsics | undefined {
  if (value === undefined || value === null) return undefined;
  const keys = ["fx", "fy", "cx", "cy", "width", "height"] as const;
  const wrong = !isObject(value) || keys.some((key) => typeof value[key] !== "number" || !Number.isFinite(value[key]));
  if (wrong || keys.some((key) => key !== "cx" && key !== "cy" && !((value[key] as number) > 0))) {
    throw new BadPayload('"trace.intrinsics" must hold fx, fy, cx, cy, width and height, in pixels.');
  }
  return Object.fromEntries(keys.map((key) => [key, value[key]])) as unknown as Intrinsics;
}

/** Where the image lies in a view: in its middle, as large as it fits. */
export function imageBox(lens: Intrinsics, width: number, height: number): Box {
  const scale = Math.min(width / lens.width, height / lens.height);
  const size = [scale * lens.width, scale * lens.height];
  return { x: (width - size[0]) / 2, y: (height - size[1]) / 2, width: size[0], height: size[1] };
}

/** The window of a perspective camera through which the image is seen there. */
export function windowOf(lens: Intrinsics, width: number, height: number, near: number): Window {
  const box = imageBox(lens, width, height);
  const scale = box.width / lens.width;
  const column = (x: number) => (x - box.x) / scale - 0.5;
  const row = (y: number) => (y - box.y) / scale - 0.5;
  return {
    left: (near * (column(0) - lens.cx)) / lens.fx,
    right: (near * (column(width) - lens.cx)) / lens.fx,
    top: (-near * (row(0) - lens.cy)) / lens.fy,
    bottom: (-near * (row(height) - lens.cy)) / lens.fy,
  };
}

/** The image's corners at distance one, clockwise from the upper left: x to the right, y down. */
export function cornersOf(lens: Intrinsics): [number, number][] {
  const [left, right] = [-0.5, lens.width - 0.5].map((u) => (u - lens.cx) / lens.fx);
  const [top, bottom] = [-0.5, lens.height - 0.5].map((v) => (v - lens.cy) / lens.fy);
  return [[left, top], [right, top], [right, bottom], [left, bottom]];
}

/** Where the intrinsics are not known: a pyramid that stands for a camera, as the hint says. */
export const SYMBOLIC: [number, number][] = [[-0.62, -0.46], [0.62, -0.46], [0.62, 0.46], [-0.62, 0.46]];

/** The corners of a camera's pyramid, by what the trace says of it. */
export const lensCorners = (value: unknown): readonly [number, number][] => {
  const lens = readIntrinsics(value);
  return lens ? cornersOf(lens) : SYMBOLIC;
};
