// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { type PerspectiveCamera, Vector3 } from "three";
import { element } from "../ui/dom.ts";
import { onTheme, themeColour } from "../ui/theme.ts";

const MOST = 256;
const LINE = 14;
const MOST_SHIFT = 4 * LINE;

/** Labels at points of the scene, on a canvas above it; drawing a frame allocates nothing. */
export class LabelLayer {
  readonly canvas = element("canvas", { class: "labels", "aria-hidden": "true" });
  private readonly context = this.canvas.getContext("2d")!;
  private readonly points = new Float64Array(3 * MOST);
  private readonly texts: string[] = new Array<string>(MOST).fill("");
  private readonly colours: string[] = new Array<string>(MOST).fill("");
  private readonly placed = new Float64Array(3 * MOST);
  private readonly point = new Vector3();
  private paper = themeColour("--paper");
  private count = 0;
  private width = 0;
  private height = 0;

  constructor() {
    onTheme(() => (this.paper = themeColour("--paper")));
  }

  clear(): void {
    this.count = 0;
  }

  add(x: number, y: number, z: number, text: string, colour: string): void {
    if (this.count === MOST) return;
    this.points[3 * this.count] = x;
    this.points[3 * this.count + 1] = y;
    this.points[3 * this.count + 2] = z;
    this.texts[this.count] = text;
    this.colours[this.count++] = colour;
  }

  resize(width: number, height: number): void {
    const ratio = Math.min(devicePixelRatio, 2);
    this.width = width;
    this.height = height;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  draw(camera: PerspectiveCamera): void {
    const { context } = this;
    context.clearRect(0, 0, this.width, this.height);
    if (this.count === 0) return;
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.lineWidth = 3;
    context.lineJoin = "round";
    context.strokeStyle = this.paper;
    for (let i = 0; i < this.count; ++i) {
      this.point.set(this.points[3 * i], this.points[3 * i + 1], this.points[3 * i + 2]).project(camera);
      this.placed[3 * i + 2] = -1;
      if (this.point.z > 1 || this.point.z < -1) continue;
      const x = Math.round((0.5 + 0.5 * this.point.x) * this.width) + 9;
      let y = Math.round((0.5 - 0.5 * this.point.y) * this.height) - 9;
      const lowest = y + MOST_SHIFT;
      const width = 6.4 * this.texts[i].length;
      for (let k = 0; k < i && y <= lowest; ++k) {
        const near = this.placed[3 * k + 2] > 0 && Math.abs(this.placed[3 * k + 1] - y) < LINE;
        if (near && x < this.placed[3 * k] + this.placed[3 * k + 2] && this.placed[3 * k] < x + width) {
          y = this.placed[3 * k + 1] + LINE;
          k = -1;
        }
      }
      if (y > lowest) continue;
      this.placed[3 * i] = x;
      this.placed[3 * i + 1] = y;
      this.placed[3 * i + 2] = width;
      context.strokeText(this.texts[i], x, y);
      context.fillStyle = this.colours[i];
      context.fillText(this.texts[i], x, y);
    }
  }
}
