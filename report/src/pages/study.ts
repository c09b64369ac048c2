// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A study: what it found, its charts, tables and figures.
import { isObject, type JsonObject, type Payload } from "../payload.ts";
import { explorer } from "../plots/explorer.ts";
import type { Choice } from "../study/aggregate.ts";
import { questionOf, storyOf, type Tables } from "../study/stories.ts";
import { choice, element } from "../ui/dom.ts";
import { DataTable } from "../ui/data_table.ts";
import { type Tab, tabs } from "../ui/tabs.ts";
import { parseCsv, type Table, tableOfRows } from "../ui/csv.ts";
import { figures } from "./figures.ts";
import { files } from "./files.ts";
import { footer, header, publish } from "./page.ts";
import { printStudy } from "./print_study.ts";

/** The table and columns that a study's chart begins with. */
const FIRST: Readonly<Record<string, Partial<Choice> & { table?: string }>> = {
  divergence: { x: "phi_deg", y: "kl", by: "rule" },
  "monte-carlo": { x: "noise_exponent", y: "robot_rotation_rmse_deg", by: "method" },
  noise: { x: "object", y: "robust_sd", by: "axis" },
  grasp: { x: "method", y: "brier", by: "gripper" },
  ycbv: { x: "method", y: "pixel_median", by: "detector", reduce: "median" },
  tless: { x: "object", y: "rotation_deg", by: "symmetries", reduce: "median" },
  "fuse-views": { x: "input", y: "fused_within_20deg_5cm", by: "noise" },
  fiducials: { x: "recording", y: "camera_rms_m", by: "input" },
  consistency: { x: "cell", y: "relative_anees", by: "" },
  "salt-box": { x: "stage", y: "rotation_std_deg", by: "" },
};

export function studyName(payload: Payload): string {
  const document = payload.documents["study.json"];
  return isObject(document) ? String((document as JsonObject)["study"] ?? "") : "";
}

/** The columns that the chart of a study begins with. */
export function firstColumns(study: string): Partial<Choice> {
  return Object.hasOwn(FIRST, study) ? FIRST[study] : {};
}

/** The rows of study.json, its summary, and the CSV files with other content. */
export function studyTables(payload: Payload): Record<string, Table> {
  const document = payload.documents["study.json"];
  const found: Record<string, Table> = {};
  if (isObject(document)) {
    if (document["summary"] !== undefined) found["summary"] = tableOfRows(document["summary"]);
    if (document["rows"] !== undefined) found["rows"] = tableOfRows(document["rows"]);
  }
  for (const [name, text] of Object.entries(payload.tables)) {
    const table = parseCsv(text);
    const same = Object.values(found).some((one) => one.rows.length === table.rows.length && one.columns.join() === table.columns.join());
    if (!same) found[name] = table;
  }
  return Object.fromEntries(Object.entries(found).filter(([, table]) => table.columns.length > 0));
}

/** What was found, in sentences; nothing where the tables are of no known study. */
export function storyNode(study: string, found: Tables): HTMLElement[] {
  const sentences = storyOf(study, found);
  if (sentences.length === 0) return [];
  return [element("section", { class: "story", "aria-label": "Result" }, ...sentences.map((text) => element("p", {}, text)))];
}

function charts(found: Record<string, Table>, preferred: Partial<Choice>): HTMLElement {
  const place = element("div");
  const show = (name: string) =>
    place.replaceChildren(explorer(found[name], preferred) ?? element("p", { class: "notice" }, "This table has no numbers to draw."));
  const names = Object.keys(found);
  const first = found["rows"] ? "rows" : names[0];
  show(first);
  return element("div", {}, choice("Table", names.map((name) => [name, name] as const), first, show), place);
}

export function tablesNode(found: Record<string, Table>): HTMLElement {
  return element("div", { class: "tables" }, ...Object.entries(found).map(([name, table]) => new DataTable(name, table).node));
}

/** Who comes back from the page of a run finds the tab that was left. */
function studyTabs(list: Tab[]): HTMLElement {
  const state: unknown = history.state;
  const made = tabs("Study", list, (tab) => history.replaceState({ tab }, ""));
  if (typeof state === "object" && state !== null && "tab" in state && typeof state.tab === "string") made.show(state.tab);
  return made.node;
}

export function studyPage(payload: Payload): HTMLElement {
  const study = studyName(payload);
  const found = studyTables(payload);
  const list: Tab[] = [];
  const pictures = Object.keys(payload.pictures);
  const hasTables = Object.keys(found).length > 0;
  if (hasTables) list.push({ name: "Charts", build: () => charts(found, firstColumns(study)) });
  if (hasTables) list.push({ name: "Tables", build: () => tablesNode(found) });
  if (pictures.length > 0) list.push({ name: "Figures", build: () => figures(payload.pictures) });
  const texts = files({ ...payload, tables: {} });
  if (texts.length > 0) list.push({ name: "Texts", build: () => element("div", {}, ...texts) });
  publish({ kind: "study", study, pictures: pictures.length, tables: Object.keys(found) });
  printStudy(payload, study, found);
  const body = list.length > 0 ? studyTabs(list) : element("p", { class: "notice" }, "The folder has no figures and no tables.");
  return element("div", { class: "page study" }, header(payload, questionOf(study)),
    element("main", {}, ...storyNode(study, found), body), footer(payload));
}
