// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The summary of a consistency report for print: what was found of each pose, NEES by part, and the figures.
import { isObject, type Json, type JsonObject, type Payload } from "../payload.ts";
import { element } from "../ui/dom.ts";
import { onPrint, printHeader, type PrintTable, printTable, sheetOf } from "../ui/print.ts";
import { loaded } from "./print_study.ts";
import { provenanceLines } from "./provenance.ts";

const PARTS = ["pose", "rotation", "position"] as const;
const MOST_POSES = 6;
const MOST_LINES = 24;
const MOST_PICTURES = 2;

const list = (value: Json | undefined): Json[] => (Array.isArray(value) ? value : []);

function table(poses: JsonObject[]): PrintTable {
  const rows = poses.flatMap((pose) => PARTS.flatMap((part): Json[][] => {
    const values = pose[part];
    if (!isObject(values)) return [];
    const [low, high] = list(values["band"]);
    return [[`${String(pose["name"] ?? "")}: ${part}`, values["anees"] ?? null, low ?? null, high ?? null, values["median"] ?? null, values["worst"] ?? null]];
  }));
  return { name: "NEES per degree of freedom (expected 1)", columns: ["", "mean", "band, low", "band, high", "median", "worst"], rows };
}

function findings(pose: JsonObject): HTMLElement[] {
  const words = list(pose["findings"]).map((text) => element("li", {}, String(text)));
  return words.length > 0 ? [element("h2", {}, String(pose["name"] ?? "")), element("ul", { class: "findings" }, ...words)] : [];
}

export function printConsistency(payload: Payload, subtitle: string, poses: JsonObject[]): void {
  const shown = loaded(payload.pictures, MOST_PICTURES);
  const left = Object.keys(payload.pictures).length - shown.length;
  const more = poses.length - MOST_POSES;
  onPrint(() => [
    sheetOf(printHeader(payload.title, [subtitle, ...provenanceLines(payload.documents)]), ...poses.slice(0, MOST_POSES).flatMap(findings),
      ...(more > 0 ? [element("p", { class: "hint" }, `${more} more poses are in the page.`)] : [])),
    sheetOf(printTable(table(poses), MOST_LINES), ...shown, ...(left > 0 ? [element("p", { class: "hint" }, `${left} more figures are in the page.`)] : [])),
  ]);
}
