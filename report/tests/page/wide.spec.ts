// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A large screen: tables and plots take the width, lines of text do not.
import { expect, type Page, test } from "@playwright/test";
import { comparisonReport } from "../comparison_documents.ts";
import { consistencyReport, mixtureReport } from "../documents.ts";
import { eventfulReport } from "../eventful.ts";
import { noise } from "../study_documents.ts";
import { boxOf, open } from "./report.ts";

const MOST_LETTERS = 95;

/** How many letters the longest line of a paragraph, an item of a list or a caption of a table has. */
const longest = (page: Page) => page.evaluate(() => {
  const lines = (node: Element) => {
    const counts = new Map<number, number>();
    const walker = document.createTreeWalker(node, NodeFilter.SHOW_TEXT);
    for (let text = walker.nextNode() as Text | null; text; text = walker.nextNode() as Text | null) {
      for (let i = 0; i < text.length; ++i) {
        const range = document.createRange();
        range.setStart(text, i);
        range.setEnd(text, i + 1);
        const { width, bottom } = range.getBoundingClientRect();
        const line = Math.round(bottom / 8);
        if (width > 0) counts.set(line, (counts.get(line) ?? 0) + 1);
      }
    }
    return [...counts.values()];
  };
  const shown = [...document.querySelectorAll("main :is(p, li, caption)")].filter((node) => (node as HTMLElement).offsetParent !== null && !node.closest(".signs"));
  return Math.max(0, ...shown.flatMap(lines));
});

for (const [name, scale] of [["4k", 1], ["4k of two pixels each", 2]] as const) {
  test.describe(name, () => {
    test.use({ viewport: { width: 3840 / scale, height: 2160 / scale }, deviceScaleFactor: scale });

    test("the poses take the width below the scene, and nothing sticks out", async ({ page }) => {
      await open(page, `wide-run-${scale}`, eventfulReport());
      const [table, stage] = [await boxOf(page.locator("#state")), await boxOf(page.locator(".stage .viewport"))];
      expect(table.width).toBeGreaterThan(0.95 * stage.width);
      for (const tab of await page.getByRole("tab").all()) {
        await tab.click();
        expect(await longest(page)).toBeLessThanOrEqual(MOST_LETTERS);
        expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
      }
    });

    for (const [kind, report] of [["comparison", comparisonReport], ["consistency", consistencyReport], ["study", noise], ["mixture", mixtureReport]] as const) {
      test(`lines of text are short: ${kind}`, async ({ page }) => {
        await open(page, `wide-${kind}-${scale}`, report());
        expect(await longest(page)).toBeLessThanOrEqual(MOST_LETTERS);
        for (const tab of await page.getByRole("tab").all()) {
          await tab.click();
          expect(await longest(page)).toBeLessThanOrEqual(MOST_LETTERS);
        }
      });
    }
  });
}

test("plots and the words in the scene grow with the text of the page", async ({ page }) => {
  const sizes: number[] = [];
  for (const width of [1280, 3840]) {
    await page.setViewportSize({ width, height: width * 0.5625 });
    await open(page, `wide-text-${width}`, eventfulReport());
    await page.waitForFunction(() => (window.posemix!["scene"] as { labels: unknown[] }).labels.length > 0);
    const labels = await page.evaluate(() => (window.posemix!["scene"] as { labels: { text: string; height: number }[] }).labels);
    sizes.push(labels[0].height);
  }
  expect(sizes[0]).toBe(16);
  expect(sizes[1]).toBeGreaterThan(1.3 * sizes[0]);
});
