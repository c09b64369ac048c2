// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { isObject, type JsonObject, type Payload } from "../payload.ts";
import { explorer } from "../plots/explorer.ts";
import type { Choice } from "../plots/pivot.ts";
import { choice, element } from "../ui/dom.ts";
import { type Tab, tabs } from "../ui/tabs.ts";
import { parseCsv, type Table, tableOfRows } from "../ui/csv.ts";
import { files, tableNode } from "./files.ts";
import { footer, header, picture, publish } from "./page.ts";

/** The initial columns of the chart of a study's table. */
const FIRST: Readonly<Record<string, Partial<Choice>>> = {
  divergence: { x: "phi_deg", y: "kl", by: "rule" },
  "monte-carlo": { x: "noise_exponent", y: "robot_rotation_rmse_deg", by: "method" },
  noise: { x: "axis", y: "robust_sd", by: "object" },
  grasp: { x: "object", y: "brier", by: "method" },
  ycbv: { x: "sequence", y: "relative_rotation_rmse_deg", by: "method" },
  tless: { x: "object", y: "rotation_deg", by: "symmetries" },
};

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

function charts(found: Record<string, Table>, preferred: Partial<Choice>): HTMLElement {
  const place = element("div");
  const show = (name: string) =>
    place.replaceChildren(explorer(found[name], preferred) ?? element("p", { class: "notice" }, "This table has no numbers to draw."));
  const names = Object.keys(found);
  const first = found["rows"] ? "rows" : names[0];
  show(first);
  return element("div", {}, choice("Table", names.map((name) => [name, name] as const), first, show), place);
}

export function studyPage(payload: Payload): HTMLElement {
  const document = payload.documents["study.json"];
  const study = isObject(document) ? String((document as JsonObject)["study"] ?? "") : "";
  const found = studyTables(payload);
  const list: Tab[] = [];
  const pictures = Object.entries(payload.pictures);
  if (pictures.length > 0) {
    list.push({ name: "Figures", build: () => element("div", { class: "pictures" }, ...pictures.map(([name, svg]) => picture(name, svg))) });
  }
  if (Object.keys(found).length > 0) {
    list.push({ name: "Charts", build: () => charts(found, FIRST[study] ?? {}) });
    list.push({ name: "Tables", build: () => element("div", { class: "tables" }, ...Object.entries(found).map(([name, table]) => tableNode(name, table))) });
  }
  const texts = files({ ...payload, tables: {} });
  if (texts.length > 0) list.push({ name: "Texts", build: () => element("div", {}, ...texts) });
  publish({ kind: "study", study, pictures: pictures.length, tables: Object.keys(found) });
  const body = list.length > 0 ? tabs("Study", list) : element("p", { class: "notice" }, "The folder has no figures and no tables.");
  return element("div", { class: "page" }, header(payload, study ? `Study ${study}` : "Study"), element("main", {}, body), footer(payload));
}
