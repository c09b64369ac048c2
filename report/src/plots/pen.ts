// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What draws on a canvas and into an SVG file alike, so that an exported plot is the plot and no screenshot.

export interface TextStyle {
  size?: number;
  align?: "start" | "middle" | "end";
  bold?: boolean;
  /** Degrees, about the text's own place. */
  turn?: number;
}

export interface Pen {
  rect(x: number, y: number, width: number, height: number, colour: string): void;
  /** A filled shape, its corners as x0, y0, x1, y1, ... */
  shape(points: ArrayLike<number>, colour: string): void;
  line(points: ArrayLike<number>, colour: string, width: number, dash?: number[]): void;
  text(text: string, x: number, y: number, colour: string, style?: TextStyle): void;
  widthOf(text: string, size?: number): number;
}

/** Where a plot is on the paper of a pen, and how its values are placed there. */
export interface Field {
  left: number;
  top: number;
  width: number;
  height: number;
  /** A pixel of the page in units of the pen. */
  pixel: number;
  x: (value: number) => number;
  y: (value: number) => number;
  /** The part of x that is shown. */
  range: [number, number];
}

export type Painter = (pen: Pen, field: Field) => void;

const FONT = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";

export class CanvasPen implements Pen {
  constructor(private readonly context: CanvasRenderingContext2D, private readonly pixel: number) {}

  rect(x: number, y: number, width: number, height: number, colour: string): void {
    if (this.context.fillStyle !== colour) this.context.fillStyle = colour;
    this.context.fillRect(x, y, width, height);
  }

  private path(points: ArrayLike<number>): void {
    this.context.beginPath();
    for (let i = 0; i < points.length; i += 2) this.context.lineTo(points[i], points[i + 1]);
  }

  shape(points: ArrayLike<number>, colour: string): void {
    this.path(points);
    this.context.fillStyle = colour;
    this.context.fill();
  }

  line(points: ArrayLike<number>, colour: string, width: number, dash: number[] = []): void {
    this.path(points);
    this.context.strokeStyle = colour;
    this.context.lineWidth = width;
    this.context.setLineDash(dash);
    this.context.stroke();
    this.context.setLineDash([]);
  }

  text(text: string, x: number, y: number, colour: string, { size = 11, align = "start", bold = false }: TextStyle = {}): void {
    this.context.font = `${bold ? "600 " : ""}${size * this.pixel}px ${FONT}`;
    this.context.textAlign = align === "middle" ? "center" : align;
    this.context.textBaseline = "middle";
    this.context.fillStyle = colour;
    this.context.fillText(text, x, y);
  }

  widthOf(text: string, size = 11): number {
    this.context.font = `${size * this.pixel}px ${FONT}`;
    return this.context.measureText(text).width;
  }
}

const number = (value: number) => String(Math.round(100 * value) / 100);
const ESCAPES: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" };

/** A text for XML; characters that XML does not allow are replaced. */
export function escaped(text: string): string {
  return text.replaceAll(/[&<>"]/g, (sign) => ESCAPES[sign]).replaceAll(/[^\t\n\r\u0020-\uD7FF\uE000-\uFFFD\u{10000}-\u{10FFFF}]/gu, "\uFFFD");
}

/** A colour with eight digits as a colour and an opacity, which more programs read. */
function paint(kind: "fill" | "stroke", colour: string): string {
  if (!/^#[0-9a-f]{8}$/i.test(colour)) return `${kind}="${escaped(colour)}"`;
  return `${kind}="${colour.slice(0, 7)}" ${kind}-opacity="${number(parseInt(colour.slice(7), 16) / 255)}"`;
}

export class SvgPen implements Pen {
  private readonly parts: string[] = [];

  rect(x: number, y: number, width: number, height: number, colour: string): void {
    this.parts.push(`<rect x="${number(x)}" y="${number(y)}" width="${number(width)}" height="${number(height)}" ${paint("fill", colour)}/>`);
  }

  private static points(points: ArrayLike<number>): string {
    return Array.from({ length: points.length / 2 }, (_, i) => `${number(points[2 * i])},${number(points[2 * i + 1])}`).join(" ");
  }

  shape(points: ArrayLike<number>, colour: string): void {
    if (points.length > 4) this.parts.push(`<polygon points="${SvgPen.points(points)}" ${paint("fill", colour)}/>`);
  }

  line(points: ArrayLike<number>, colour: string, width: number, dash: number[] = []): void {
    if (points.length < 4) return;
    const dashes = dash.length > 0 ? ` stroke-dasharray="${dash.map(number).join(" ")}"` : "";
    this.parts.push(`<polyline points="${SvgPen.points(points)}" fill="none" ${paint("stroke", colour)} stroke-width="${number(width)}" stroke-linejoin="round"${dashes}/>`);
  }

  text(text: string, x: number, y: number, colour: string, { size = 11, align = "start", bold = false, turn = 0 }: TextStyle = {}): void {
    const turned = turn === 0 ? "" : ` transform="rotate(${number(turn)} ${number(x)} ${number(y)})"`;
    this.parts.push(`<text x="${number(x)}" y="${number(y)}" dominant-baseline="central" text-anchor="${align}" font-size="${size}"${bold ? ' font-weight="600"' : ""} ${paint("fill", colour)}${turned}>${escaped(text)}</text>`);
  }

  /** An estimate, as there is no font to ask: most letters are narrower. */
  widthOf(text: string, size = 11): number {
    return 0.58 * size * text.length;
  }

  /** What is drawn between is cut at a rectangle. */
  clip(x: number, y: number, width: number, height: number, draw: () => void): void {
    this.parts.push(`<svg x="${number(x)}" y="${number(y)}" width="${number(width)}" height="${number(height)}" viewBox="${number(x)} ${number(y)} ${number(width)} ${number(height)}">`);
    draw();
    this.parts.push("</svg>");
  }

  document(width: number, height: number, title: string): string {
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${number(width)}" height="${number(height)}" viewBox="0 0 ${number(width)} ${number(height)}" font-family="${FONT}">\n<title>${escaped(title)}</title>\n${this.parts.join("\n")}\n</svg>\n`;
  }
}
