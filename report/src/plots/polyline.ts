// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Lines and words of saved plots.
import type { Field } from "./pen.ts";

export type Points = number[];

/** Runs without gaps, thinned to the lowest and highest value per pixel. */
export function polylines(x: ArrayLike<number>, values: ArrayLike<number | null | undefined>, field: Field): Points[] {
  const lines: Points[] = [];
  let line: Points = [];
  let [column, low, high, lowAt, highAt] = [NaN, 0, 0, 0, 0];
  const flush = () => {
    if (Number.isNaN(column)) return;
    const add = (i: number, y: number) => line.push(field.x(x[i]), y);
    if (lowAt <= highAt) add(lowAt, low);
    if (highAt !== lowAt) add(highAt, high);
    if (lowAt > highAt) add(lowAt, low);
    column = NaN;
  };
  const end = () => {
    flush();
    if (line.length > 0) lines.push(line.length === 2 ? [...line, line[0] + 0.5, line[1]] : line);
    line = [];
  };
  const beyond = (i: number) => x[i] < field.range[0] || x[i] > field.range[1];
  for (let i = 0; i < x.length; ++i) {
    const value = values[i];
    // The neighbours of the shown part are kept, so that lines reach the edges.
    if (value === null || value === undefined) end();
    else if (beyond(i) && (i === 0 || beyond(i - 1)) && (i + 1 >= x.length || beyond(i + 1))) end();
    else {
      const [here, y] = [Math.floor(field.x(x[i])), field.y(value)];
      if (here !== column) {
        flush();
        [column, low, high, lowAt, highAt] = [here, y, y, i, i];
      } else if (y < low) [low, lowAt] = [y, i];
      else if (y > high) [high, highAt] = [y, i];
    }
  }
  end();
  return lines;
}

/** A sentence in lines that fit. */
export function wrapped(text: string, width: number, widthOf: (text: string) => number): string[] {
  const lines: string[] = [];
  for (const word of text.split(" ")) {
    const last = lines[lines.length - 1];
    if (last !== undefined && widthOf(`${last} ${word}`) <= width) lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  return lines;
}
