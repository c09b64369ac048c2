// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Where labels go: beside their points, none over another, with room found in rings around the point.

const MOST = 512;
const RADII = [9, 22, 38, 58, 82];
/** Directions, the best first: a label stands right above its point if nothing is there. */
const DIRECTIONS = [[1, -1], [1, 0], [1, 1], [-1, -1], [-1, 0], [-1, 1], [0, -1], [0, 1]];
const GAP = 2;
/** The slots right beside the point. */
export const NEAR_SLOTS = 2 * DIRECTIONS.length;
export const SLOTS = RADII.length * DIRECTIONS.length;

export class Placement {
  /** Upper left corner of the box that was placed last. */
  x = 0;
  y = 0;
  private readonly boxes = new Float64Array(4 * MOST);
  private count = 0;
  private width = 0;
  private height = 0;

  begin(width: number, height: number): void {
    this.count = 0;
    this.width = width;
    this.height = height;
  }

  /** Keeps a place free. */
  block(x: number, y: number, width: number, height: number): void {
    if (this.count === MOST) return;
    const at = 4 * this.count++;
    this.boxes[at] = x;
    this.boxes[at + 1] = y;
    this.boxes[at + 2] = x + width;
    this.boxes[at + 3] = y + height;
  }

  private isFree(x: number, y: number, width: number, height: number): boolean {
    if (x < 2 || y < 2 || x + width > this.width - 2 || y + height > this.height - 2) return false;
    const { boxes } = this;
    for (let at = 0; at < 4 * this.count; at += 4) {
      if (x < boxes[at + 2] + GAP && boxes[at] < x + width + GAP && y < boxes[at + 3] + GAP && boxes[at + 1] < y + height + GAP) return false;
    }
    return true;
  }

  private goTo(slot: number, atX: number, atY: number, width: number, height: number): void {
    const radius = RADII[Math.floor(slot / DIRECTIONS.length)];
    const [dx, dy] = DIRECTIONS[slot % DIRECTIONS.length];
    const reach = dx !== 0 && dy !== 0 ? 0.75 * radius : radius;
    this.x = Math.round(atX + dx * reach - (dx > 0 ? 0 : dx < 0 ? width : width / 2));
    this.y = Math.round(atY + dy * reach - (dy > 0 ? 0 : dy < 0 ? height : height / 2));
  }

  /** Finds room for a box near a point, first where it was, in so many slots; the slot, or -1 if there is none. */
  place(atX: number, atY: number, width: number, height: number, last: number, slots = SLOTS): number {
    for (let i = -1; i < slots; ++i) {
      const slot = i < 0 ? last : i;
      if (slot < 0) continue;
      this.goTo(slot, atX, atY, width, height);
      if (!this.isFree(this.x, this.y, width, height)) continue;
      this.block(this.x, this.y, width, height);
      return slot;
    }
    return -1;
  }
}
