// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A mixture file, converted to one convention: rotation before translation, metres, radians or tan(angle / 2).
import { congruence } from "../math/linear.ts";
import { matrixOf, multiply, normalize, type Numbers } from "../math/rotation.ts";
import { BadPayload, isObject, type Json, type JsonObject } from "../payload.ts";

export type Distribution = "concentrated" | "projected";
export type Side = "left" | "right";

export interface Component {
  weight: number;
  /** Translation and quaternion of the mean (for a projected component: of the pose at the mean of u). */
  translation: number[];
  quaternion: number[];
  /** For a projected component: its tangent point, and the mean of u. */
  tangentPoint: number[];
  u: number[];
  /** 6x6, rotation first, row by row. */
  covariance: Float64Array;
}

export interface Mixture {
  /** Of its object in a run, whose tints its components have. */
  colour?: string;
  name: string;
  distribution: Distribution;
  side: Side;
  from: string;
  to: string;
  components: Component[];
}

function numbers(value: Json | undefined, count: number, where: string): number[] {
  if (!Array.isArray(value) || value.length !== count || value.some((number) => typeof number !== "number")) {
    throw new BadPayload(`${where} must hold ${count} numbers.`);
  }
  return value as number[];
}

function object(value: Json | undefined, where: string): JsonObject {
  if (!isObject(value)) throw new BadPayload(`${where} must be an object.`);
  return value;
}

/** Rotation first, in radians (or u) and metres. */
function covariance(value: Json | undefined, translationFirst: boolean, scale: number[], where: string): Float64Array {
  if (!Array.isArray(value) || value.length !== 6) throw new BadPayload(`${where}.covariance must have six rows.`);
  const rows = value.map((row) => numbers(row, 6, `${where}.covariance`));
  const out = new Float64Array(36);
  for (let i = 0; i < 6; ++i) {
    for (let j = 0; j < 6; ++j) {
      const [a, b] = translationFirst ? [(i + 3) % 6, (j + 3) % 6] : [i, j];
      out[6 * i + j] = rows[a][b] * scale[i < 3 ? 0 : 1] * scale[j < 3 ? 0 : 1];
    }
  }
  return out;
}

/** q0 (1, u) / sqrt(1 + u.u). */
export function project(q0: Numbers, u: Numbers, out: Numbers): void {
  const turned = [u[0], u[1], u[2], 1];
  normalize(turned);
  multiply(q0, turned, out);
}

/** Reads a document of type posemix.mixture. */
export function readMixture(name: string, document: Json): Mixture {
  const json = object(document, name);
  if (json["schema"] !== 1) throw new BadPayload(`${name} has schema ${String(json["schema"])}; this page reads schema 1.`);
  // "law" is the key's name in the release before.
  const distribution = json["distribution"] ?? json["law"];
  if (distribution !== "concentrated" && distribution !== "projected") throw new BadPayload(`${name}: the distribution "${String(distribution)}" is not known.`);
  const units = object(json["units"], `${name}: units`);
  const frames = object(json["frames"], `${name}: frames`);
  const scale = [units["rotation"] === "deg" ? Math.PI / 180 : 1, units["translation"] === "mm" ? 1e-3 : 1];
  const list = json["components"];
  if (!Array.isArray(list) || list.length === 0) throw new BadPayload(`${name}: components must be a list.`);
  const components = list.map((entry, i): Component => {
    const where = `${name}: components[${i}]`;
    const value = object(entry, where);
    const weight = typeof value["weight"] === "number" ? value["weight"] : Math.exp(Number(value["log_weight"] ?? -Infinity));
    const mean = object(value[distribution === "projected" ? "tangent_mean" : "mean"], where);
    const place = distribution === "projected" ? object(value["tangent_point"], where) : mean;
    const tangentPoint = [...numbers(place["quaternion_xyzw"], 4, where)];
    normalize(tangentPoint);
    const u = distribution === "projected" ? numbers(mean["u"], 3, where) : [0, 0, 0];
    const quaternion = [0, 0, 0, 1];
    project(tangentPoint, u, quaternion);
    return {
      weight,
      translation: numbers(mean["translation"], 3, where).map((value) => value * scale[1]),
      quaternion,
      tangentPoint,
      u,
      covariance: covariance(value["covariance"], json["order"] === "translation_rotation", scale, where),
    };
  });
  const sum = components.reduce((total, { weight }) => total + weight, 0);
  if (!(sum > 0)) throw new BadPayload(`${name}: the weights must have a positive sum.`);
  for (const component of components) component.weight /= sum;
  const side = distribution === "projected" || json["side"] === "right" ? "right" : "left";
  return { name, distribution, side, from: String(frames["from"]), to: String(frames["to"]), components };
}

/** The covariance of the position, to first order, row by row. */
export function positionCovariance(mixture: Mixture, { covariance: p, translation: t, quaternion }: Component): Float64Array {
  const block = new Float64Array(9);
  if (mixture.distribution === "concentrated" && mixture.side === "left") {
    const j = new Float64Array(36);
    j.set([0, t[2], -t[1], 1, 0, 0], 18);
    j.set([-t[2], 0, t[0], 0, 1, 0], 24);
    j.set([t[1], -t[0], 0, 0, 0, 1], 30);
    const whole = congruence(j, p, 6);
    for (let i = 0; i < 9; ++i) block[i] = whole[6 * (3 + Math.floor(i / 3)) + 3 + (i % 3)];
    return block;
  }
  for (let i = 0; i < 9; ++i) block[i] = p[6 * (3 + Math.floor(i / 3)) + 3 + (i % 3)];
  if (mixture.distribution === "projected") return block;
  const r = new Float64Array(9);
  matrixOf(quaternion, r);
  return congruence(r, block, 3);
}

/** Standard deviations about the three axes [rad], for a projected component to first order. */
export function rotationSd(mixture: Mixture, { covariance, u }: Component): number[] {
  const scale = mixture.distribution === "projected" ? 2 / (1 + u[0] ** 2 + u[1] ** 2 + u[2] ** 2) : 1;
  return [0, 7, 14].map((i) => scale * Math.sqrt(covariance[i]));
}
