// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the picture itself says: the scale, the directions of the world's axes, notes, and which object is selected.
import { type Camera, type OrthographicCamera, type PerspectiveCamera, Vector3 } from "three";
import { AXIS_COLOURS } from "../ui/palette.ts";
import { onTheme, themeColour } from "../ui/theme.ts";
import type { Painter } from "./labels.ts";
import { wrapped } from "./picture_text.ts";
import type { Placement } from "./placement.ts";
import { lengthText, roundLength } from "./units.ts";
import type { View } from "./views.ts";

const SCALE_SHARE = 0.22;
const FONT = "12px system-ui, sans-serif";
const AXES = ["x", "y", "z"] as const;
const HIT = 11;

/** Metres per pixel at a distance in front of a camera, in a view of a height. */
export function metresPerPixel(camera: PerspectiveCamera | OrthographicCamera, distance: number, height: number): number {
  if ("isOrthographicCamera" in camera) return (camera.top - camera.bottom) / camera.zoom / height;
  // The matrix holds 1 / tan(fov / 2), whatever lens it is.
  return (2 * distance) / camera.projectionMatrix.elements[5] / height;
}

export class Overlay implements Painter {
  /** Lines at the upper left. */
  notes: string[] = [];
  /** The same as they were drawn last, with the lines broken. */
  readonly noteLines: string[] = [];
  /** Where the selected object is, and how large [m]; undefined if it is not seen. */
  readonly marked = new Vector3();
  markedSize = 0;
  markedColour = "";
  /** Of the last drawing. */
  scale = { metres: 0, pixels: 0 };
  private readonly ends = new Float64Array(18);
  private readonly order = [0, 1, 2, 3, 4, 5];
  private readonly point = new Vector3();
  private ink = "";
  private muted = "";
  private panel = "";

  constructor(private readonly camera: () => PerspectiveCamera | OrthographicCamera, private readonly target: () => Vector3) {
    const take = () => {
      this.ink = themeColour("--ink");
      this.muted = themeColour("--muted");
      this.panel = themeColour("--panel");
    };
    onTheme(take);
    take();
  }

  paint(context: CanvasRenderingContext2D, width: number, height: number, placement: Placement): void {
    const camera = this.camera();
    context.textBaseline = "middle";
    context.font = FONT;
    this.paintMark(context, width, height, camera);
    this.paintScale(context, width, height, camera, placement);
    this.paintAxes(context, width, height, camera, placement);
    this.paintNotes(context, width, placement);
  }

  /** Corners around the selected object. */
  private paintMark(context: CanvasRenderingContext2D, width: number, height: number, camera: PerspectiveCamera | OrthographicCamera): void {
    if (this.markedSize <= 0) return;
    this.point.copy(this.marked).applyMatrix4(camera.matrixWorldInverse);
    const half = Math.max(14, this.markedSize / metresPerPixel(camera, Math.max(-this.point.z, 1e-6), height));
    this.point.copy(this.marked).project(camera);
    if (Math.abs(this.point.z) > 1 || half > height) return;
    const x = (0.5 + 0.5 * this.point.x) * width;
    const y = (0.5 - 0.5 * this.point.y) * height;
    const corner = Math.min(10, half / 2);
    context.strokeStyle = this.markedColour;
    context.lineWidth = 2;
    context.beginPath();
    for (let k = 0; k < 4; ++k) {
      const [sx, sy] = [k % 2 === 0 ? -1 : 1, k < 2 ? -1 : 1];
      context.moveTo(x + sx * (half - corner), y + sy * half);
      context.lineTo(x + sx * half, y + sy * half);
      context.lineTo(x + sx * half, y + sy * (half - corner));
    }
    context.stroke();
  }

  /** The bar is true at the distance of the point around which the view turns, without perspective everywhere. */
  private paintScale(context: CanvasRenderingContext2D, width: number, height: number, camera: PerspectiveCamera | OrthographicCamera, placement: Placement): void {
    const distance = camera.position.distanceTo(this.target());
    const step = metresPerPixel(camera, distance, height);
    const metres = roundLength(SCALE_SHARE * width * step);
    const pixels = metres / step;
    this.scale = { metres, pixels };
    const text = lengthText(metres) + ("isOrthographicCamera" in camera ? "" : " at the centre");
    const [x, y] = [12, height - 14];
    const long = Math.max(pixels, context.measureText(text).width);
    this.plate(context, x - 6, y - 24, long + 12, 34);
    placement.block(x - 6, y - 24, long + 12, 34);
    context.strokeStyle = this.ink;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(x, y - 5);
    context.lineTo(x, y);
    context.lineTo(x + pixels, y);
    context.lineTo(x + pixels, y - 5);
    context.stroke();
    context.fillStyle = this.ink;
    context.fillText(text, x, y - 13);
  }

  private plate(context: CanvasRenderingContext2D, x: number, y: number, width: number, height: number): void {
    context.globalAlpha = 0.75;
    context.fillStyle = this.panel;
    context.beginPath();
    context.roundRect(x, y, width, height, 5);
    context.fill();
    context.globalAlpha = 1;
  }

  /** The world's axes as they are seen: ends 0 to 2 are the positive ones. */
  private paintAxes(context: CanvasRenderingContext2D, width: number, height: number, camera: Camera, placement: Placement): void {
    const radius = width < 500 ? 24 : 32;
    const [x, y] = [width - radius - 18, height - radius - 18];
    placement.block(x - radius - 12, y - radius - 12, 2 * radius + 24, 2 * radius + 24);
    const { ends, order } = this;
    for (let k = 0; k < 6; ++k) {
      this.point.set(0, 0, 0).setComponent(k % 3, k < 3 ? 1 : -1).transformDirection(camera.matrixWorldInverse);
      ends[3 * k] = x + radius * this.point.x;
      ends[3 * k + 1] = y - radius * this.point.y;
      ends[3 * k + 2] = this.point.z;
    }
    order.sort((a, b) => ends[3 * a + 2] - ends[3 * b + 2]);
    context.textAlign = "center";
    for (const k of order) this.paintEnd(context, k, x, y);
    context.textAlign = "start";
  }

  private paintEnd(context: CanvasRenderingContext2D, k: number, x: number, y: number): void {
    const { ends } = this;
    const isPositive = k < 3;
    context.strokeStyle = context.fillStyle = AXIS_COLOURS[k % 3];
    context.globalAlpha = isPositive ? 1 : 0.45;
    context.lineWidth = 2;
    context.beginPath();
    if (isPositive) {
      context.moveTo(x, y);
      context.lineTo(ends[3 * k], ends[3 * k + 1]);
      context.stroke();
      context.beginPath();
    }
    context.arc(ends[3 * k], ends[3 * k + 1], isPositive ? 8 : 4.5, 0, 7);
    context.fill();
    context.globalAlpha = 1;
    if (!isPositive) return;
    context.fillStyle = "#ffffff";
    context.font = "700 11px system-ui, sans-serif";
    context.fillText(AXES[k], ends[3 * k], ends[3 * k + 1] + 0.5);
    context.font = FONT;
  }

  /** What is wider than the picture goes on in the next line. */
  private paintNotes(context: CanvasRenderingContext2D, most: number, placement: Placement): void {
    const measure = (text: string) => context.measureText(text).width;
    this.noteLines.length = 0;
    for (let i = 0; i < this.notes.length; ++i) {
      for (const text of wrapped(this.notes[i], most - 24, measure)) {
        const top = 6 + 20 * this.noteLines.length;
        const width = measure(text) + 12;
        this.plate(context, 6, top, width, 18);
        placement.block(6, top, width, 18);
        context.fillStyle = i === 0 ? this.ink : this.muted;
        context.fillText(text, 12, top + 9);
        this.noteLines.push(text);
      }
    }
  }

  /** The view along the axis whose end is at a point of the picture. */
  viewAt(x: number, y: number): View | undefined {
    for (let i = 5; i >= 0; --i) {
      const k = this.order[i];
      if (Math.hypot(this.ends[3 * k] - x, this.ends[3 * k + 1] - y) > HIT) continue;
      return `${k < 3 ? "" : "-"}${AXES[k % 3]}` as View;
    }
    return undefined;
  }

  /** Where the ends of the axes are, for tests. */
  get axisEnds(): Record<string, [number, number]> {
    return Object.fromEntries([0, 1, 2, 3, 4, 5].map((k) => [`${k < 3 ? "" : "-"}${AXES[k % 3]}`, [this.ends[3 * k], this.ends[3 * k + 1]] as [number, number]]));
  }
}
