// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Where a result comes from: program, version, command, seed, settings, inputs and date.
import { isObject, type Json, type JsonObject } from "../payload.ts";
import { element } from "../ui/dom.ts";

const DOCUMENTS = ["metrics.json", "study.json", "consistency.json"];

/** What the folder's documents say of their making; undefined if nothing. */
export function provenanceOf(documents: JsonObject): JsonObject | undefined {
  for (const name of DOCUMENTS) {
    const document = documents[name];
    if (isObject(document) && isObject(document["provenance"])) return document["provenance"];
  }
  return undefined;
}

function dateText(value: Json | undefined): string | undefined {
  if (typeof value !== "string") return undefined;
  const date = new Date(value);
  return Number.isNaN(date.getTime()) ? undefined : `${date.toISOString().slice(0, 16).replace("T", " ")} UTC`;
}

/** The facts in one line: version, seed, date. */
export function factsOf(provenance: JsonObject): string[] {
  const { program, version, seed, started } = provenance;
  const maker = [program, version].filter((one) => typeof one === "string" && one !== "").join(" ");
  const date = dateText(started);
  return [...(maker ? [maker] : []), ...(typeof seed === "number" || typeof seed === "string" ? [`seed ${seed}`] : []), ...(date ? [date] : [])];
}

/** The command as a reader may type it: arguments with blanks are quoted. */
export function commandOf({ command }: JsonObject): string {
  if (typeof command === "string") return command;
  const parts = Array.isArray(command) ? command.map(String) : [];
  return parts.map((part) => (/^[\w@%+=:,./-]+$/.test(part) ? part : `'${part.replaceAll("'", "'\\''")}'`)).join(" ");
}

/** Settings by their path: "camera.frames". */
export function settingsOf(value: Json | undefined, path = ""): [string, string][] {
  if (!isObject(value)) return path === "" ? [] : [[path, typeof value === "string" ? value : JSON.stringify(value ?? null)]];
  return Object.entries(value).flatMap(([key, inner]) => settingsOf(inner, path === "" ? key : `${path}.${key}`));
}

function inputsOf({ inputs }: JsonObject): [string, string][] {
  return (Array.isArray(inputs) ? inputs : []).filter(isObject).map((input) => [String(input["path"] ?? ""), String(input["sha256"] ?? "")]);
}

const list = (entries: [string, string][], name: string) =>
  element("dl", { class: "settings", "aria-label": name }, ...entries.map(([key, value]) => element("div", {}, element("dt", {}, key), element("dd", {}, value))));

/** One line of facts, and folded below it the command, the settings and the inputs. */
export function provenanceNode(documents: JsonObject): HTMLElement | undefined {
  const provenance = provenanceOf(documents);
  if (!provenance) return undefined;
  const command = commandOf(provenance);
  const settings = settingsOf(provenance["settings"]);
  const inputs = inputsOf(provenance);
  const facts = factsOf(provenance).join(" · ");
  if (command === "" && settings.length === 0 && inputs.length === 0) return element("p", { class: "subtitle provenance" }, facts);
  return element("details", { class: "provenance" }, element("summary", {}, facts || "Settings"),
    ...(command ? [element("pre", { class: "command", tabindex: 0, "aria-label": "Command" }, command)] : []),
    ...(settings.length > 0 ? [list(settings, "Settings")] : []),
    ...(inputs.length > 0 ? [list(inputs, "Inputs and their SHA-256")] : []));
}

/** What is longer ends with an ellipsis after a whole word. */
export function cut(text: string, most: number): string {
  return text.length <= most ? text : `${text.slice(0, most - 1).replace(/\s+\S*$/, "")} …`;
}

/** So many letters of settings are printed, each of which is whole; tables of their own, such as noise, are in the page. */
const MOST_PRINTED = 240;
const MOST_OF_ONE = 60;

function printed(settings: string[]): string[] {
  const shown: string[] = [];
  let length = 0;
  for (const text of settings) {
    if (text.length > MOST_OF_ONE || length + text.length > MOST_PRINTED) continue;
    shown.push(text);
    length += text.length + 2;
  }
  const left = settings.length - shown.length;
  if (shown.length === 0) return [];
  return [`${shown.join("; ")}${left > 0 ? `; and ${left} more in the page` : ""}`];
}

/** The same as plain lines, for print. */
export function provenanceLines(documents: JsonObject): string[] {
  const provenance = provenanceOf(documents);
  if (!provenance) return [];
  const command = commandOf(provenance);
  const settings = settingsOf(provenance["settings"]).map(([key, value]) => `${key} = ${value}`);
  return [factsOf(provenance).join(" · "), ...(command ? [cut(command, MOST_PRINTED)] : []), ...printed(settings)];
}
