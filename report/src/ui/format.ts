// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import type { Json } from "../payload.ts";

/** A number with four significant digits for tables; a missing one is a dash. */
export function formatted(value: Json | undefined): string {
  if (value === null || value === undefined || value === "") return "–";
  if (typeof value !== "number") return typeof value === "object" ? JSON.stringify(value) : String(value);
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e7) return value.toExponential(3);
  return String(Number(value.toPrecision(4)));
}

const UNITS: readonly (readonly [string, string])[] = [
  ["_deg", "deg"], ["_mm", "mm"], ["_cm", "cm"], ["_m", "m"], ["_rad", "rad"], ["_us", "µs"], ["_ms", "ms"], ["_s", "s"],
];

/** The name and unit of a key such as position_rmse_m. */
export function titleOf(key: string): { name: string; unit: string } {
  for (const [end, unit] of UNITS) {
    if (key.endsWith(end)) return { name: key.slice(0, -end.length).replaceAll("_", " "), unit };
  }
  return { name: key.replaceAll("_", " "), unit: "" };
}
