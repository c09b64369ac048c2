// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The scene as an image to keep: with labels, scale, and a legend below.
import { element } from "../ui/dom.ts";
import { themeColour } from "../ui/theme.ts";
import { legendLines } from "./picture_text.ts";
import type { Viewport } from "./viewport.ts";

export interface LegendEntry {
  text: string;
  colour: string;
}

const FONT = 13;
const LINE = 22;
const MARGIN = 12;

/** Draws the scene anew and copies it, since a browser may forget what is not drawn in the same turn. */
export function composePicture(viewport: Viewport, title: string, legend: readonly LegendEntry[]): HTMLCanvasElement {
  viewport.draw();
  const source = viewport.canvas;
  const ratio = source.width / viewport.node.clientWidth;
  const made = element("canvas");
  const context = made.getContext("2d")!;
  const font = `${FONT}px system-ui, sans-serif`;
  const most = viewport.node.clientWidth - 2 * MARGIN;
  context.font = font;
  const widths = legend.map(({ text }) => Math.min(most, context.measureText(text).width + 34));
  const lines = legendLines(widths, most);
  const height = viewport.node.clientHeight + LINE * (1 + lines.length) + MARGIN;
  made.width = source.width;
  made.height = Math.round(ratio * height);
  context.scale(ratio, ratio);
  context.fillStyle = themeColour("--panel");
  context.fillRect(0, 0, viewport.node.clientWidth, height);
  context.drawImage(source, 0, 0, viewport.node.clientWidth, viewport.node.clientHeight);
  context.drawImage(viewport.labels.canvas, 0, 0, viewport.node.clientWidth, viewport.node.clientHeight);
  context.textBaseline = "middle";
  let y = viewport.node.clientHeight + LINE / 2 + 4;
  context.font = `600 ${font}`;
  context.fillStyle = themeColour("--ink");
  context.fillText(title, MARGIN, y, most);
  context.font = font;
  for (const line of lines) {
    y += LINE;
    let x = MARGIN;
    for (const i of line) {
      context.fillStyle = legend[i].colour;
      context.fillRect(x, y - 5, 12, 10);
      context.fillStyle = themeColour("--ink");
      context.fillText(legend[i].text, x + 18, y, widths[i] - 20);
      x += widths[i];
    }
  }
  return made;
}

/** Gives a picture to the reader as a file. */
export function savePicture(canvas: HTMLCanvasElement, name: string): void {
  canvas.toBlob((blob) => {
    if (!blob) return;
    const address = URL.createObjectURL(blob);
    element("a", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
  }, "image/png");
}
