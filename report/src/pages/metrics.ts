// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The numbers of metrics.json, with units.
import { isObject, type Json, type JsonObject } from "../payload.ts";
import { element } from "../ui/dom.ts";
import { table } from "../ui/table.ts";

const leaf = (value: Json) => !isObject(value);

/** The numbers of an object by their path, `a/b/c`. */
function flat(value: JsonObject): JsonObject {
  return Object.fromEntries(
    Object.entries(value).flatMap(([key, inner]): [string, Json][] =>
      isObject(inner) ? Object.entries(flat(inner)).map(([path, number]) => [`${key}/${path}`, number]) : [[key, inner]]),
  );
}

/** A table with a row per entry; if entries are objects, the paths of their numbers are the columns. */
function section(name: string, value: JsonObject): HTMLElement[] {
  const entries = Object.entries(value).map(([key, inner]): [string, Json] => [key, isObject(inner) ? flat(inner) : inner]);
  const nested = entries.filter((entry): entry is [string, JsonObject] => isObject(entry[1]));
  const made: HTMLElement[] = [];
  const single = entries.filter(([, inner]) => leaf(inner));
  if (single.length > 0) {
    made.push(table(name, ["", ...single.map(([key]) => key)], [
      { name, cells: single.map(([key, inner]) => ({ value: inner, key: `${name}/${key}` })) },
    ]));
  }
  if (nested.length > 0) {
    const columns = [...new Set(nested.flatMap(([, inner]) => Object.keys(inner)))];
    made.push(table(name, ["", ...columns], nested.map(([row, inner]) => ({
      name: row,
      cells: columns.map((key) => ({ value: inner[key], key: `${name}/${row}/${key}` })),
    }))));
  }
  return made;
}

/** {quantity: {object: number}} transposed, so that every table has a row per object. */
function byObject(value: JsonObject, objects: Json | undefined): JsonObject {
  const ids = isObject(objects) ? Object.keys(objects) : [];
  const quantities = Object.entries(value);
  const turned = quantities.every(([, inner]) => isObject(inner) && Object.keys(inner).every((id) => ids.includes(id)));
  if (!turned || value === objects) return value;
  return Object.fromEntries(
    ids.map((id) => [id, Object.fromEntries(quantities.map(([name, inner]) => [name, (inner as JsonObject)[id] ?? null]))]),
  );
}

export function metrics(document: Json | undefined): HTMLElement {
  if (!isObject(document)) return element("p", { class: "notice" }, "The folder has no metrics.json.");
  const node = element("div", { class: "tables", id: "metrics" });
  const top: JsonObject = {};
  for (const [key, value] of Object.entries(document)) {
    if (isObject(value)) node.append(...section(key, byObject(value, document["objects"])));
    else if (key !== "schema") top[key] = value;
  }
  node.prepend(...section("run", top));
  node.append(element("p", { class: "hint" }, "Root mean squares over the frames with both an estimate and ground truth. A dash marks a missing value."));
  return node;
}
