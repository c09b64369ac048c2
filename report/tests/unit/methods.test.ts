// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import assert from "node:assert/strict";
import { test } from "node:test";
import { methodColour, methodLook } from "../../src/ui/methods.ts";
import { colourOf, TRUTH_COLOUR } from "../../src/ui/palette.ts";

test("a method has its colour wherever it stands in a chart", () => {
  assert.equal(methodColour("midway", 0), methodColour("midway", 7));
  assert.equal(methodColour("odometry", 3), TRUTH_COLOUR);
  assert.notEqual(methodColour("riekf", 0), methodColour("midway", 0));
});

test("settings in parentheses do not change the colour of a method, and variants are dashed", () => {
  assert.equal(methodColour("gm-iekf (midway)", 0), methodColour("gm-iekf", 5));
  assert.equal(methodColour("riekf (gate 0.5)", 0), methodColour("riekf", 5));
  assert.deepEqual(methodLook("default_smoothed"), { colour: methodColour("default", 0), dashed: true });
});

test("a method that is not known has the colour of its number", () => {
  assert.equal(methodLook("of my own"), undefined);
  assert.equal(methodColour("of my own", 4), colourOf(4));
  assert.equal(methodColour("constructor", 4), colourOf(4));
});
