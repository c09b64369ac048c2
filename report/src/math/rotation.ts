// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Unit quaternions x y z w and 3x3 matrices row by row, in plain arrays that the caller owns.

export type Numbers = Float64Array | number[];
export type Vec3 = [number, number, number];
export type Quat = [number, number, number, number];

export const DEGREES = 180 / Math.PI;

export function normalize(q: Numbers): void {
  const norm = Math.hypot(q[0], q[1], q[2], q[3]);
  if (norm > 0) for (let i = 0; i < 4; ++i) q[i] /= norm;
  else q[3] = 1;
}

/** out = a b; out may be a or b. */
export function multiply(a: Numbers, b: Numbers, out: Numbers): void {
  const ax = a[0], ay = a[1], az = a[2], aw = a[3];
  const bx = b[0], by = b[1], bz = b[2], bw = b[3];
  out[0] = aw * bx + ax * bw + ay * bz - az * by;
  out[1] = aw * by - ax * bz + ay * bw + az * bx;
  out[2] = aw * bz + ax * by - ay * bx + az * bw;
  out[3] = aw * bw - ax * bx - ay * by - az * bz;
}

/** out = a b^-1. */
export function multiplyInverse(a: Numbers, b: Numbers, out: Numbers): void {
  const ax = a[0], ay = a[1], az = a[2], aw = a[3];
  const bx = -b[0], by = -b[1], bz = -b[2], bw = b[3];
  out[0] = aw * bx + ax * bw + ay * bz - az * by;
  out[1] = aw * by - ax * bz + ay * bw + az * bx;
  out[2] = aw * bz + ax * by - ay * bx + az * bw;
  out[3] = aw * bw - ax * bx - ay * by - az * bz;
}

/** The rotation matrix, row by row. */
export function matrixOf(q: Numbers, out: Numbers): void {
  const x = q[0], y = q[1], z = q[2], w = q[3];
  out[0] = 1 - 2 * (y * y + z * z);
  out[1] = 2 * (x * y - z * w);
  out[2] = 2 * (x * z + y * w);
  out[3] = 2 * (x * y + z * w);
  out[4] = 1 - 2 * (x * x + z * z);
  out[5] = 2 * (y * z - x * w);
  out[6] = 2 * (x * z - y * w);
  out[7] = 2 * (y * z + x * w);
  out[8] = 1 - 2 * (x * x + y * y);
}

export function rotate(q: Numbers, v: Numbers, out: Numbers): void {
  const x = q[0], y = q[1], z = q[2], w = q[3];
  const a = v[0], b = v[1], c = v[2];
  const tx = 2 * (y * c - z * b);
  const ty = 2 * (z * a - x * c);
  const tz = 2 * (x * b - y * a);
  out[0] = a + w * tx + y * tz - z * ty;
  out[1] = b + w * ty + z * tx - x * tz;
  out[2] = c + w * tz + x * ty - y * tx;
}

/** Exp of a rotation vector. */
export function quaternionOf(v: Numbers, out: Numbers): void {
  const angle = Math.hypot(v[0], v[1], v[2]);
  const scale = angle < 1e-4 ? 0.5 - (angle * angle) / 48 : Math.sin(angle / 2) / angle;
  out[3] = Math.cos(angle / 2);
  for (let i = 0; i < 3; ++i) out[i] = scale * v[i];
}

function vectorOf(q: Numbers, sign: number, out: Numbers): void {
  const sine = Math.hypot(q[0], q[1], q[2]);
  const w = sign * q[3];
  const scale = sine < 1e-9 && w > 0 ? 2 / w : (2 * Math.atan2(sine, w)) / (sine || 1);
  for (let i = 0; i < 3; ++i) out[i] = sign * scale * q[i];
}

/** The rotation vector of a quaternion with its sign: q and -q give different ones, one of them beyond pi. */
export function rotationVector(q: Numbers, out: Numbers): void {
  vectorOf(q, 1, out);
}

/** Log: the rotation vector of at most pi. */
export function log(q: Numbers, out: Numbers): void {
  vectorOf(q, q[3] < 0 ? -1 : 1, out);
}

/** Angle between two rotations. */
export function angleBetween(a: Numbers, b: Numbers): number {
  const dot = Math.abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
  const r = Math.hypot(
    a[3] * b[0] - a[0] * b[3] - a[1] * b[2] + a[2] * b[1],
    a[3] * b[1] + a[0] * b[2] - a[1] * b[3] - a[2] * b[0],
    a[3] * b[2] - a[0] * b[1] + a[1] * b[0] - a[2] * b[3],
  );
  return 2 * Math.atan2(r, dot);
}

/** Whether two poses agree within a millimetre and half a degree; smaller differences are not visible. */
export function samePose(p: Numbers, q: Numbers, otherP: Numbers, otherQ: Numbers): boolean {
  const dot = q[0] * otherQ[0] + q[1] * otherQ[1] + q[2] * otherQ[2] + q[3] * otherQ[3];
  return Math.hypot(p[0] - otherP[0], p[1] - otherP[1], p[2] - otherP[2]) < 1e-3 && 1 - dot * dot < 2e-5;
}

/** Roll, pitch, yaw about the fixed axes x, y, z: R = Rz(yaw) Ry(pitch) Rx(roll). */
export function rollPitchYaw(q: Numbers, out: Numbers): void {
  const x = q[0], y = q[1], z = q[2], w = q[3];
  out[0] = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  out[1] = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
  out[2] = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
}

/** The angle of the part of q that turns about a unit axis, in (-pi, pi]. */
export function twistAngle(q: Numbers, axis: Numbers): number {
  const along = q[0] * axis[0] + q[1] * axis[1] + q[2] * axis[2];
  let angle = 2 * Math.atan2(along, q[3]);
  if (angle > Math.PI) angle -= 2 * Math.PI;
  if (angle <= -Math.PI) angle += 2 * Math.PI;
  return angle;
}

/** The angle plus the multiple of a full turn that brings it nearest to another. */
export function unwrap(angle: number, near: number): number {
  return angle + 2 * Math.PI * Math.round((near - angle) / (2 * Math.PI));
}
