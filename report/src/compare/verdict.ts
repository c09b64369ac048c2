// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Which run is better, where, and by how much, in sentences.
import { type Failure, isJudged } from "./failures.ts";
import { CAMERA_ROWS, type Cell, cost, differenceText, type MetricRow, pText, severalText, valueText } from "./metrics.ts";
import type { Comparison, Run } from "./runs.ts";

function listed(words: string[]): string {
  return words.length < 2 ? (words[0] ?? "") : `${words.slice(0, -1).join(", ")} and ${words[words.length - 1]}`;
}

const capital = (text: string) => text.slice(0, 1).toUpperCase() + text.slice(1);

/** Runs without truth: whether they are on a wrong mode nobody can say. */
function unjudgedText(runs: Run[]): string {
  if (runs.length === 0) return "";
  return `; ${listed(runs.map(({ name }) => name))} ${runs.length > 1 ? "have" : "has"} no ground truth and cannot be judged`;
}

/** What can be said where no run has truth. */
function agreement({ isOneRecording }: Comparison, failures: Failure[]): string {
  const differing = [...new Set(failures.filter(({ kind }) => kind === "other mode").map(({ id }) => id))];
  if (differing.length > 0) return `The runs disagree on ${listed(differing)}.`;
  return isOneRecording ? "The runs agree on the modes of all objects; without ground truth none can be judged." : "Without ground truth no run can be judged.";
}

/** Which runs failed and which did not, as the first thing to be said. */
export function failureSentence(comparison: Comparison, failures: Failure[]): string {
  const { runs } = comparison;
  const real = failures.filter(({ kind }) => kind !== "other mode");
  const failed = runs.filter((run) => real.some((failure) => failure.run === run));
  const others = runs.filter((run) => !failed.includes(run) && isJudged(run));
  const unjudged = unjudgedText(runs.filter((run) => !failed.includes(run) && !isJudged(run)));
  if (failed.length === 0 && others.length === 0) return agreement(comparison, failures);
  const names = listed(others.map(({ name }) => name));
  if (failed.length === 0 && unjudged === "") return "No run was on a wrong mode for half a second or more.";
  if (failed.length === 0) return `${names} ${others.length > 1 ? "were" : "was"} on no wrong mode for half a second or more${unjudged}.`;
  const what = (run: Run) => [...new Set(real.filter((failure) => failure.run === run).map(({ id }) => id))];
  const spoken = failed.map((run) => `${run.name} fails at ${listed(what(run))}`);
  return `${spoken.join("; ")}${others.length > 0 ? `; ${names} ${others.length > 1 ? "do" : "does"} not fail` : ""}${unjudged}.`;
}

/** How much more than the best: small differences in per cent, large ones as a factor, shares in points. */
function moreText(row: MetricRow, value: number, best: number): string {
  if (row.unit === "%") return `${differenceText(Math.abs(value - best), "%")} ${value < best ? "less" : "more"}, `;
  if (row.better !== "small" || best <= 0) return "";
  const ratio = value / best;
  if (ratio >= 2) return `${ratio >= 100 ? ratio.toFixed(0) : Number(ratio.toPrecision(2))} times as much, `;
  const share = 100 * (ratio - 1);
  return `${share < 1 ? Number(share.toPrecision(1)) : share.toFixed(0)} % more, `;
}

/** Runs of a row, the best value first. */
function inOrder(row: MetricRow, list: number[]): number[] {
  return [...list].sort((a, b) => cost(row, row.cells[a].value!) - cost(row, row.cells[b].value!));
}

const openReason = (cell: Cell) => severalText(cell) || "too few independent frames";

/** One row as a sentence: who is best, who ties with it, and by how much the others are worse. */
export function rowSentence(row: MetricRow, names: readonly string[]): string {
  const best = row.cells[row.best];
  const of = (verdict: string) => inOrder(row, row.cells.flatMap((cell, i) => (cell.verdict === verdict ? [i] : [])));
  const value = (i: number) => valueText(row.cells[i].value, row.unit);
  const head = capital(`${row.entity}, ${row.quantity}`);
  const [ties, worse, open] = [of("tie"), of("worse"), of("undecided")];
  const tied = ties.length > 0 ? `${listed([row.best, ...ties].map((i) => `${names[i]} (${value(i)})`))} are a tie` : `${names[row.best]} ${open.length > 0 ? "has the best value" : "is the best"} (${value(row.best)})`;
  const behind = worse.map((i) => {
    return `${names[i]} has ${value(i)} (${moreText(row, row.cells[i].value!, best.value!)}${pText(row.cells[i].p ?? 1)})`;
  });
  const undecided = open.map((i) => `${names[i]} has ${value(i)} (not told apart: ${openReason(row.cells[i])})`);
  return `${head}: ${[tied, ...behind, ...undecided].join("; ")}.`;
}

/** Which runs are the best in a quantity of the objects: each alone, or in a tie, and for which objects. */
function objectSentence(rows: MetricRow[], names: readonly string[]): string {
  const ofRuns = new Map<string, string[]>();
  const open: string[] = [];
  for (const row of rows) {
    const name = row.entity.replace(/ from the camera$/, "");
    const undecided = row.cells.flatMap((cell, i) => (cell.verdict === "undecided" ? [[names[i], openReason(cell)]] : []));
    if (undecided.length > 0) {
      const values = inOrder(row, row.cells.flatMap(({ value, verdict }, i) => (value === undefined || verdict === "worse" ? [] : [i]))).map((i) => `${names[i]} ${valueText(row.cells[i].value, row.unit)}`);
      const isOne = undecided.every(([, reason]) => reason === undecided[0][1]);
      open.push(`${name} (${values.join(", ")}; ${isOne ? undecided[0][1] : undecided.map(([run, reason]) => `${run}: ${reason}`).join("; ")})`);
      continue;
    }
    const best = row.cells.flatMap(({ verdict }, i) => (verdict === "best" || verdict === "tie" ? [names[i]] : []));
    const key = best.length === 1 ? `${best[0]} alone is the best for` : best.length === names.length ? "all tie for" : `${listed(best)} tie for`;
    ofRuns.set(key, [...(ofRuns.get(key) ?? []), name]);
  }
  const parts = [...ofRuns].map(([key, objects]) => `${key} ${listed(objects)}`);
  return [...parts, ...(open.length > 0 ? [`not told apart for ${listed(open)}`] : [])].join("; ");
}

/** The largest difference between runs in a quantity of the objects, as a sentence. */
function largest(rows: MetricRow[]): MetricRow | undefined {
  const factor = (row: MetricRow) => Math.max(...row.cells.map(({ value, verdict }) => (verdict === "worse" ? value! / Math.max(row.cells[row.best].value!, 1e-9) : 0)));
  const sorted = rows.filter((row) => factor(row) > 0).sort((a, b) => factor(b) - factor(a));
  return sorted[0];
}

export function verdictSentences({ runs, hasTruth }: Comparison, rows: MetricRow[]): string[] {
  const names = runs.map(({ name }) => name);
  const judged = rows.filter((row) => row.best >= 0 && row.frames !== undefined);
  if (!hasTruth || judged.length === 0) return [];
  const sentences = judged.filter(({ entity }) => entity === CAMERA_ROWS).map((row) => rowSentence(row, names));
  for (const quantity of ["rotation error, rms", "position error, rms"]) {
    const own = judged.filter((row) => row.quantity === quantity && row.entity.endsWith(" from the camera"));
    if (own.length === 0) continue;
    if (own.length === 1) {
      sentences.push(rowSentence(own[0], names));
      continue;
    }
    const most = largest(own);
    const example = most ? ` Largest difference: ${rowSentence(most, names)}` : "";
    sentences.push(`Objects from the camera, ${quantity}: ${objectSentence(own, names)}.${example}`);
  }
  return sentences;
}
