// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the pointer is on: the axes that are drawn, in the picture's pixels.
import { type Camera, Vector3 } from "three";
import { type Numbers, rotate } from "../math/rotation.ts";

export type Kind = "estimate" | "hypothesis" | "truth" | "detection";

export interface Pick {
  entity: number;
  kind: Kind;
  /** Of a hypothesis. */
  slot: number;
}

const MOST = 512;
/** As near to a line or its origin, in pixels, is on it; the origin is easier to hit. */
const REACH = 7;
const ORIGIN_REACH = 12;

export class Picks {
  private readonly points = new Float64Array(12 * MOST);
  private readonly picks: Pick[] = Array.from({ length: MOST }, () => ({ entity: 0, kind: "estimate", slot: 0 }));
  private count = 0;
  private readonly v = new Float64Array(3);
  private readonly screen = new Float64Array(8);
  private readonly point = new Vector3();

  clear(): void {
    this.count = 0;
  }

  add(entity: number, kind: Kind, slot: number, p: Numbers, q: Numbers, length: number): void {
    if (this.count === MOST) return;
    const at = 12 * this.count;
    for (let i = 0; i < 3; ++i) this.points[at + i] = p[i];
    for (let axis = 0; axis < 3; ++axis) {
      for (let i = 0; i < 3; ++i) this.v[i] = i === axis ? length : 0;
      rotate(q, this.v, this.v);
      for (let i = 0; i < 3; ++i) this.points[at + 3 + 3 * axis + i] = p[i] + this.v[i];
    }
    const pick = this.picks[this.count++];
    pick.entity = entity;
    pick.kind = kind;
    pick.slot = slot;
  }

  private distance(k: number, x: number, y: number, camera: Camera, width: number, height: number): number {
    const { screen } = this;
    for (let i = 0; i < 4; ++i) {
      this.point.fromArray(this.points, 12 * k + 3 * i).project(camera);
      if (Math.abs(this.point.z) > 1) return Infinity;
      screen[2 * i] = (0.5 + 0.5 * this.point.x) * width;
      screen[2 * i + 1] = (0.5 - 0.5 * this.point.y) * height;
    }
    let least = (Math.hypot(screen[0] - x, screen[1] - y) * REACH) / ORIGIN_REACH;
    for (let i = 1; i < 4; ++i) {
      const [dx, dy] = [screen[2 * i] - screen[0], screen[2 * i + 1] - screen[1]];
      const share = Math.max(0, Math.min(1, ((x - screen[0]) * dx + (y - screen[1]) * dy) / Math.max(dx * dx + dy * dy, 1e-9)));
      least = Math.min(least, Math.hypot(screen[0] + share * dx - x, screen[1] + share * dy - y));
    }
    return least;
  }

  /** What is nearest to a point of the picture; estimates come before what lies with them. */
  at(x: number, y: number, camera: Camera, width: number, height: number): Pick | undefined {
    let found: Pick | undefined;
    let least = REACH;
    for (let k = 0; k < this.count; ++k) {
      const distance = this.distance(k, x, y, camera, width, height) + (this.picks[k].kind === "estimate" ? 0 : 1);
      if (distance >= least) continue;
      least = distance;
      found = this.picks[k];
    }
    return found;
  }
}
