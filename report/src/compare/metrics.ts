// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The numbers by which runs are compared, each with what chance may make of it.
import { isObject, type Json } from "../payload.ts";
import { holm, type Paired, paired, studentQuantile } from "../stats/paired.ts";
import type { Comparison, Norms, Values } from "./runs.ts";

/** Differences that chance makes more often are ties. */
export const LEVEL = 0.05;
/** A tie is more than a difference that was not found: enough independent frames, and no difference above these is probable. */
export const TIE_FRAMES = 20;
export const TIE_SHARE = 0.1;
export const TIE_POINTS = 5;
/** Within these an estimate is on the right mode, as in metrics.json. */
export const RIGHT_DEG = 20;
export const RIGHT_MM = 100;
/** The entity of the camera's rows; those of objects end with "from the camera". */
export const CAMERA_ROWS = "camera in the world";

export type Verdict = "best" | "tie" | "worse" | "undecided" | "untested" | "none";

export interface Cell {
  value: number | undefined;
  verdict: Verdict;
  /** Against the best run. */
  test: Paired | undefined;
  /** Raised for the number of comparisons in the table. */
  p: number | undefined;
  /** Where the true difference to the best is with 95 %, in the unit of the row. */
  interval: readonly [number, number] | undefined;
}

export interface MetricRow {
  entity: string;
  quantity: string;
  unit: string;
  better: "small" | "large" | "near";
  /** What is right where being near to it is better. */
  nominal?: number;
  /** The run with the best value, or -1. */
  best: number;
  cells: Cell[];
  /** The frames that all runs have. */
  frames: number | undefined;
}

/** What a row is made of: per run a number per frame, whose mean is turned into the value. */
interface Source {
  entity: string;
  quantity: string;
  unit: string;
  better: MetricRow["better"];
  nominal?: number;
  perFrame: (Values | undefined)[];
  value: (mean: number) => number;
}

/** Values where all runs that have any have one, so that all are measured by the same frames. */
export function inCommon(series: readonly (Values | undefined)[]): { series: (Values | undefined)[]; frames: number } {
  const there = series.filter((one): one is Values => one !== undefined && one.some((value) => value !== null));
  const length = there[0]?.length ?? 0;
  const common = Array.from({ length }, (_, i) => there.every((one) => one[i] !== null));
  const cut = series.map((one) => (one && there.includes(one) ? one.map((value, i) => (common[i] ? value : null)) : undefined));
  return { series: cut, frames: common.filter(Boolean).length };
}

const meanOf = (values: Values): number | undefined => {
  let [sum, count] = [0, 0];
  for (const value of values) {
    if (value === null) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : undefined;
};
export const cost = (row: { better: MetricRow["better"]; nominal?: number }, value: number) =>
  row.better === "small" ? value : row.better === "large" ? -value : Math.abs(row.nominal === 1 ? Math.log(Math.max(value, 1e-12)) : value - (row.nominal ?? 0));

function bestOf(row: { better: MetricRow["better"]; nominal?: number }, values: (number | undefined)[]): number {
  let best = -1;
  values.forEach((value, i) => {
    if (value !== undefined && (best < 0 || cost(row, value) < cost(row, values[best]!))) best = i;
  });
  return values.filter((value) => value !== undefined).length > 1 ? best : -1;
}

/** The difference of the values that is in keeping with a difference of the means; undefined where too few frames are independent. */
function intervalOf({ value }: Source, best: number, { difference, standardError, effective, p }: Paired): readonly [number, number] | undefined {
  if (p === undefined) return undefined;
  const reach = standardError > 0 ? standardError * studentQuantile(LEVEL, effective - 1) : 0;
  const at = (by: number) => value(Math.max(0, best + by)) - value(best);
  return [at(difference - reach), at(difference + reach)];
}

/** A row whose differences are tested by frame; of different recordings the values alone. */
function tested(source: Source, isOneRecording: boolean): MetricRow | undefined {
  const { series, frames } = isOneRecording ? inCommon(source.perFrame) : { series: source.perFrame, frames: undefined };
  if (frames === 0) return undefined;
  const values = series.map((one) => {
    const mean = one && meanOf(one);
    return mean === undefined ? undefined : source.value(mean);
  });
  if (values.every((value) => value === undefined)) return undefined;
  const best = isOneRecording ? bestOf(source, values) : -1;
  const cells = values.map((value, i): Cell => {
    const [own, other] = [series[i], best < 0 ? undefined : series[best]];
    const test = i !== best && own && other ? paired(own, other) : undefined;
    const interval = test && intervalOf(source, meanOf(other!)!, test);
    return { value, verdict: value === undefined ? "none" : "untested", test, p: test?.p, interval };
  });
  return { entity: source.entity, quantity: source.quantity, unit: source.unit, better: source.better, ...(source.nominal !== undefined ? { nominal: source.nominal } : {}), best, cells, frames };
}

/** A row of numbers that metrics.json has, which cannot be tested. */
function stated(entity: string, quantity: string, unit: string, better: MetricRow["better"], values: (number | undefined)[], isOneRecording: boolean, nominal?: number): MetricRow | undefined {
  if (values.filter((value) => value !== undefined).length < 2) return undefined;
  const row = { entity, quantity, unit, better, ...(nominal !== undefined ? { nominal } : {}) };
  const best = isOneRecording ? bestOf(row, values) : -1;
  return { ...row, best, frames: undefined, cells: values.map((value, i): Cell => ({ value, verdict: value === undefined ? "none" : i === best ? "best" : "untested", test: undefined, p: undefined, interval: undefined })) };
}

const square = (values: Values | undefined): Values | undefined => values?.map((value) => (value === null ? null : value * value));

function onRightMode({ distance, angle }: Norms): Values {
  return angle.map((degrees, i) => (degrees === null ? null : degrees <= RIGHT_DEG && distance[i]! <= RIGHT_MM ? 100 : 0));
}

function number(document: Json | undefined, ...path: string[]): number | undefined {
  let at: Json | undefined = document;
  for (const key of path) at = isObject(at) ? at[key] : undefined;
  return typeof at === "number" ? at : undefined;
}

function errorRows({ runs, isOneRecording }: Comparison, entity: string, id: string | undefined): (MetricRow | undefined)[] {
  const errors = runs.map((run) => run.error(id));
  const rms = (quantity: string, unit: string, pick: (norms: Norms) => Values) =>
    tested({ entity, quantity, unit, better: "small", perFrame: errors.map((norms) => norms && square(pick(norms))), value: Math.sqrt }, isOneRecording);
  const right = id === undefined ? undefined
    : tested({ entity, quantity: "frames on the right mode", unit: "%", better: "large", perFrame: errors.map((norms) => norms && onRightMode(norms)), value: (mean) => mean }, isOneRecording);
  return [
    rms("position error, rms", "mm", ({ distance }) => distance), rms("rotation error, rms", "deg", ({ angle }) => angle),
    // Where every run always is on the right mode there is nothing to compare.
    ...(right && right.cells.some(({ value }) => value !== undefined && value < 100) ? [right] : []),
    stated(entity, "ANEES, expected 1", "", "near", runs.map(({ metrics }) =>
      id === undefined ? number(metrics, "camera_consistency", "anees") : number(metrics, "consistency", "relative_anees", id)), isOneRecording, 1),
  ];
}

/** Without truth: how sure the runs are of themselves, which is not how good they are. */
function spreadRows({ runs, isOneRecording }: Comparison, entity: string, id: string | undefined): (MetricRow | undefined)[] {
  const sigmas = runs.map((run) => run.sigma(id));
  const row = (quantity: string, unit: string, pick: (norms: Norms) => Values): MetricRow | undefined => {
    const values = inCommon(sigmas.map((norms) => norms && pick(norms)));
    if (values.frames === 0) return undefined;
    const cells = values.series.map((one): Cell => ({ value: one && meanOf(one), verdict: one ? "untested" : "none", test: undefined, p: undefined, interval: undefined }));
    return { entity, quantity, unit, better: "small", best: -1, cells, frames: values.frames };
  };
  const apart = (unit: string, words: string, pick: (norms: Norms) => Values): MetricRow | undefined => {
    const cells = runs.map((run, i): Cell => {
      const norms = i === 0 ? undefined : run.apart(runs[0], id);
      const mean = norms && meanOf(square(pick(norms))!);
      return { value: mean === undefined ? undefined : Math.sqrt(mean), verdict: mean === undefined ? "none" : "untested", test: undefined, p: undefined, interval: undefined };
    });
    return cells.some(({ value }) => value !== undefined) ? { entity, quantity: `${words} between it and ${runs[0].name}, rms`, unit, better: "small", best: -1, cells, frames: undefined } : undefined;
  };
  return [...(isOneRecording ? [apart("mm", "distance", ({ distance }) => distance), apart("deg", "angle", ({ angle }) => angle)] : []),
    row("own 99.7 % bound of the position, mean", "mm", ({ distance }) => distance),
    row("own 99.7 % bound of the rotation, mean", "deg", ({ angle }) => angle)];
}

/** Whether the run is as good as the best, rather than not known to be worse. */
function isTie(row: MetricRow, { test, interval }: Cell): boolean {
  if (test!.difference === 0) return true;
  const most = row.better === "small" ? TIE_SHARE * row.cells[row.best].value! : TIE_POINTS;
  return test!.effective >= TIE_FRAMES && interval !== undefined && interval.every((end) => Math.abs(end) <= most);
}

/** Says of every cell whether it is the best, a tie with it, or worse; all tests of the table count together. */
function judge(rows: MetricRow[]): void {
  const cells = rows.flatMap((row) => row.cells.filter(({ test }) => test !== undefined));
  holm(cells.map(({ p }) => p)).forEach((p, i) => (cells[i].p = p));
  for (const row of rows) {
    if (row.best < 0) continue;
    row.cells.forEach((cell, i) => {
      if (i === row.best) cell.verdict = "best";
      else if (cell.test) cell.verdict = cell.test.difference !== 0 && cell.p !== undefined && cell.p <= LEVEL ? "worse" : isTie(row, cell) ? "tie" : "undecided";
    });
  }
}

export function metricRows(comparison: Comparison): MetricRow[] {
  const { runs, ids, hasTruth, isOneRecording } = comparison;
  const of = (entity: string, id: string | undefined) => (hasTruth ? errorRows : spreadRows)(comparison, entity, id);
  const all = [
    ...of(CAMERA_ROWS, undefined), ...ids.flatMap((id) => of(`${id} from the camera`, id)),
    stated("program", "time of a frame, median", "ms", "small", runs.map(({ metrics }) => {
      const us = number(metrics, "timing", "frame_median_us");
      return us === undefined ? undefined : us / 1000;
    }), isOneRecording),
  ];
  const rows = all.filter((row): row is MetricRow => row !== undefined);
  judge(rows);
  return rows;
}

export function pText(p: number): string {
  return p < 0.001 ? "p < 0.001" : `p = ${p.toFixed(p < 0.1 ? 3 : 2)}`;
}

const rounded = (value: number) => (value >= 100 ? value.toFixed(0) : String(Number(value.toPrecision(3))));
export const valueText = (value: number | undefined, unit: string) => (value === undefined ? "–" : `${rounded(value)}${unit ? ` ${unit}` : ""}`);

/** Shares differ by points, since a percentage of a percentage is read as the other. */
export const differenceText = (size: number, unit: string) => (unit === "%" ? `${Number(size.toPrecision(3))} points` : valueText(size, unit));

const signed = (value: number, text: (size: number) => string) => `${value < 0 ? "−" : "+"}${text(Math.abs(value))}`;

/** Where the true difference is: in per cent of the best, or in points. */
function rangeText({ better }: MetricRow, { interval }: Cell, best: number): string {
  if (!interval || best === 0) return "";
  const [low, high] = interval.map((end) => signed(better === "small" ? (100 * end) / best : end, (size) => size.toFixed(0)));
  return `, with 95 % between ${low} and ${high} ${better === "small" ? "%" : "points"}`;
}

/** Where the interval, that of one comparison, tells a run from the best, and only the p value of all of them does not: why. */
export function severalText({ interval, p }: Cell): string {
  if (!interval || p === undefined || interval[0] * interval[1] <= 0) return "";
  return `${pText(p)} over all comparisons (Holm)`;
}

/** What stands below a value: its difference to the best, and whether that is more than chance. */
export function cellNote(row: MetricRow, cell: Cell, names: readonly string[]): string {
  const best = row.best < 0 ? undefined : row.cells[row.best].value;
  if (cell.verdict === "none" || best === undefined || cell.value === undefined) return "";
  if (cell.verdict === "best") {
    const ties = row.cells.filter(({ verdict }) => verdict === "tie").length;
    const open = row.cells.some(({ verdict }) => verdict === "undecided");
    return ties > 0 ? "best, with a tie" : open ? "best value, not told apart from all" : row.frames === undefined ? "best, not tested" : "best";
  }
  const difference = cell.value - best;
  const share = best !== 0 && row.better === "small" && Math.abs(difference) >= 0.005 * Math.abs(best) ? ` (${signed((100 * difference) / best, (size) => size.toFixed(0))} %)` : "";
  const head = difference === 0 ? "equal" : `${signed(difference, (size) => differenceText(size, row.unit))}${share}`;
  const size = cell.test ? `, ${Math.round(cell.test.effective)} independent frames` : "";
  const range = rangeText(row, cell, best);
  switch (cell.verdict) {
    case "tie":
      return difference === 0 ? `tie with ${names[row.best]}` : `tie with ${names[row.best]}: ${head}${range}${size}`;
    case "worse":
      return `${head}, ${pText(cell.p ?? 1)}${size}`;
    case "undecided": {
      const several = severalText(cell);
      return `not told apart from ${names[row.best]}: ${head}${range}${size}${several && `; ${several}`}`;
    }
    default:
      return `${head}, not tested`;
  }
}
