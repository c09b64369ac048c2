// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What is printed is not the page but a summary of it, made when it is printed: in light colours, on two sheets, without controls.
import type { Json } from "../payload.ts";
import type { Viewport } from "../scene/viewport.ts";
import { decimalsOf } from "./data_table.ts";
import { element } from "./dom.ts";
import { formatted, titleOf } from "./format.ts";
import { forceTheme } from "./theme.ts";

let sheet: HTMLElement | undefined;

/** Sets what is printed. The sheets are made before print and removed after it. */
export function onPrint(build: () => Node[]): void {
  const open = () => {
    if (sheet) return;
    forceTheme("light");
    sheet = element("div", { class: "print-sheet" }, ...build());
    document.body.append(sheet);
    document.documentElement.dataset["printing"] = "true";
  };
  const close = () => {
    sheet?.remove();
    sheet = undefined;
    delete document.documentElement.dataset["printing"];
    forceTheme(undefined);
  };
  addEventListener("beforeprint", open);
  addEventListener("afterprint", close);
}

/** One sheet of paper. */
export function sheetOf(...parts: Node[]): HTMLElement {
  return element("section", { class: "print-page" }, ...parts);
}

export function printHeader(title: string, lines: string[]): HTMLElement {
  return element("header", { class: "print-head" }, element("h1", {}, title), ...lines.filter((text) => text !== "").map((text) => element("p", {}, text)));
}

/** The scene as it is seen now, with its labels; nothing where it cannot be drawn. */
export function scenePicture(viewport: Viewport | undefined, text: string): HTMLElement[] {
  if (!viewport) return [];
  viewport.draw();
  const canvases = [...viewport.node.querySelectorAll("canvas")].filter(({ width, height }) => width > 0 && height > 0);
  if (canvases.length === 0) return [];
  const { width, height } = canvases[0];
  const made = element("canvas", { width, height, role: "img", "aria-label": text });
  const context = made.getContext("2d");
  for (const canvas of canvases) context?.drawImage(canvas, 0, 0, width, height);
  return [element("figure", { class: "print-scene" }, made, element("figcaption", {}, text))];
}

/** Parts of the page that are marked for print, without their controls; canvases are copied, since copies of the page's are empty. */
export function markedForPrint(): Node[] {
  return [...document.querySelectorAll<HTMLElement>("#app [data-print]")].map((node) => {
    const copy = node.cloneNode(true) as HTMLElement;
    const from = node.querySelectorAll("canvas");
    copy.querySelectorAll("canvas").forEach((canvas, i) => canvas.getContext("2d")?.drawImage(from[i], 0, 0));
    for (const control of copy.querySelectorAll("button, input, select, .controls")) {
      if (control.tagName === "BUTTON") control.replaceWith(document.createTextNode(control.textContent ?? ""));
      else control.remove();
    }
    for (const one of [copy, ...copy.querySelectorAll("[id]")]) one.removeAttribute("id");
    return copy;
  });
}

export interface PrintTable {
  name: string;
  columns: string[];
  rows: Json[][];
}

const MOST_LETTERS = 92;

/** The columns of each part of a table that is too wide for the paper; every part begins with the first column. */
function partsOf({ columns, rows }: PrintTable): number[][] {
  const width = (k: number) => Math.max(4, ...rows.slice(0, 50).map((row) => formatted(row[k]).length), Math.min(12, titleOf(columns[k]).name.length)) + 2;
  const parts: number[][] = [[]];
  let used = width(0);
  for (let k = 1; k < columns.length; ++k) {
    if (used + width(k) > MOST_LETTERS && parts[parts.length - 1].length > 0) {
      parts.push([]);
      used = width(0);
    }
    parts[parts.length - 1].push(k);
    used += width(k);
  }
  return parts;
}

/** A table that fits the paper: columns go on below, rows beyond the number of lines are counted. */
export function printTable(table: PrintTable, mostLines: number, mostParts = 3): HTMLElement {
  const { name, columns, rows } = table;
  const parts = partsOf(table);
  const shown = rows.slice(0, Math.max(4, Math.floor(mostLines / Math.min(parts.length, mostParts))));
  const left = parts.slice(mostParts).flat().length;
  const title = (k: number) => {
    const { name: words, unit } = titleOf(columns[k]);
    return unit ? `${words} [${unit}]` : words;
  };
  const numeric = columns.map((_, k) => rows.some((row) => typeof row[k] === "number") && rows.every((row) => row[k] === null || typeof row[k] === "number"));
  const decimals = columns.map((_, k) => (numeric[k] ? decimalsOf(rows.map((row) => row[k] ?? null)) : undefined));
  const written = (value: Json | undefined, k: number) => (typeof value === "number" && decimals[k] !== undefined ? value.toFixed(decimals[k]) : formatted(value));
  const align = (k: number) => ({ class: numeric[k] ? "number" : "" });
  const made = parts.slice(0, mostParts).map((part) => element("table", {},
    element("thead", {}, element("tr", {}, ...[0, ...part].map((k) => element("th", { scope: "col", ...align(k) }, title(k))))),
    element("tbody", {}, ...shown.map((row) => element("tr", {}, ...[0, ...part].map((k) =>
      element(k === 0 ? "th" : "td", align(k), written(row[k], k))))))));
  const omitted = [
    ...(shown.length < rows.length ? [`${shown.length} of ${rows.length} rows`] : []), ...(left > 0 ? [`${columns.length - left} of ${columns.length} columns`] : []),
  ];
  return element("div", { class: "print-table" }, element("h2", {}, omitted.length > 0 ? `${name} (${omitted.join(", ")})` : name), ...made);
}
