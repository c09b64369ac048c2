// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Mixtures, on their own and at the end of a run.
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { colourOf } from "../../src/ui/palette.ts";
import { mug, projected } from "../documents.ts";
import { FRAMES, sceneReport } from "../scene_run.ts";
import { open, probe, scrub, selectObject } from "./report.ts";

test.describe.configure({ timeout: 240_000 });

interface Shown { labels: { text: string }[]; scale: { metres: number; pixels: number }; step: number; top: [number, number][] }

const many = Array.from({ length: 16 }, (_, i) => 1 + ((5 * i) % 16));

function report(): JsonObject {
  const one = mug["components"][0];
  const documents = {
    "many.json": { ...mug, components: many.map((weight, i) => ({ ...one, weight: weight / 136, mean: { ...one.mean, translation: [40 * i, 0, 800] } })) },
    "peaks.json": { ...projected(0.02, [[0, 0, 0, 1], [0.3, 0, 0, 0.954], [-0.3, 0, 0, 0.954]]), frames: { from: "camera", to: "box" } },
  };
  return { schema: 1, type: "posemix.report", kind: "mixture", title: "Many", program: "", documents, tables: {}, pictures: {}, texts: {} };
}

test("the table is sorted by weight with its sum; nothing is cut; all flags are in the picture, which has a scale", async ({ page }) => {
  const complaints = await open(page, "mixtures", report());
  const numbers = await page.locator("table.components tbody th").allTextContents();
  const order = many.map((_, i) => i).sort((a, b) => many[b] - many[a]);
  expect(numbers).toEqual(order.map((k) => String(k + 1)));
  const sums = await page.locator("table.components tbody td:nth-child(3)").allTextContents();
  let sum = 0;
  expect(sums).toEqual(order.map((k) => (100 * ((sum += many[k] / 136))).toFixed(1)));
  for (const width of [1440, 1100, 390]) {
    await page.setViewportSize({ width, height: 780 });
    const region = page.getByRole("region", { name: "Components" });
    expect(await region.evaluate((node) => node.scrollWidth - node.clientWidth)).toBeLessThanOrEqual(0);
  }
  await page.setViewportSize({ width: 1100, height: 720 });
  await page.waitForTimeout(300);
  const { top, scale, step } = await probe<Shown>(page, "scene");
  const [width, height] = await page.locator(".viewport").evaluate((node) => [node.clientWidth, node.clientHeight]);
  expect(top).toHaveLength(800);
  expect(top.filter(([x, y]) => x < 0 || y < 0 || x > width || y > height)).toEqual([]);
  expect(scale.pixels).toBeGreaterThan(20);
  await expect(page.locator(".mixture .hint").first()).toContainText(`Grid: ${100 * step} cm`);
  // Twelve have a box of their own, the lightest four share one.
  await expect(page.getByRole("group", { name: "Components" }).locator("label")).toHaveText([...order.slice(0, 12).map((k) => String(k + 1)), "the other 4"]);
  await page.getByLabel("the other 4").uncheck();
  const flags = await probe<number>(page, "flags");
  const share = order.slice(12).reduce((total, k) => total + many[k] / 136, 0);
  expect(Math.abs(flags - 400 * (1 - share))).toBeLessThan(25);
  expect(complaints).toEqual([]);
});

test("the marginal opens on the axis about which there are peaks, or shows all three", async ({ page }) => {
  await open(page, "mixtures-marginal", report());
  await page.getByRole("combobox", { name: "Mixture", exact: true }).selectOption({ label: "box (peaks.json)" });
  const axis = page.getByRole("combobox", { name: "Axis", exact: true });
  await expect(axis).toHaveValue("0");
  await expect(page.locator("figcaption")).toHaveText(["angle about x, probability per degree"]);
  await expect(page.locator(".marginal p.hint")).toContainText("about x there is most to see");
  await axis.selectOption("all three");
  await expect(page.locator("figcaption")).toHaveText(["x", "y", "z"].map((name) => `angle about ${name}, probability per degree`));
});

const ofRun = (): JsonObject => ({
  ...sceneReport(),
  documents: {
    "mixture_mug.json": { ...mug, frames: { from: "world", to: "mug" } },
    "mixture_tea-box.json": { ...projected(0.05, [[0, 0, 0, 1], [0, 0, 1, 0]]), frames: { from: "world", to: "tea-box" } },
  },
});

const table = (page: Page) => page.locator("table.components caption");

test("in a run they say that they are of the last frame, and follow the selection", async ({ page }) => {
  await open(page, "mixtures-run", ofRun());
  await selectObject(page, "mug");
  await page.getByRole("tab", { name: "Mixtures" }).click();
  await scrub(page, 10);
  await expect(page.locator(".last-frame")).toContainText("at the last frame, 5.90 s");
  await expect(page.locator(".last-frame")).toContainText(`The page shows frame 10 of ${FRAMES - 1}.`);
  await page.getByRole("button", { name: "Go to the last frame" }).click();
  expect(await probe(page, "frame")).toBe(FRAMES - 1);
  await expect(page.locator(".last-frame")).toContainText("It is the frame that the page shows.");
  await expect(table(page)).toContainText("T_world_mug");
  await page.keyboard.press("]");
  await expect(table(page)).toContainText("T_world_tea-box");
  // The object's own colour and tints of it: those of the palette are other objects'.
  const swatches = await page.locator("table.components .dot").evaluateAll((dots) => dots.map((dot) => (dot as HTMLElement).style.getPropertyValue("--swatch")));
  expect(swatches[0]).toBe(colourOf(1));
  expect(Array.from({ length: 10 }, (_, i) => colourOf(i))).not.toContain(swatches[1]);
  await page.getByRole("combobox", { name: "Mixture", exact: true }).selectOption({ label: "mug (mixture_mug.json)" });
  expect(await probe(page, "selected")).toBe("mug");
});
