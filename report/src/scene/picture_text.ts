// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Names and lines of pictures that are kept.

/** A name of a file from the run and the time, whatever the run is called. */
export function pictureName(run: string, seconds: number): string {
  const safe = run.normalize("NFKD").replaceAll(/[^A-Za-z0-9._-]+/g, "-").replaceAll(/^[-.]+|-+$/g, "").slice(0, 80);
  return `${safe || "run"}_t${seconds.toFixed(2)}s_scene.png`;
}

/** A text in lines of words that are not wider than the picture; a single word may be. */
export function wrapped(text: string, most: number, measure: (text: string) => number): string[] {
  if (measure(text) <= most) return [text];
  const lines: string[] = [];
  for (const word of text.split(" ")) {
    const longer = lines.length > 0 ? `${lines[lines.length - 1]} ${word}` : word;
    if (lines.length > 0 && measure(longer) <= most) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

/** The entries in lines that are not wider than the picture. */
export function legendLines(widths: readonly number[], most: number): number[][] {
  const lines: number[][] = [];
  let left = 0;
  widths.forEach((width, i) => {
    if (lines.length === 0 || width > left) {
      lines.push([]);
      left = most;
    }
    lines[lines.length - 1].push(i);
    left -= width;
  });
  return lines;
}
