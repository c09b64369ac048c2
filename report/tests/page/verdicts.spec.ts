// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// One verdict on every pose: of card, overview and the tab on consistency.
import { expect, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { eventfulMetrics, eventfulReport, IDS } from "../eventful.ts";
import { open } from "./report.ts";

const judged = (verdict: string, anees: number, reason: string): JsonObject => ({ verdict, reason, anees, interval: [anees * 0.8, anees * 1.25], effective_frames: 41.5 });

function withVerdicts(): JsonObject {
  const metrics = eventfulMetrics();
  metrics["consistency"] = {
    camera_verdict: judged("cautious", 0.6, "most along position z"),
    relative_verdicts: { "mug": judged("overconfident", 1.6, "2.1 % of position x outside 3 sigma"), "tea-box": judged("overconfident", 9, "22 % of rotation z outside 3 sigma"), "late-cup": null },
  };
  return metrics;
}

const WORDS = { "camera": "! cautious", "mug": "! slightly overconfident", "tea-box": "✗ overconfident" } as const;

test("card, overview and consistency say the program's verdict", async ({ page }) => {
  await open(page, "verdicts", eventfulReport({}, { documents: { "metrics.json": withVerdicts() } }));
  for (const [name, words] of Object.entries(WORDS)) {
    await expect(page.locator(`.card[data-entity="${name}"] .verdict`)).toHaveText(words);
    await expect(page.locator(`.card[data-entity="${name}"] .reason`)).toContainText("from 41.5 independent frames");
    await expect(page.locator(".summary")).toContainText(new RegExp(`${words}: [^;]*${name}`));
  }
  await page.getByRole("tab", { name: "Consistency" }).click();
  for (const [name, words] of Object.entries(WORDS)) {
    await page.getByRole("combobox", { name: "Pose of" }).last().selectOption({ label: name });
    const findings = page.locator("[role=tabpanel]:not([hidden]) .findings");
    await expect(findings.locator("li").first()).toHaveText(new RegExp(`^${words.slice(2)}: .* say as much as 41.5 independent ones`, "i"));
    await expect(findings).not.toContainText("no direction is overconfident");
  }
});

for (const nees of [true, false]) {
  test(`without the program's verdict card and tab agree on every pose ${nees ? "" : "and no NEES"}`, async ({ page }) => {
    await open(page, `verdicts-own-${nees}`, eventfulReport({ nees }));
    const words = new Map<string, string>();
    for (const name of ["camera", ...IDS]) words.set(name, (await page.locator(`.card[data-entity="${name}"] .verdict`).textContent())!.slice(2));
    await page.getByRole("tab", { name: "Consistency" }).click();
    for (const [name, word] of words) {
      await page.getByRole("combobox", { name: "Pose of" }).last().selectOption({ label: name });
      await expect(page.locator("[role=tabpanel]:not([hidden]) .findings li").first()).toHaveText(new RegExp(`^${word}: `, "i"));
    }
  });
}
