// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How long the page takes to load and to draw a frame. Nothing is asserted: times depend on the machine and its load. The times
// of a frame are those on the processor; a headless browser draws in software, so frames per second would not be meaningful.
import { statSync } from "node:fs";
import { type Page, test } from "@playwright/test";
import { open, placeOf, probe } from "../tests/page/report.ts";
import { type Size, syntheticReport } from "../tests/synthetic.ts";

const SIZES: Size[] = [
  { frames: 1152, objects: 4, hypotheses: 3 },
  { frames: 20000, objects: 10, hypotheses: 12 },
];
const TABS = ["Detections", "Errors", "Hypotheses", "Status"];
const SCRUBS = 60;

function quantile(sorted: number[], share: number): number {
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

/** Moves the timeline here and there and returns how long each frame took [ms]. */
function scrubMany(page: Page, frames: number): Promise<number[]> {
  return page.getByRole("slider", { name: "Frame" }).evaluate((bar: HTMLInputElement, [times, length]) => {
    return Array.from({ length: times }, (_, i) => {
      bar.value = String((i * 7919) % length);
      bar.dispatchEvent(new Event("input"));
      return window.posemix!["updateTime"] as number;
    });
  }, [SCRUBS, frames] as const);
}

function printTable(title: string, rows: [string, string][]): void {
  const width = Math.max(...rows.map(([name]) => name.length));
  const lines = rows.map(([name, value]) => `  ${name.padEnd(width)}  ${value.padStart(14)}`);
  console.log(`\n${[title, ...lines].join("\n")}`);
}

for (const size of SIZES) {
  const title = `${size.frames} frames, ${size.objects} objects, ${size.hypotheses} hypotheses each`;
  test(title, async ({ page }) => {
    const name = `bench-${size.frames}`;
    await open(page, name, syntheticReport(size));
    const milliseconds = async (key: string) => `${(await probe<number>(page, key)).toFixed(0)} ms`;
    const rows: [string, string][] = [
      ["size of the page", `${(statSync(placeOf(name)).size / 1e6).toFixed(1)} MB`],
      ["decoding", await milliseconds("decodeTime")],
      ["first drawn after", await milliseconds("firstDraw")],
    ];
    for (const tab of TABS) {
      await page.getByRole("tab", { name: tab }).click();
      const times = (await scrubMany(page, size.frames)).sort((a, b) => a - b);
      const shown = [0.5, 0.9].map((share) => quantile(times, share).toFixed(2));
      rows.push([`frame, ${tab}: median, 90 %`, `${shown.join(", ")} ms`]);
    }
    printTable(title, rows);
  });
}
