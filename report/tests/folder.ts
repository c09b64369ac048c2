// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A report of a results folder, without the program.
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import type { JsonObject, Kind } from "../src/payload.ts";
import { packTrace, type TraceJson } from "./pack.ts";

function kindOf(names: string[], documents: JsonObject): Kind {
  if (names.includes("trace.json")) return "slam";
  const study = documents["study.json"] as JsonObject | undefined;
  if (study) return study["study"] === "salt-box" ? "salt_box" : "study";
  return documents["consistency.json"] ? "consistency" : "mixture";
}

export function payloadOfFolder(folder: string): JsonObject {
  const names = readdirSync(folder).sort();
  const read = (name: string) => readFileSync(path.join(folder, name), "utf8");
  const texts = (end: string) => Object.fromEntries(names.filter((n) => n.endsWith(end)).map((n) => [n, read(n)]));
  const documents: JsonObject = {};
  for (const name of names) if (name.endsWith(".json") && name !== "trace.json") documents[name] = JSON.parse(read(name));
  const trace = names.includes("trace.json") ? packTrace(JSON.parse(read("trace.json")) as TraceJson) : undefined;
  return {
    schema: 1,
    type: "posemix.report",
    kind: kindOf(names, documents),
    title: trace ? trace.name : path.basename(folder),
    program: "posemix 0.1.0",
    documents,
    tables: texts(".csv"),
    pictures: texts(".svg"),
    texts: texts(".md"),
    ...(trace ? { trace: trace as unknown as JsonObject } : {}),
  };
}

/** The page with a payload in it. */
export function fill(template: string, payload: unknown): string {
  const json = JSON.stringify(payload).replaceAll("<", "\\u003c");
  return template.replace("@POSEMIX_REPORT@", () => json);
}
