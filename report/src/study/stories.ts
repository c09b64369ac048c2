// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What a study found, in sentences made of its tables. A study whose columns are not known has none: nothing is invented.
import { median } from "../math/statistics.ts";
import type { Json } from "../payload.ts";
import type { Table } from "../ui/csv.ts";
import { isNumber } from "./columns.ts";

type Row = Record<string, Json>;
export type Tables = Readonly<Record<string, Table>>;

const rowsOf = (table: Table | undefined): Row[] =>
  (table?.rows ?? []).map((row) => Object.fromEntries(table!.columns.map((name, k) => [name, row[k] ?? null])));
const number = (row: Row | undefined, key: string): number | undefined => (row !== undefined && isNumber(row[key]) ? row[key] : undefined);
const having = (rows: Row[], key: string) => rows.filter((row) => isNumber(row[key]));
const written = (value: number) => String(Number(value.toPrecision(4)));
const percent = (share: number) => `${(100 * share).toFixed((share > 0.995 && share < 1) || (share > 0 && share < 0.1) ? 1 : 0)} %`;
const named = (value: Json | undefined) => String(value ?? "–");

function least(rows: Row[], key: string, size: (value: number) => number = (value) => value): Row[] {
  return [...having(rows, key)].sort((a, b) => size(a[key] as number) - size(b[key] as number));
}

/** How far a consistency number is from one, on either side. */
const fromOne = (value: number) => Math.abs(Math.log(Math.max(value, 1e-12)));

/** "A has the smallest error, 1.2; B follows with 1.3." `chance`: what is known of the difference. */
function compared(best: Row, second: Row | undefined, key: string, what: string, unit: string, chance = ""): string {
  const [a, b] = [number(best, key)!, number(second, key)];
  const head = `${named(best["method"])} has the smallest ${what}, ${written(a)}${unit}`;
  if (second === undefined || b === undefined) return `${head}.`;
  if (written(a) === written(b)) return `${named(best["method"])} and ${named(second["method"])} have the same ${what}, ${written(a)}${unit}: a tie.`;
  return `${head}; ${named(second["method"])} follows with ${written(b)}${unit}${chance}.`;
}

/** What paired.csv says of two methods on the same runs; without it the standard errors alone, which do not tell. */
function pairedChance(tables: Tables, best: Row, second: Row | undefined, key: string): string {
  if (second === undefined) return "";
  const methods = [best["method"], second["method"]];
  const row = rowsOf(tables["paired.csv"]).find((one) =>
    one["noise_exponent"] === best["noise_exponent"] && one["quantity"] === key && methods.includes(one["method"]) && methods.includes(one["against"]));
  const [p, difference, runs] = [number(row, "p_value"), number(row, "mean_difference"), number(row, "runs")];
  if (p !== undefined && difference !== undefined) {
    const said = `${written(Math.abs(difference))} deg apart on the same ${runs ?? ""} runs, p ${p < 0.001 ? "< 0.001" : `= ${written(p)}`}`;
    return p > 0.05 ? `: a tie, ${said}` : ` (${said})`;
  }
  const errors = [best, second].map((one) => number(one, `${key}_standard_error`));
  return errors[0] === undefined || errors[1] === undefined ? "" : ` (standard errors ${written(errors[0])} and ${written(errors[1])})`;
}

const spanOf = (values: number[]) => `${written(Math.min(...values))} and ${written(Math.max(...values))}`;

/** Methods are not ranked by the consistency of fewer runs. */
const LEAST_RUNS = 20;

function monteCarlo(tables: Tables): string[] {
  const rows = having(rowsOf(tables["rows"]), "noise_exponent");
  if (rows.length === 0) return [];
  const level = Math.max(...rows.map((row) => row["noise_exponent"] as number));
  const noisiest = rows.filter((row) => row["noise_exponent"] === level);
  const at = `At the noisiest odometry (covariance times 10^${level})`;
  const [best, second] = least(noisiest, "robot_rotation_rmse_deg");
  const found = best ? [`${at} ${compared(best, second, "robot_rotation_rmse_deg", "rotation error of the camera", " deg", pairedChance(tables, best, second, "robot_rotation_rmse_deg"))}`] : [];
  const ranked = least(noisiest, "anees", fromOne);
  const runs = Math.min(...noisiest.map((row) => number(row, "runs") ?? Infinity));
  if (ranked.length > 1 && runs < LEAST_RUNS) {
    found.push(`ANEES is between ${spanOf(ranked.map((row) => row["anees"] as number))} there (expected 1); ${runs} runs are too few to rank the methods by it.`);
  } else if (ranked.length > 1) {
    const [good, bad] = [ranked[0], ranked[ranked.length - 1]];
    found.push(`The covariance of ${named(good["method"])} is the nearest to right there (ANEES ${written(good["anees"] as number)}, expected 1); that of ${named(bad["method"])} is the farthest (${written(bad["anees"] as number)}).`);
  }
  return found;
}

function divergence(tables: Tables): string[] {
  const rows = having(rowsOf(tables["rows"]), "phi_deg");
  if (rows.length === 0) return [];
  const widest = Math.max(...rows.map((row) => row["phi_deg"] as number));
  const ranked = least(rows.filter((row) => row["phi_deg"] === widest), "kl");
  if (ranked.length < 2) return [];
  const [best, second] = ranked;
  const all = [...new Set(rows.map((row) => row["phi_deg"]))].filter((phi) => least(rows.filter((row) => row["phi_deg"] === phi), "kl")[0]?.["rule"] === best["rule"]);
  const angles = new Set(rows.map((row) => row["phi_deg"])).size;
  const loss = (row: Row) => written(row["kl"] as number);
  const equal = ranked.filter((row) => loss(row) === loss(best)).map((row) => named(row["rule"]));
  const at = `at ${widest} deg between the means`;
  if (equal.length > 1) return [`${equal.join(" and ")} lose the least: ${at} the KL divergence of each is ${loss(best)} nats, a tie.`];
  return [`${named(best["rule"])} loses the least: ${at} its KL divergence is ${loss(best)} nats, ${named(second["rule"])} follows with ${loss(second)}. It is the best at ${all.length} of ${angles} angles.`];
}

function noise(tables: Tables): string[] {
  const rows = having(rowsOf(tables["rows"]), "kurtosis").filter((row) => row["object"] !== "all");
  if (rows.length === 0) return [];
  const heavy = least(rows, "kurtosis", (value) => -value)[0];
  const tails = rows.filter((row) => (row["kurtosis"] as number) > 4).length;
  const found = [`The tails are heavier than a Gaussian's (kurtosis above 4) in ${tails} of ${rows.length} distributions; the heaviest is ${named(heavy["axis"])} of ${named(heavy["object"])} by ${named(heavy["detector"])}, ${written(heavy["kurtosis"] as number)} (Gaussian: 3).`];
  const dependent = having(rows, "dependent_frames").map((row) => row["dependent_frames"] as number);
  if (dependent.length > 0) found.push(`Errors last: in the median, ${written(median(dependent))} frames carry the information of one independent frame.`);
  return found;
}

function grasp(tables: Tables): string[] {
  const total = rowsOf(tables["rows"]).filter((row) => ["split", "object", "gripper", "estimator"].every((key) => row[key] === "all"));
  const ranked = least(total.filter((row) => row["method"] !== "region_at_true_error"), "brier");
  if (ranked.length === 0) return [];
  const [best, second] = ranked;
  const found = [`Over ${named(best["grasps"])} grasps ${compared(best, second, "brier", "Brier score", "")}`];
  const bound = total.find((row) => row["method"] === "region_at_true_error");
  const limit = number(bound, "brier");
  if (limit !== undefined) found.push(`The bound, which knows the true error, has ${written(limit)}.`);
  return found;
}

function ycbv(tables: Tables): string[] {
  const rows = rowsOf(tables["summary"]);
  const detectors = [...new Set(rows.map((row) => named(row["detector"])))];
  return detectors.flatMap((detector) => {
    const own = rows.filter((row) => named(row["detector"]) === detector && !named(row["method"]).startsWith("published"));
    const [best, second] = least(own.filter((row) => row["method"] !== "detector"), "pixel_median");
    if (!best) return [];
    const count = number(best, "rows");
    const words = [`${detector}: ${compared(best, second, "pixel_median", "median pixel error", " px")}`];
    if (count !== undefined) words.push(`(${count} ${count === 1 ? "pair" : "pairs"} of object and recording.)`);
    return [words.join(" ")];
  });
}

function tless(tables: Tables): string[] {
  const figures = new Map(rowsOf(tables["summary"]).map((row) => [named(row["figure"]), row]));
  const of = (figure: string, symmetries: string) => number(figures.get(figure), symmetries);
  const within = "share within 20 deg and 5 cm";
  const [declared, none, single] = [of(`estimate: ${within}`, "declared"), of(`estimate: ${within}`, "none"), of(`detection: ${within}`, "declared")];
  if (declared === undefined || single === undefined) return [];
  const found = [`The map has ${percent(declared)} of the views of instances within 20 deg and 5 cm; single detections have ${percent(single)}.`];
  if (none === undefined) return found;
  const flips = ["declared", "none"].map((symmetries) => of("share of steps with a flip", symmetries));
  const flipText = flips[0] !== undefined && flips[1] !== undefined ? `; estimates flip in ${percent(flips[0])} of the steps with them and in ${percent(flips[1])} without` : "";
  return [...found, `Without declared symmetries the map has ${percent(none)}${flipText}.`];
}

function fuseViews(tables: Tables): string[] {
  const rows = rowsOf(tables["summary"]).filter((row) => row["groups_of"] === "random" && row["input"] === "mixtures");
  return rows.filter((row) => row["noise"] === "learned").flatMap((row) => {
    const [fused, single] = [number(row, "fused_within_20deg_5cm"), number(row, "single_within_20deg_5cm")];
    if (fused === undefined || single === undefined) return [];
    const anees = number(row, "anees");
    return [`${named(row["dataset"])}, symmetries ${named(row["symmetries"])}: fused views have ${percent(fused)} of the pairs within 20 deg and 5 cm, single views ${percent(single)}${anees === undefined ? "" : `; ANEES ${written(anees)} (expected 1)`}.`];
  });
}

function fiducials(tables: Tables): string[] {
  const rows = having(rowsOf(tables["rows"]), "camera_rms_m");
  return [...new Set(rows.map((row) => named(row["recording"])))].flatMap((recording) => {
    const [best, second] = least(rows.filter((row) => named(row["recording"]) === recording), "camera_rms_m");
    const wrong = number(best, "wrong_share");
    const next = second ? `; ${named(second["input"])} follows with ${written(1000 * (second["camera_rms_m"] as number))} mm` : "";
    return [`${recording}: the camera is the nearest to the reference with ${named(best["input"])}, ${written(1000 * (best["camera_rms_m"] as number))} mm rms${next}${wrong === undefined ? "" : `; ${percent(wrong)} of its sightings are wrong`}.`];
  });
}

function consistency(tables: Tables): string[] {
  const rows = rowsOf(tables["rows"]);
  const poses = ["camera", "object", "relative"];
  const cells = rows.flatMap((row) => poses.flatMap((pose) => {
    const [value, error] = [number(row, `${pose}_anees`), number(row, `${pose}_anees_error`)];
    return value === undefined || error === undefined ? [] : [{ cell: named(row["cell"]), pose, value, error }];
  }));
  if (cells.length === 0) return [];
  const near = cells.filter(({ value, error }) => Math.abs(value - 1) <= 2 * error).length;
  const worst = cells.reduce((most, one) => (fromOne(one.value) > fromOne(most.value) ? one : most));
  return [`ANEES is within two standard errors of 1 in ${near} of ${cells.length} cases; it is the farthest from 1 for the ${worst.pose} in ${worst.cell}, ${written(worst.value)} (standard error ${written(worst.error)}), which is ${worst.value > 1 ? "overconfident" : "cautious"}.`];
}

function saltBox(tables: Tables): string[] {
  const stages = having(rowsOf(tables["rows"]), "rotation_std_deg");
  if (stages.length < 2) return [];
  const [first, last] = [stages[0], stages[stages.length - 1]];
  const place = [first, last].map((row) => number(row, "translation_std_m"));
  const found = [`From ${named(first["stage"])} to ${named(last["stage"])} the standard deviation of the rotation falls from ${written(first["rotation_std_deg"] as number)} to ${written(last["rotation_std_deg"] as number)} deg${place[0] !== undefined && place[1] !== undefined ? `, that of the position from ${written(1000 * place[0])} to ${written(1000 * place[1])} mm` : ""}.`];
  const trials = having(rowsOf(tables["trials.csv"]), "nees_per_dof");
  const worst = least(trials, "nees_per_dof", (value) => -fromOne(value))[0];
  const nees = number(worst, "nees_per_dof");
  if (worst && nees !== undefined) found.push(`In simulated detections the mean NEES per degree of freedom is the farthest from 1 with ${named(worst["tilts"])} and ${named(worst["features"])} features, ${written(nees)}.`);
  return found;
}

const STORIES: Readonly<Record<string, (tables: Tables) => string[]>> = {
  "monte-carlo": monteCarlo, divergence, noise, grasp, ycbv, tless, "fuse-views": fuseViews, fiducials, consistency, "salt-box": saltBox,
};

/** What the tables of a study say; nothing where its columns are others. */
export function storyOf(study: string, tables: Tables): string[] {
  return Object.hasOwn(STORIES, study) ? STORIES[study](tables) : [];
}

/** What each study asks, for its title. */
const QUESTIONS: Readonly<Record<string, string>> = {
  "monte-carlo": "How large and how honest are the errors of each filter as the odometry gets noisier?",
  divergence: "How much does each rule of merging two Gaussians lose?",
  noise: "How are the errors of the detectors distributed, and how long do they last?",
  grasp: "How well is the success of a grasp predicted from the estimated poses?",
  ycbv: "Which filter is the most accurate on recordings of YCB-Video?",
  tless: "What does a map gain over single images, with equal and symmetric objects?",
  "fuse-views": "What does fusing several views gain over single ones?",
  fiducials: "How near do recordings of square tags come to their reference?",
  consistency: "Are the covariances of the defaults right on simulated recordings?",
  "salt-box": "A pose from three features, flags by stage",
};

export function questionOf(study: string): string {
  return Object.hasOwn(QUESTIONS, study) ? QUESTIONS[study] : "";
}
