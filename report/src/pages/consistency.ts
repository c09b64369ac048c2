// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The consistency of estimates: what was found, NEES over time, tables.
import { isObject, type Json, type JsonObject, type Payload } from "../payload.ts";
import { explorer } from "../plots/explorer.ts";
import { parseCsv } from "../ui/csv.ts";
import { element } from "../ui/dom.ts";
import { table } from "../ui/table.ts";
import { type Tab, tabs } from "../ui/tabs.ts";
import { files } from "./files.ts";
import { footer, header, picture, publish } from "./page.ts";
import { printConsistency } from "./print_consistency.ts";

const list = (value: Json | undefined): Json[] => (Array.isArray(value) ? value : []);
const object = (value: Json | undefined): JsonObject => (isObject(value) ? value : {});

const PARTS = ["pose", "rotation", "position"] as const;
const SUMMARY = ["dof", "anees", "interval low", "interval high", "band low", "band high", "median", "worst", "within_frame_band"];

function summary(name: string, pose: JsonObject): HTMLElement {
  const known = PARTS.filter((part) => isObject(pose[part]));
  return table(`${name}: NEES per degree of freedom`, ["", ...SUMMARY], known.map((part) => {
    const values = object(pose[part]);
    const pick = (column: string): Json | undefined => {
      const [key, end] = column.split(" ");
      return end === undefined ? values[key] : list(values[key])[end === "low" ? 0 : 1];
    };
    return { name: part, cells: SUMMARY.map((column) => ({ value: pick(column), key: `${name}/${part}/${column}` })) };
  }));
}

const AXIS = ["mean_error", "rms_error", "rms_sd", "normalized_mean", "normalized_rms", "bias_significance"];

function axes(name: string, pose: JsonObject): HTMLElement {
  const columns = ["", ...AXIS, "in 1 sigma", "in 2 sigma", "in 3 sigma"];
  return table(`${name}: along each axis (rad and m; nominal shares 0.683, 0.954, 0.997)`, columns, list(pose["axes"]).map((entry) => {
    const axis = object(entry);
    const shares = list(object(axis["coverage"])["shares"]);
    return { name: String(axis["axis"]), cells: [...AXIS.map((key) => axis[key]), ...shares].map((value) => ({ value })) };
  }));
}

function findings(poses: JsonObject[]): HTMLElement {
  return element("div", { class: "pose-findings" }, ...poses.map((pose) => {
    const name = String(pose["name"] ?? "");
    const words = list(pose["findings"]).map((text) => element("li", {}, String(text)));
    return element("section", {}, element("h2", {}, name), element("ul", { class: "findings" }, ...words),
      element("div", { class: "tables" }, summary(name, pose), axes(name, pose)));
  }));
}

export function consistencyPage(payload: Payload): HTMLElement {
  const document = object(payload.documents["consistency.json"]);
  const poses = list(document["poses"]).filter(isObject);
  const made: Tab[] = [{ name: "Findings", build: () => findings(poses) }];
  const pictures = Object.entries(payload.pictures);
  if (pictures.length > 0) {
    made.push({ name: "Figures", build: () => element("div", { class: "pictures" }, ...pictures.map(([name, svg]) => picture(name, svg))) });
  }
  const frames = payload.tables["consistency.csv"];
  if (frames !== undefined) {
    const chart = () => explorer(parseCsv(frames), { x: "stamp_s", y: "nees_per_dof", by: "pose" });
    made.push({ name: "Charts", build: () => chart() ?? element("p", { class: "notice" }, "There are no frames to draw.") });
  }
  const rest = files(payload);
  if (rest.length > 0) made.push({ name: "Files", build: () => element("div", {}, ...rest) });
  publish({ kind: "consistency", poses: poses.map((pose) => String(pose["name"] ?? "")), pictures: pictures.length });
  const aligned = document["alignment"] === "none" ? "" : `, aligned (${String(document["alignment"])})`;
  const subtitle = `Consistency of estimates${aligned}`;
  printConsistency(payload, subtitle, poses);
  return element("div", { class: "page" }, header(payload, subtitle), element("main", {}, tabs("Consistency", made).node), footer(payload));
}
