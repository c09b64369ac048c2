// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The data that the program writes into the page.

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonObject = { [key: string]: Json };

export const KINDS = ["slam", "mixture", "salt_box", "study", "consistency", "comparison"] as const;
export type Kind = (typeof KINDS)[number];

export interface ColumnHead {
  name: string;
  width: number;
  type: "uint8" | "uint16" | "int16" | "int32";
  scale: number;
  map: "linear" | "exp";
  /** Whether the differences are stored with their sign in the lowest bit. */
  fold?: boolean;
}

export interface PackedTrace {
  name: string;
  method: string;
  order: string[];
  frames: number;
  stamps_s: number[];
  statuses?: string[];
  /** Words of the health of tracks. */
  healths?: string[];
  /** Names of the models of motion of the objects that move, by id. */
  models?: Record<string, string[]>;
  columns: ColumnHead[];
  data: string;
  /** Of the camera, as scene/lens.ts reads them. */
  intrinsics?: Json;
}

export interface PackedMesh {
  vertices: string;
  triangles: string;
}

/** One run of a comparison. */
export interface PackedRun {
  name: string;
  trace: PackedTrace;
  documents: JsonObject;
  /** The run's own page, as a path relative to this one. */
  report?: string;
}

export interface Payload {
  schema: 1;
  type: "posemix.report";
  kind: Kind;
  title: string;
  program: string;
  documents: JsonObject;
  tables: Record<string, string>;
  pictures: Record<string, string>;
  texts: Record<string, string>;
  meshes: Record<string, PackedMesh>;
  trace?: PackedTrace;
  /** Of the camera, as scene/images.ts reads them. */
  images?: Json;
  /** Of a comparison. */
  runs?: PackedRun[];
}

/** A payload that this page cannot show; the message is shown to the reader. */
export class BadPayload extends Error {}

export function isObject(value: unknown): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function textMap(value: unknown, key: string): Record<string, string> {
  if (value === undefined) return {};
  if (!isObject(value) || Object.values(value).some((text) => typeof text !== "string")) {
    throw new BadPayload(`"${key}" must be an object of texts.`);
  }
  return value as Record<string, string>;
}

function trace(value: unknown): PackedTrace {
  if (!isObject(value)) throw new BadPayload('A report of kind "slam" needs a "trace".');
  const frames = value["frames"];
  const stamps = value["stamps_s"];
  if (typeof frames !== "number" || !Number.isInteger(frames) || frames < 1) {
    throw new BadPayload('"trace.frames" must be a whole number of at least one.');
  }
  if (!Array.isArray(stamps) || stamps.length !== frames) {
    throw new BadPayload(`"trace.stamps_s" must hold ${frames} numbers, one per frame.`);
  }
  if (!Array.isArray(value["order"]) || !Array.isArray(value["columns"])) {
    throw new BadPayload('"trace.order" and "trace.columns" must be lists.');
  }
  if (typeof value["data"] !== "string") throw new BadPayload('"trace.data" must be a text.');
  return value as unknown as PackedTrace;
}

function packedRuns(value: unknown): PackedRun[] {
  if (!Array.isArray(value) || value.length < 2) throw new BadPayload('A report of kind "comparison" needs "runs", two or more.');
  return value.map((run: unknown, i) => {
    if (!isObject(run)) throw new BadPayload(`"runs[${i}]" must be an object.`);
    const { name, documents, report } = run;
    return {
      name: typeof name === "string" && name !== "" ? name : `run ${i + 1}`,
      trace: trace(run["trace"]),
      documents: isObject(documents) ? documents : {},
      ...(typeof report === "string" ? { report } : {}),
    };
  });
}

/** Checks the data in the page. */
export function readPayload(text: string): Payload {
  if (text.trim() === "" || text.trim().startsWith("@")) {
    throw new BadPayload("This is the empty template of a report. `posemix report DIR` fills it.");
  }
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw new BadPayload(`The report's data are not valid JSON: ${(error as Error).message}`);
  }
  if (!isObject(value) || value["type"] !== "posemix.report") {
    throw new BadPayload('The report\'s data are not of type "posemix.report".');
  }
  if (value["schema"] !== 1) {
    throw new BadPayload(`The report's data have schema ${String(value["schema"])}; this page reads schema 1.`);
  }
  const kind = KINDS.find((name) => name === value["kind"]);
  if (kind === undefined) {
    throw new BadPayload(`The report is of kind "${String(value["kind"])}"; this page knows ${KINDS.join(", ")}.`);
  }
  const documents = value["documents"] ?? {};
  if (!isObject(documents)) throw new BadPayload('"documents" must be an object.');
  const meshes = value["meshes"] ?? {};
  if (!isObject(meshes)) throw new BadPayload('"meshes" must be an object.');
  return {
    schema: 1,
    type: "posemix.report",
    kind,
    title: String(value["title"] ?? "posemix"),
    program: String(value["program"] ?? ""),
    documents,
    tables: textMap(value["tables"], "tables"),
    pictures: textMap(value["pictures"], "pictures"),
    texts: textMap(value["texts"], "texts"),
    meshes: meshes as unknown as Record<string, PackedMesh>,
    ...(kind === "slam" ? { trace: trace(value["trace"]) } : {}),
    ...(value["images"] !== undefined ? { images: value["images"] } : {}),
    ...(kind === "comparison" ? { runs: packedRuns(value["runs"]) } : {}),
  };
}
