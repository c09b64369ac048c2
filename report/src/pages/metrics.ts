// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The numbers of metrics.json by theme, in few units and with words for all of them.
import { isObject, type Json, type JsonObject } from "../payload.ts";
import { element } from "../ui/dom.ts";
import { formatted, titleOf } from "../ui/format.ts";
import { decimalsOf, fixed } from "../ui/numbers.ts";
import { HELP_WORDS, STATUS_WORDS, type Word, wordOf } from "./words.ts";

/** A number of the document by its path. */
type Numbers = Map<string, Json>;

interface Theme {
  title: string;
  note?: string;
  /** Whether it takes a quantity of a section; the first theme that does has it. */
  takes: (section: string, quantity: string) => boolean;
}

const ends = (...keys: string[]) => (_: string, quantity: string) => keys.includes(quantity);

const isPaired = (quantity: string) => quantity.startsWith("paired/");

const OBJECT_THEMES: readonly Theme[] = [
  { title: "Objects in the world", note: "Estimate against ground truth.", takes: ends("position_rmse_m", "rotation_rmse_deg") },
  { title: "Objects as seen from the camera", note: "Filter and detector, each over all of its own frames.", takes: (_, quantity) => /^(detection_)?relative_(position|rotation)_rmse/.test(quantity) },
  { title: "Filter and detector over the same frames", takes: (_, quantity) => isPaired(quantity) },
  { title: "Detections and modes", takes: ends("detections", "gated", "unexplained", "right_mode_share", "mode_probability", "existence", "health") },
  { title: "Share of the frames in every state of the track", takes: (_, quantity) => quantity.startsWith("health_shares/") },
];
const TITLES: Readonly<Record<string, string>> = {
  consistency: "Consistency as seen from the camera", relative_consistency: "Consistency as seen from the camera, by part",
  world_consistency: "Consistency in the world", timing: "Work per frame",
};

/** Keys of the section on consistency that have a table of their own, and what stands first in it. */
const VERDICTS: ReadonlySet<string> = new Set(["camera_verdict", "relative_verdicts"]);
const VERDICT_COLUMNS = ["verdict", "anees", "interval", "effective_frames", "reason"];

/** The numbers below a value by their path, `a/b/c`. */
function flat(value: Json, path: string, out: Numbers = new Map()): Numbers {
  if (isObject(value)) for (const [key, inner] of Object.entries(value)) flat(inner, path === "" ? key : `${path}/${key}`, out);
  else out.set(path, value);
  return out;
}

interface Column {
  quantity: string;
  word: Word;
}

function columnOf(quantity: string, isOlder = false): Column {
  const known = wordOf(quantity, isOlder);
  if (known) return { quantity, word: known };
  if (quantity.startsWith("health_shares/")) return { quantity, word: { name: quantity.slice(14), unit: "%", scale: 100, text: "Share of the frames." } };
  const { name, unit } = titleOf(quantity);
  return { quantity, word: { name, unit, text: "" } };
}

interface Cell {
  path: string;
  value: Json | undefined;
}

interface Row {
  name: string;
  /** The name of the object or camera that it is of; a word such as "filter" may be one, too. */
  entity?: string;
  cells: Cell[];
}

/** Words of the quantities that are shown. */
type Used = Map<string, Word>;

const isNumbers = (value: Json | undefined): value is number[] => Array.isArray(value) && value.length > 0 && value.every((one) => typeof one === "number");

/** A table with aligned decimals; undefined where it would be one of dashes. */
function numberTable(caption: string, note: string | undefined, columns: Column[], rows: Row[], used: Used): HTMLElement | undefined {
  const isShown = columns.map((_, k) => rows.some(({ cells }) => cells[k].value !== null && cells[k].value !== undefined));
  if (!isShown.includes(true)) return undefined;
  const keep = <T>(list: T[]) => list.filter((_, k) => isShown[k]);
  const shown = keep(columns);
  const isCount = (column: Column) => rows.every(({ cells }) => Number.isInteger(cells[columns.indexOf(column)].value ?? 0));
  const isWords = (k: number) => rows.some(({ cells }) => typeof cells[k].value === "string");
  const scaled = (value: Json | undefined, { word }: Column) => (typeof value === "number" ? value * (word.scale ?? 1) : value);
  const written = (value: Json | undefined, digits: number) => typeof value === "number" ? fixed(value, digits) : isNumbers(value) ? value.map((one) => fixed(one, digits)).join(" to ") : formatted(value);
  const decimals = shown.map((column) => decimalsOf(rows.flatMap(({ cells }) => {
    const value = scaled(cells[columns.indexOf(column)].value, column);
    return typeof value === "number" ? [value] : isNumbers(value) ? value : [];
  }))).map((digits, k) => (shown[k].word.unit === undefined && isCount(shown[k]) ? 0 : digits));
  const head = element("tr", {}, element("td"), ...shown.map((column) => {
    const { word } = column;
    if (word.text !== "") used.set(word.name, word);
    return element("th", { scope: "col", title: word.text, ...(isWords(columns.indexOf(column)) ? { class: "of-words" } : {}) }, word.name, ...(word.unit ? [element("span", { class: "unit" }, ` [${word.unit}]`)] : []));
  }));
  const body = rows.map(({ name, entity, cells }) => element("tr", { ...(entity === undefined ? {} : { "data-entity": entity }) }, element("th", { scope: "row" }, name), ...keep(cells).map(({ path, value }, k) => {
    const text = written(scaled(value, shown[k]), decimals[k]);
    return element("td", { class: isWords(columns.indexOf(shown[k])) ? `of-words${shown[k].word.isLong ? " long" : ""}` : "number", "data-key": path, "data-value": JSON.stringify(value ?? null) }, text);
  })));
  const made = element("table", { class: "aligned" }, element("caption", {}, caption, ...(note ? [element("small", {}, note)] : [])),
    element("thead", {}, head), element("tbody", {}, ...body));
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption }, made);
}

/** A table of some quantities of the objects of a section; `at` gives the path of a number. */
function objectTable(caption: string, note: string | undefined, quantities: string[], ids: string[], numbers: Numbers, at: (id: string, quantity: string) => string, used: Used): HTMLElement | undefined {
  const rows = ids.map((id): Row => ({ name: id, entity: id, cells: quantities.map((quantity) => ({ path: at(id, quantity), value: numbers.get(at(id, quantity)) })) }));
  const isOlder = quantities.includes("gated") && !quantities.includes("unexplained");
  return numberTable(caption, note, quantities.map((quantity) => columnOf(quantity, isOlder)), rows, used);
}

/** Camera and odometry, whose quantities are the same, as two rows. */
function cameraTable(document: JsonObject, numbers: Numbers, used: Used): HTMLElement | undefined {
  const parts = [["camera", "filter"], ["odometry", "odometry alone"]].filter(([key]) => isObject(document[key]));
  const quantities = [...new Set(parts.flatMap(([key]) => Object.keys(document[key] as JsonObject)))];
  const rows = parts.map(([key, name]) => ({ name, cells: quantities.map((quantity) => ({ path: `${key}/${quantity}`, value: numbers.get(`${key}/${quantity}`) })) }));
  return numberTable("Camera in the world", undefined, quantities.map((quantity) => columnOf(quantity)), rows, used);
}

function objectTables(document: JsonObject, ids: string[], numbers: Numbers, used: Used): (HTMLElement | undefined)[] {
  const objects = document["objects"];
  if (!isObject(objects)) return [];
  const quantities = [...new Set(ids.flatMap((id) => [...flat(objects[id], "").keys()]))];
  const themes = [...OBJECT_THEMES, { title: "Objects, other", takes: () => true } as Theme];
  const left = new Set(quantities);
  return themes.map(({ title, note, takes }) => {
    const own = quantities.filter((quantity) => left.has(quantity) && takes("objects", quantity));
    for (const quantity of own) left.delete(quantity);
    // Without truth no frame has an error of both.
    if (own.every(isPaired) && ids.every((id) => (numbers.get(`objects/${id}/paired/frames`) ?? 0) === 0)) return undefined;
    return objectTable(title, note, own, ids, numbers, (id, quantity) => `objects/${id}/${quantity}`, used);
  });
}

interface Names {
  ids: string[];
  camera: string;
}

const isOf = (ids: string[], names: string[]) => names.length > 0 && names.every((name) => ids.includes(name));

/** The verdicts on the poses, a row for each. */
function verdictTable(section: JsonObject, { ids, camera }: Names, numbers: Numbers, used: Used): HTMLElement | undefined {
  const { camera_verdict: ofCamera, relative_verdicts: ofObjects } = section;
  const poses = [...(ofCamera === undefined ? [] : [[camera, "consistency/camera_verdict"]]),
    ...(isObject(ofObjects) ? ids.filter((id) => Object.hasOwn(ofObjects, id)).map((id) => [id, `consistency/relative_verdicts/${id}`]) : [])];
  const given = [ofCamera, ...(isObject(ofObjects) ? Object.values(ofObjects) : [])].filter((one) => isObject(one));
  const quantities = [...new Set([...VERDICT_COLUMNS, ...given.flatMap((one) => Object.keys(one))])];
  const rows = poses.map(([name, path]): Row => ({ name, entity: name, cells: quantities.map((quantity) => ({ path: `${path}/${quantity}`, value: numbers.get(`${path}/${quantity}`) })) }));
  return numberTable("Are errors as large as the covariances say?", "Of the camera in the world, of objects as seen from the camera.", quantities.map((quantity) => columnOf(quantity)), rows, used);
}

/** Any other section: a row per object of what is by object, in either order, and one row of the rest. */
function otherTables(section: string, value: JsonObject, names: Names, numbers: Numbers, used: Used): (HTMLElement | undefined)[] {
  const { ids, camera } = names;
  const title = TITLES[section] ?? section.replaceAll("_", " ");
  const isVerdict = (key: string) => section === "consistency" && VERDICTS.has(key);
  const keys = Object.keys(value).filter((key) => !isVerdict(key));
  if (isOf(ids, keys)) {
    const quantities = [...new Set(Object.values(value).flatMap((one) => [...flat(one, "").keys()]))];
    return [objectTable(title, undefined, quantities, ids, numbers, (id, quantity) => `${section}/${id}${quantity === "" ? "" : `/${quantity}`}`, used)];
  }
  const isByObject = (key: string) => isObject(value[key]) && isOf(ids, Object.keys(value[key]));
  const byObject = keys.filter(isByObject);
  // The numbers of each object may have parts of their own.
  const parts = byObject.flatMap((key) => [...new Set(Object.values(value[key] as JsonObject).flatMap((one) => [...flat(one, "").keys()]))].map((part) => [key, part] as const));
  const ends = new Map(parts.map(([key, part]) => [part === "" ? key : `${key}/${part}`, { key, part }]));
  const at = (id: string, quantity: string) => [section, ends.get(quantity)!.key, id, ...(ends.get(quantity)!.part === "" ? [] : [ends.get(quantity)!.part])].join("/");
  const rest = [...flat(Object.fromEntries(keys.filter((key) => !isByObject(key)).map((key) => [key, value[key]])), "").keys()];
  const isCamera = section === "camera_consistency";
  const row: Row = { ...(isCamera ? { name: camera, entity: camera } : { name: "run" }), cells: rest.map((quantity) => ({ path: `${section}/${quantity}`, value: numbers.get(`${section}/${quantity}`) })) };
  return [
    ...(Object.keys(value).some(isVerdict) ? [verdictTable(value, names, numbers, used)] : []),
    ...(byObject.length > 0 ? [objectTable(title, undefined, [...ends.keys()], ids, numbers, at, used)] : []),
    ...(rest.length > 0 ? [numberTable(isCamera ? "Consistency of the camera" : title, undefined, rest.map((quantity) => columnOf(quantity)), [row], used)] : []),
  ];
}

function definitions(words: Iterable<readonly [string, string]>): HTMLElement {
  const list = element("dl", { class: "words" });
  for (const [name, text] of words) list.append(element("dt", {}, name), element("dd", {}, text));
  return list;
}

/** What all the words on this tab, and of the page, mean. */
function help(used: Used): HTMLElement {
  return element("details", { class: "help" }, element("summary", {}, "Words"),
    definitions([...used.values()].map(({ name, text }) => [name, text] as const)),
    element("h2", {}, "Status of a detection"), definitions(Object.entries(STATUS_WORDS)),
    element("h2", {}, "On the other tabs"), definitions(Object.entries(HELP_WORDS)));
}

/** What the run and its files are known by: shortened, since no one reads it; the whole is in the title. */
function identity(document: JsonObject): HTMLElement[] {
  const { run, files } = document;
  const hashes = [...(typeof run === "string" ? [["run", run, "run"]] : []),
    ...(isObject(files) ? Object.entries(files).map(([name, hash]) => [name, String(hash), `files/${name}`]) : [])];
  if (hashes.length === 0) return [];
  const list = element("dl", { class: "settings" }, ...hashes.map(([name, hash, path]) => element("div", {}, element("dt", {}, name),
    element("dd", { title: hash, "data-key": path, "data-value": JSON.stringify(hash) }, hash.length > SHORT_HASH ? `${hash.slice(0, SHORT_HASH)}…` : hash))));
  return [element("details", { class: "identity" }, element("summary", {}, "Number of the run, and SHA-256 of its files"), list)];
}

const SHORT_HASH = 12;

/** Sections that have a place of their own on the page. */
const ELSEWHERE = new Set(["camera", "odometry", "objects", "provenance", "files"]);

/** @param camera what the page calls the camera */
export function metrics(document: Json | undefined, camera: string): HTMLElement {
  if (!isObject(document)) return element("p", { class: "notice" }, "The folder has no metrics.json.");
  const numbers = flat(document, "");
  const objects = document["objects"];
  const ids = isObject(objects) ? Object.keys(objects) : [];
  const used: Used = new Map();
  const top = Object.entries(document).filter(([key, value]) => key !== "schema" && key !== "run" && !isObject(value)).map(([key]) => key);
  const tables = [
    numberTable("Run", undefined, top.map((key) => columnOf(key)), [{ name: "run", cells: top.map((key) => ({ path: key, value: document[key] })) }], used),
    cameraTable(document, numbers, used),
    ...objectTables(document, ids, numbers, used),
    ...Object.entries(document).flatMap(([key, value]) => (isObject(value) && !ELSEWHERE.has(key) ? otherTables(key, value, { ids, camera }, numbers, used) : [])),
  ].filter((made) => made !== undefined);
  const node = element("div", { class: "tables", id: "metrics" }, ...tables,
    element("p", { class: "hint" }, "Errors are over the frames with both an estimate and ground truth. A dash marks a missing value; press a row of an object to select it."), ...identity(document), help(used));
  return node;
}
