// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { type Camera, Vector3 } from "three";
import { element } from "../ui/dom.ts";
import { enlarged } from "../ui/text_size.ts";
import { onTheme, themeColour } from "../ui/theme.ts";
import { NEAR_SLOTS, Placement, SLOTS } from "./placement.ts";

const MOST = 256;
const HEIGHT = 16;
const DOT = 11;
const MORE = 26;
const MOST_WIDTHS = 4000;

/** What is drawn on the same canvas: it keeps places free, and paints before the labels. */
export interface Painter {
  paint: (context: CanvasRenderingContext2D, width: number, height: number, placement: Placement) => void;
}

export interface LabelStyle {
  /** Of the dot, and of the line to the point. */
  colour: string;
  /** Of what it names; a click on it selects that. */
  entity: number;
  isStrong?: boolean;
  /** Whether it is counted where it has no room. */
  isName?: boolean;
  /** Whether it is left out where there is no room right beside its point. */
  isMinor?: boolean;
}

/** Labels at points of the scene, on a canvas above it; drawing a frame allocates little. */
export class LabelLayer {
  readonly canvas = element("canvas", { class: "labels", "aria-hidden": "true" });
  painter: Painter | undefined;
  /** How much larger than usual all of it is; places within are in units of as many pixels. */
  factor = 1;
  /** Names that had no room when it was drawn last. */
  left = 0;
  private readonly context = this.canvas.getContext("2d")!;
  private readonly points = new Float64Array(3 * MOST);
  private readonly texts: string[] = new Array<string>(MOST).fill("");
  private readonly styles: LabelStyle[] = [];
  private readonly screen = new Float64Array(2 * MOST);
  /** x, y and width of each label's box; width zero: not drawn. */
  private readonly boxes = new Float64Array(3 * MOST);
  private readonly more = new Int32Array(MOST);
  private readonly slots = new Map<LabelStyle, Map<string, number>>();
  private readonly placement = new Placement();
  private readonly widths = new Map<string, number>();
  private readonly strongWidths = new Map<string, number>();
  private readonly point = new Vector3();
  private ink = "";
  private paper = "";
  private count = 0;
  private width = 0;
  private height = 0;
  private strong = "";
  private plain = "";

  constructor() {
    const take = () => {
      this.ink = themeColour("--ink");
      this.paper = themeColour("--panel");
    };
    onTheme(take);
    take();
  }

  clear(): void {
    this.count = 0;
  }

  /** Labels that are added first find room first. */
  add(x: number, y: number, z: number, text: string, style: LabelStyle): void {
    if (this.count === MOST) return;
    this.points[3 * this.count] = x;
    this.points[3 * this.count + 1] = y;
    this.points[3 * this.count + 2] = z;
    this.texts[this.count] = text;
    this.styles[this.count++] = style;
  }

  resize(width: number, height: number): void {
    const ratio = Math.min(devicePixelRatio, 2);
    this.factor = enlarged();
    this.width = width / this.factor;
    this.height = height / this.factor;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.context.setTransform(ratio * this.factor, 0, 0, ratio * this.factor, 0, 0);
    const size = this.height > 1100 ? 15 : 12;
    this.plain = `${size}px system-ui, sans-serif`;
    this.strong = `700 ${size}px system-ui, sans-serif`;
    this.widths.clear();
    this.strongWidths.clear();
  }

  draw(camera: Camera): void {
    const { context, placement } = this;
    context.clearRect(0, 0, this.width, this.height);
    placement.begin(this.width, this.height);
    this.painter?.paint(context, this.width, this.height, placement);
    this.left = 0;
    this.project(camera);
    for (let i = 0; i < this.count; ++i) this.placeOne(i);
    for (let i = 0; i < this.count; ++i) if (this.boxes[3 * i + 2] < 0) this.countLeft(i);
    for (let i = 0; i < this.count; ++i) if (this.boxes[3 * i + 2] > 0) this.lead(i);
    for (let i = 0; i < this.count; ++i) if (this.boxes[3 * i + 2] > 0) this.write(i);
  }

  private project(camera: Camera): void {
    for (let i = 0; i < this.count; ++i) {
      this.point.set(this.points[3 * i], this.points[3 * i + 1], this.points[3 * i + 2]).project(camera);
      const isSeen = Math.abs(this.point.z) <= 1 && Math.abs(this.point.x) <= 1 && Math.abs(this.point.y) <= 1;
      this.screen[2 * i] = isSeen ? (0.5 + 0.5 * this.point.x) * this.width : NaN;
      this.screen[2 * i + 1] = (0.5 - 0.5 * this.point.y) * this.height;
      this.more[i] = 0;
      if (isSeen && this.styles[i].isName) this.placement.block(this.screen[2 * i] - 3, this.screen[2 * i + 1] - 3, 6, 6);
    }
  }

  private widthOf(text: string, isStrong: boolean): number {
    const widths = isStrong ? this.strongWidths : this.widths;
    const known = widths.get(text);
    if (known !== undefined) return known;
    if (widths.size > MOST_WIDTHS) widths.clear();
    this.context.font = isStrong ? this.strong : this.plain;
    const { width } = this.context.measureText(text);
    widths.set(text, width);
    return width;
  }

  /** A box of negative width marks a label for which there is no room. */
  private placeOne(i: number): void {
    const x = this.screen[2 * i];
    this.boxes[3 * i + 2] = 0;
    if (Number.isNaN(x)) return;
    const style = this.styles[i];
    const text = this.texts[i];
    const width = Math.ceil(this.widthOf(text, style.isStrong === true)) + DOT + 5;
    // A label keeps its place beside the point, so that labels do not jump while the run plays.
    const key = style.isName ? "" : text;
    let slots = this.slots.get(style);
    if (!slots) this.slots.set(style, (slots = new Map()));
    const slot = this.placement.place(x, this.screen[2 * i + 1], width, HEIGHT, slots.get(key) ?? -1, style.isMinor ? NEAR_SLOTS : SLOTS);
    if (slots.size > MOST_WIDTHS) slots.clear();
    slots.set(key, slot);
    this.boxes[3 * i] = this.placement.x;
    this.boxes[3 * i + 1] = this.placement.y;
    this.boxes[3 * i + 2] = slot < 0 ? -width : width;
  }

  /** "+2" beside the nearest label that has room. */
  private countLeft(i: number): void {
    if (!this.styles[i].isName) return;
    ++this.left;
    let nearest = -1;
    let least = Infinity;
    for (let k = 0; k < this.count; ++k) {
      if (this.boxes[3 * k + 2] <= 0 || !this.styles[k].isName) continue;
      const distance = Math.hypot(this.screen[2 * k] - this.screen[2 * i], this.screen[2 * k + 1] - this.screen[2 * i + 1]);
      if (distance >= least) continue;
      least = distance;
      nearest = k;
    }
    if (nearest >= 0) ++this.more[nearest];
  }

  private lead(i: number): void {
    const { context } = this;
    const [x, y] = [this.screen[2 * i], this.screen[2 * i + 1]];
    const endX = Math.max(this.boxes[3 * i], Math.min(x, this.boxes[3 * i] + this.boxes[3 * i + 2]));
    const endY = Math.max(this.boxes[3 * i + 1], Math.min(y, this.boxes[3 * i + 1] + HEIGHT));
    if (Math.hypot(endX - x, endY - y) < 13) return;
    context.strokeStyle = this.styles[i].colour;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(endX, endY);
    context.stroke();
  }

  private write(i: number): void {
    const { context } = this;
    const style = this.styles[i];
    const [x, y, width] = [this.boxes[3 * i], this.boxes[3 * i + 1], this.boxes[3 * i + 2]];
    context.globalAlpha = style.isStrong ? 0.95 : 0.72;
    context.fillStyle = this.paper;
    context.beginPath();
    context.roundRect(x, y, width, HEIGHT, 4);
    context.fill();
    context.globalAlpha = 1;
    if (style.isStrong) {
      context.strokeStyle = style.colour;
      context.lineWidth = 1.5;
      context.stroke();
    }
    context.fillStyle = style.colour;
    context.beginPath();
    context.arc(x + 7, y + HEIGHT / 2, 3.5, 0, 7);
    context.fill();
    context.font = style.isStrong ? this.strong : this.plain;
    context.textBaseline = "middle";
    context.fillStyle = this.ink;
    context.fillText(this.texts[i], x + DOT + 2, y + HEIGHT / 2 + 0.5);
    if (this.more[i] > 0) this.writeMore(x, y, width, this.more[i]);
  }

  private writeMore(x: number, y: number, width: number, count: number): void {
    const { context, placement } = this;
    if (placement.place(x + width / 2, y + HEIGHT / 2, MORE, HEIGHT, -1) < 0) return;
    context.font = this.strong;
    context.fillStyle = this.ink;
    context.fillText(`+${count}`, placement.x + 4, placement.y + HEIGHT / 2);
  }

  /** The entity of the label at a point, undefined if there is none. */
  at(pixelX: number, pixelY: number): number | undefined {
    const [x, y] = [pixelX / this.factor, pixelY / this.factor];
    for (let i = 0; i < this.count; ++i) {
      const [left, top, width] = [this.boxes[3 * i], this.boxes[3 * i + 1], this.boxes[3 * i + 2]];
      if (width > 0 && x >= left && x <= left + width && y >= top && y <= top + HEIGHT) return this.styles[i].entity;
    }
    return undefined;
  }

  /** What is drawn, for tests, in pixels. */
  get shown(): { text: string; entity: number; x: number; y: number; width: number; height: number }[] {
    const { factor } = this;
    const all = Array.from({ length: this.count }, (_, i) => ({
      text: this.texts[i], entity: this.styles[i].entity,
      x: factor * this.boxes[3 * i], y: factor * this.boxes[3 * i + 1], width: factor * this.boxes[3 * i + 2], height: factor * HEIGHT,
    }));
    return all.filter(({ width }) => width > 0);
  }
}
