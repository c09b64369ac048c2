// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Every kind of page, every tab, light and dark, by the rules of axe-core.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { expect, type Page, test } from "@playwright/test";
import { comparisonReport } from "../comparison_documents.ts";
import { consistencyReport, mixtureReport, mug, saltBoxReport } from "../documents.ts";
import { grasp, monteCarlo, noise, ycbv } from "../study_documents.ts";
import { syntheticReport } from "../synthetic.ts";
import { open } from "./report.ts";

const source = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

interface Violation {
  id: string;
  nodes: { html: string; failureSummary?: string }[];
}

/** What axe-core finds, as text; the policy of the page allows no script from elsewhere, so that it is evaluated by the browser's own tools. */
async function violations(page: Page): Promise<string[]> {
  const found = await page.evaluate<Violation[]>(`axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) => violations)`);
  return found.map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map(({ html, failureSummary }) => `${html.slice(0, 200)} (${failureSummary ?? ""})`).join(" | ")}`);
}

function run() {
  const report = syntheticReport({ frames: 60, objects: 3, hypotheses: 3 }, {
    tables: { "timing.csv": "a,b\n1,2\n" }, texts: { "report.md": "# Text" }, pictures: { "picture.svg": `<svg xmlns="http://www.w3.org/2000/svg"><text>A run</text></svg>` },
  });
  report["documents"] = { ...(report["documents"] as object), "mixture_object-0.json": mug };
  return report;
}

const pages: [string, () => unknown][] = [
  ["run", run], ["comparison", comparisonReport], ["monte-carlo", monteCarlo], ["noise", () => noise(12)], ["ycbv", ycbv], ["grasp", grasp],
  ["mixture", mixtureReport], ["salt-box", saltBoxReport], ["consistency", consistencyReport], ["empty", () => undefined],
];

for (const [name, report] of pages) {
  for (const scheme of ["light", "dark"] as const) {
    test(`axe finds nothing in ${name}, ${scheme}, in any tab`, async ({ page }) => {
      test.setTimeout(180_000);
      await page.emulateMedia({ colorScheme: scheme });
      await open(page, `axe-${name}-${scheme}`, report());
      await page.evaluate(source);
      const tabs = await page.getByRole("tab").all();
      if (tabs.length === 0) expect(await violations(page)).toEqual([]);
      for (const tab of tabs) {
        await tab.click();
        await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = true)));
        expect(await violations(page), await tab.innerText()).toEqual([]);
      }
    });
  }
}

test("axe finds what is wrong", async ({ page }) => {
  await open(page, "axe-wrong", monteCarlo());
  await page.evaluate(source);
  await page.evaluate(() => document.querySelector("main")!.append(document.createElement("button")));
  expect((await violations(page)).map((text) => text.split(":")[0])).toContain("button-name");
});

test("the keys' help has a name and nothing for axe", async ({ page }) => {
  await open(page, "axe-keys", run());
  await page.evaluate(source);
  await page.getByRole("button", { name: "Keys" }).click();
  await expect(page.getByRole("dialog", { name: "Keys" })).toBeVisible();
  expect(await violations(page)).toEqual([]);
});
