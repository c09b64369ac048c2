// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { parseCsv, tableOfRows } from "../../src/ui/csv.ts";
import { gridStep } from "../../src/scene/shapes.ts";
import { formatted, titleOf } from "../../src/ui/format.ts";

test("comma-separated values: numbers, words, quotes, blanks", () => {
  const text = '# a comment\nname,value,note\n"a, ""b""",1e-3,\nc,,x\r\n';
  assert.deepEqual(parseCsv(text), { columns: ["name", "value", "note"], rows: [['a, "b"', 0.001, null], ["c", null, "x"]] });
  assert.deepEqual(parseCsv(""), { columns: [], rows: [] });
});

test("rows that are objects have the columns of all of them", () => {
  assert.deepEqual(tableOfRows([{ a: 1 }, { b: "x", a: null }, 3]), { columns: ["a", "b"], rows: [[1, null], [null, "x"]] });
});

test("numbers and names of tables", () => {
  assert.deepEqual([0.0026125525, 1152, 5.778e-5, 123456789.5, null, "x", 0, 2.5].map(formatted),
    ["0.002613", "1152", "5.778e-5", "1.235e+8", "–", "x", "0", "2.5"]);
  assert.deepEqual(titleOf("position_rmse_m"), { name: "position rmse", unit: "m" });
  assert.deepEqual(titleOf("relative_position_rmse_cm"), { name: "relative position rmse", unit: "cm" });
  assert.deepEqual(titleOf("anees"), { name: "anees", unit: "" });
});

test("the grid's step is 1, 2 or 5", () => {
  assert.deepEqual([1, 3, 6, 0.05].map((size) => Number(gridStep(size).toPrecision(3))), [0.1, 0.2, 0.5, 0.005]);
});
