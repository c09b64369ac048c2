// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Names and texts of strangers are shown as text, and the page's policy lets no script of theirs run.
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { comparisonReport } from "../comparison_documents.ts";
import { eventfulReport } from "../eventful.ts";
import { monteCarlo, noise } from "../study_documents.ts";
import { open, openAllTabs } from "./report.ts";

const HOSTILE = "</script><img src=x onerror=\"pwned=1\"><script>pwned=1</script><svg onload='pwned=1'>&amp;${pwned=1}\u2028\u2029\u001b]0;x\u0007\u202e";

/** Puts the hostile text behind words, wherever a report has them. */
function spoiled(report: JsonObject, words: readonly string[]): JsonObject {
  const escaped = JSON.stringify(HOSTILE).slice(1, -1);
  const text = words.reduce((all, word) => all.replaceAll(`"${word}"`, `"${word}${escaped}"`), JSON.stringify(report));
  return { ...(JSON.parse(text) as JsonObject), title: `Title ${HOSTILE}`, program: `posemix ${HOSTILE}` };
}

async function expectHarmless(page: Page, complaints: string[]) {
  await openAllTabs(page);
  expect(await page.evaluate(() => "pwned" in window)).toBe(false);
  await expect(page.locator("[onerror], [onload], img[src=x]")).toHaveCount(0);
  // The one of the page itself.
  await expect(page.locator("script:not([type])")).toHaveCount(1);
  await expect(page.locator("h1")).toContainText("<script>pwned=1</script>");
  expect(complaints).toEqual([]);
}

test("names of objects and of the method in a run are text", async ({ page }) => {
  const complaints = await open(page, "hostile-run", spoiled(eventfulReport(), ["tea-box", "mug", "cart"]));
  await expectHarmless(page, complaints);
  await expect(page.locator("#state tbody")).toContainText("tea-box</script><img src=x");
});

test("names of objects in a comparison are text", async ({ page }) => {
  await expectHarmless(page, await open(page, "hostile-comparison", spoiled(comparisonReport(), ["tea-box", "mug"])));
});

test("rows, units, notes, settings, tables, figures and texts of a study are text", async ({ page }) => {
  for (const [name, made] of [["monte-carlo", monteCarlo()], ["noise", noise()]] as const) {
    const words = ["riekf", "midway", "dope", "mug", "deg", "out dir/x", "data/sha256sums", "errors.svg", "paired.csv", "report.md", "# Figures\n"];
    const report = spoiled(made, words);
    const study = (report["documents"] as Record<string, JsonObject>)["study.json"]!;
    Object.assign(study, { description: HOSTILE, notes: [HOSTILE, "plain"] });
    Object.assign(report, { texts: { "report.md": `# ${HOSTILE}\n[link](javascript:pwned=1) ![x](x)\n` } });
    await expectHarmless(page, await open(page, `hostile-${name}`, report));
  }
});

test("a link of a study leads to no script", async ({ page }) => {
  const report = monteCarlo();
  const study = (report["documents"] as Record<string, JsonObject>)["study.json"]!;
  for (const row of study["rows"] as JsonObject[]) row["report"] = "javascript:pwned=1";
  await open(page, "hostile-link", report);
  await openAllTabs(page);
  await expect(page.locator("a[href^=javascript]")).toHaveCount(0);
});

test("a drawing of strangers runs nothing and asks nobody", async ({ page }) => {
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9" onload="parent.pwned=1"><script>parent.pwned=1</script><image href="https://example.org/x.png"/></svg>`;
  const report = { ...monteCarlo(), pictures: { "errors.svg": svg } };
  const complaints = await open(page, "hostile-drawing", report);
  await openAllTabs(page);
  expect(await page.evaluate(() => "pwned" in window)).toBe(false);
  expect(complaints.filter((text) => text.includes("example.org"))).toEqual([]);
});

test("the page's policy stops scripts, handlers, styles and requests that are brought in", async ({ page }) => {
  await open(page, "hostile-policy", eventfulReport());
  const blocked = await page.evaluate(async () => {
    const directives = new Set<string>();
    document.addEventListener("securitypolicyviolation", (event) => directives.add(event.effectiveDirective));
    const script = document.createElement("script");
    script.textContent = "window.pwned = 1";
    document.body.append(script);
    const frame = document.createElement("div");
    frame.innerHTML = "<b style='color:red' onclick='window.pwned=1'>x</b><style>b{color:red}</style><img src='https://example.org/x.png'><form action='https://example.org/'></form>";
    document.body.append(frame);
    frame.querySelector("b")!.click();
    frame.querySelector("form")!.submit();
    await fetch("https://example.org/").catch(() => undefined);
    await new Promise((done) => setTimeout(done, 200));
    return [...directives].sort();
  });
  expect(await page.evaluate(() => "pwned" in window)).toBe(false);
  expect(blocked).toEqual(["connect-src", "form-action", "img-src", "script-src-attr", "script-src-elem", "style-src-attr", "style-src-elem"]);
});
