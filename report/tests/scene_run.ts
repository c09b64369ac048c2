// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A run for tests of the scene: a table with boxes, one of which comes late, two hypotheses of another, images of a camera whose
// intrinsics are known.
import { deflateSync } from "node:zlib";
import type { JsonObject } from "../src/payload.ts";
import { multiply, rotate } from "../src/math/rotation.ts";
import { packTrace, type TraceJson } from "./pack.ts";

export const FRAMES = 60;
export const IDS = ["mug", "tea-box", "soup-can", "cup", "cracker-box"];
export const LENS = { fx: 260, fy: 250, cx: 170, cy: 110, width: 320, height: 240 };
/** The object that comes at this frame. */
export const LATE = { id: "cup", frame: 20 };

const PLACES = [[0.3, 0.1, 0.05], [0.1, 0.35, 0.08], [-0.25, 0.2, 0.06], [-0.1, -0.2, 0.04], [0.3, -0.3, 0.12]];
/** Half sizes of the boxes [m]. */
const SIZES = [[0.04, 0.05, 0.05], [0.03, 0.06, 0.08], [0.035, 0.035, 0.06], [0.04, 0.04, 0.04], [0.03, 0.08, 0.12]];

const frames = <T>(make: (frame: number) => T) => Array.from({ length: FRAMES }, (_, frame) => make(frame));
const yaw = (angle: number) => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];

/** A camera at a distance that looks at the table from the side of an angle. */
function cameraPose(frame: number): number[] {
  const angle = -1.2 + frame / 40;
  const turn = [0, 0, 0, 1];
  // The first turn takes the camera's z to y and its y to -z of the world; then it looks down a little.
  multiply(yaw(angle + Math.PI / 2), [-Math.SQRT1_2, 0, 0, Math.SQRT1_2], turn);
  multiply(turn, [-Math.sin(0.2), 0, 0, Math.cos(0.2)], turn);
  return [1.1 * Math.cos(angle), 1.1 * Math.sin(angle), 0.6, ...turn];
}

function relativeTo(camera: number[], pose: number[]): number[] {
  const inverse = [-camera[3], -camera[4], -camera[5], camera[6]];
  const place = [0, 1, 2].map((i) => pose[i] - camera[i]);
  rotate(inverse, place, place);
  const turn = [0, 0, 0, 1];
  multiply(inverse, pose.slice(3), turn);
  return [...place, ...turn];
}

/** Standard deviations of an object at a frame: they fall, and are a third as large relative to the camera. */
export function sdOf(index: number, frame: number, isRelative: boolean): number[] {
  const share = (isRelative ? 1 / 3 : 1) / Math.sqrt(1 + frame);
  return [0.02, 0.03, 0.06, 0.02, 0.01, 0.03].map((sd) => sd * share * (1 + 0.2 * index));
}

export function covarianceOf(index: number, frame: number, isRelative: boolean): number[] {
  const [, , , x, y, z] = sdOf(index, frame, isRelative);
  return [x * x, 0.5 * x * y, 0, y * y, 0, z * z];
}

export function sceneTrace(): TraceJson {
  const camera = frames(cameraPose);
  const objects: TraceJson["objects"] = {};
  IDS.forEach((id, i) => {
    const truth = frames(() => [...PLACES[i], ...yaw(0.5 * i)]);
    const isHere = (frame: number) => id !== LATE.id || frame >= LATE.frame;
    const pose = frames((k) => (isHere(k) ? [PLACES[i][0] + 0.02 / (1 + k), PLACES[i][1] - 0.01 / (1 + k), PLACES[i][2], ...yaw(0.5 * i + 0.03 / (1 + k))] : null));
    const part = (poses: (number[] | null)[], isRelative: boolean, real: (number[] | null)[]) => ({
      pose: poses, truth: real,
      sd: frames((k) => (isHere(k) ? sdOf(i, k, isRelative) : null)),
      position_covariance: frames((k) => (isHere(k) ? covarianceOf(i, k, isRelative) : null)),
    });
    const relative = pose.map((one, k) => one && relativeTo(camera[k], one));
    const turned = (k: number) => [...pose[k]!.slice(0, 3), ...yaw(0.5 * i + Math.PI)];
    const second = id === "tea-box" ? 0.36 : 0.003;
    objects[id] = {
      world: part(pose, false, truth), relative: part(relative, true, frames((k) => relativeTo(camera[k], truth[k]))),
      detection: relative, status: pose.map((one) => (one ? "used" : "none")), mode_probability: pose.map((one) => (one ? 1 - second : null)),
      alternatives: pose.map((one, k) => (one ? [{ id: 10 * i, probability: 1 - second, pose: one }, { id: 10 * i + 1, probability: second, pose: turned(k) }] : [])),
    };
  });
  return {
    name: "Table: a test", method: "multi-object", frames: FRAMES, stamps_s: frames((k) => 50 + 0.1 * k), order: [...IDS],
    camera: { pose: camera, truth: camera, sd: frames(() => [1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3]), position_covariance: frames(() => [4e-6, 0, 0, 4e-6, 0, 4e-6]) },
    objects, hypotheses: frames(() => []),
  };
}

function crc(bytes: Uint8Array): number {
  let value = ~0;
  for (const byte of bytes) {
    value ^= byte;
    for (let k = 0; k < 8; ++k) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  }
  return ~value >>> 0;
}

function chunk(type: string, data: Buffer): Buffer {
  const body = Buffer.concat([Buffer.from(type), data]);
  const out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE(crc(body), body.length + 4);
  return out;
}

/** A PNG of colours by pixel. */
export function png(width: number, height: number, at: (x: number, y: number) => [number, number, number]): string {
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) rows.set(at(x, y), y * (1 + 3 * width) + 1 + 3 * x);
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const parts = [Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))];
  return Buffer.concat(parts).toString("base64");
}

/** Where a point of the world is in the image of a frame [pixels]. */
export function pixelOf(frame: number, point: number[]): [number, number] {
  const [x, y, z] = relativeTo(cameraPose(frame), [...point, 0, 0, 0, 1]);
  return [LENS.cx + (LENS.fx * x) / z, LENS.cy + (LENS.fy * y) / z];
}

/** The images have a bright disc where each object truly is. */
function imageOf(frame: number): string {
  const discs = PLACES.map((place) => pixelOf(frame, place));
  return png(LENS.width, LENS.height, (x, y) => {
    const inside = discs.some(([u, v]) => Math.hypot(x - u, y - v) < 6);
    return inside ? [250, 220, 60] : [60 + (x >> 3), 80 + (y >> 3), 110];
  });
}

function box([x, y, z]: number[]): { vertices: string; triangles: string } {
  const vertices = [...Array(8).keys()].flatMap((k) => [k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z]);
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const triangles = sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
  const base64 = (array: Float32Array | Uint32Array) => Buffer.from(array.buffer).toString("base64");
  return { vertices: base64(new Float32Array(vertices)), triangles: base64(new Uint32Array(triangles)) };
}

export interface Parts {
  lens?: boolean;
  images?: boolean;
  meshes?: boolean;
}

export function sceneReport({ lens, images, meshes }: Parts = {}): JsonObject {
  const trace = packTrace(sceneTrace()) as unknown as JsonObject;
  return {
    schema: 1, type: "posemix.report", kind: "slam", title: "Table", program: "posemix 0.2.0", documents: {},
    trace: lens ? { ...trace, intrinsics: LENS } : trace,
    meshes: meshes ? Object.fromEntries(IDS.map((id, i) => [id, box(SIZES[i])])) : {},
    ...(images ? { images: frames((k) => k).filter((k) => k % 2 === 0).map((k) => ({ stamp_s: 50 + 0.1 * k, type: "image/png", data: imageOf(k) })) } : {}),
  };
}
