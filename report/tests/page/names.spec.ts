// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects may have any name, also those that the page has for something else.
import { pathToFileURL } from "node:url";
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { comparisonReport } from "../comparison_documents.ts";
import { eventfulReport } from "../eventful.ts";
import { open, openAllTabs, placeOf, probe, shownPose } from "./report.ts";

/** Names that an object of the reports has, and those that take their place. */
const NEW: readonly (readonly [string, string])[] = [["tea-box", "camera"], ["cracker-box", "filter"], ["late-cup", "odometry"]];
const renamed = (report: JsonObject): JsonObject => JSON.parse(NEW.reduce((text, [from, to]) => text.replaceAll(from, to), JSON.stringify(report))) as JsonObject;

const selected = (page: Page) => probe<string>(page, "selected");
const hash = (page: Page) => page.evaluate(() => location.hash);
const row = (page: Page, name: string) => page.locator(`#state tr[data-entity="${name}"]`);
const card = (page: Page, name: string) => page.locator(`.card[data-entity="${name}"]`);
const enter = (page: Page, text: string) => page.evaluate((to) => void (location.hash = to), text);

test("an object called camera and the camera are selected, hidden and told apart", async ({ page }) => {
  const complaints = await open(page, "names", renamed(eventfulReport()));
  await row(page, "camera").locator("td").first().click();
  expect(await selected(page)).toBe("camera");
  await expect(card(page, "camera")).toHaveAttribute("aria-current", "true");
  await expect(card(page, "the camera")).not.toHaveAttribute("aria-current", "true");
  await row(page, "the camera").locator("td").first().click();
  expect(await selected(page)).toBe("the camera");
  await expect.poll(() => hash(page)).toBe("#object=the+camera");
  await expect(page.locator("#state tr[aria-current]")).toHaveCount(1);
  const [object, camera] = [await shownPose(page, "camera"), await shownPose(page, "the camera")];
  expect(object!.position).not.toEqual(camera!.position);
  await page.getByRole("button", { name: "Hide camera", exact: true }).click();
  await expect.poll(() => hash(page)).toBe("#object=the+camera&hide=camera");
  expect(await shownPose(page, "camera")).toBeUndefined();
  expect(await shownPose(page, "the camera")).toEqual(camera);
  await page.getByRole("button", { name: "Show camera alone, or all", exact: true }).click();
  expect(await shownPose(page, "camera")).toEqual(object);
  expect(await shownPose(page, "mug")).toBeUndefined();
  await openAllTabs(page);
  expect(complaints).toEqual([]);
});

test("addresses have both, and links of runs without such an object are as they were", async ({ page }) => {
  await open(page, "names-address", renamed(eventfulReport()));
  for (const name of ["camera", "the camera", "odometry", "filter"]) {
    await enter(page, `object=${encodeURIComponent(name)}&hide=the+camera`);
    await expect.poll(() => selected(page)).toBe(name);
    expect(await shownPose(page, "camera")).toBeDefined();
    // What is hidden is the real one.
    await expect(row(page, "camera")).not.toHaveClass(/hidden/);
  }
  await open(page, "names-plain", eventfulReport());
  await page.goto("about:blank");
  await page.goto(`${pathToFileURL(placeOf("names-plain")).href}#object=camera`);
  await page.waitForSelector("html[data-ready]");
  expect(await selected(page)).toBe("camera");
  await expect(row(page, "the camera")).toHaveCount(0);
});

test("lists, numbers and copied poses mean the right one", async ({ page }) => {
  await page.setViewportSize({ width: 1440, height: 900 });
  await open(page, "names-lists", renamed(eventfulReport()));
  await page.getByRole("tab", { name: "Errors" }).click();
  const of = page.getByRole("combobox", { name: "Pose of" }).first();
  expect(await of.locator("option").allTextContents()).toEqual(["the camera", "mug", "camera", "filter", "odometry", "cart"]);
  for (const name of ["camera", "the camera"]) {
    await of.selectOption({ label: name });
    expect(await selected(page)).toBe(name);
  }
  await page.getByRole("tab", { name: "Numbers" }).click();
  // The rows "filter" and "odometry alone" of the camera's table are not those objects.
  const cameraRows = page.locator("#metrics table", { hasText: "Camera in the world" }).locator("tbody tr");
  await cameraRows.first().click();
  expect(await selected(page)).toBe("the camera");
  await expect(cameraRows.first()).not.toHaveClass(/linked/);
  const ofCamera = page.locator("#metrics table", { hasText: "Consistency of the camera" }).locator("tbody tr");
  await expect(ofCamera).toHaveAttribute("aria-current", "true");
  await page.locator("#metrics tr[data-entity=camera] td").first().click();
  expect(await selected(page)).toBe("camera");
  await expect(ofCamera).not.toHaveAttribute("aria-current", "true");
  await page.locator("#metrics tr[data-entity=filter] td").first().click();
  expect(await selected(page)).toBe("filter");
});

test("the frame of a copied pose is not the object of its name", async ({ page }) => {
  // A headless browser has no clipboard to read.
  await page.addInitScript(() => Object.defineProperty(navigator, "clipboard", {
    value: { writeText: (text: string) => Promise.resolve(void (document.body.dataset["copied"] = text)) },
  }));
  await open(page, "names-copy", renamed(eventfulReport()));
  await page.getByLabel("Poses in").selectOption("camera");
  await page.getByRole("button", { name: "Copy the pose of camera", exact: true }).click();
  await page.getByRole("menuitem", { name: "ROS YAML" }).click();
  await expect(page.locator("body")).toHaveAttribute("data-copied", /# "camera" in "the camera"[^]*frame_id: "the camera"/);
});

test("runs are compared, and their objects chosen, whatever these are called", async ({ page }) => {
  const complaints = await open(page, "names-comparison", renamed(comparisonReport()));
  await page.getByRole("tab", { name: "Errors" }).click();
  const of = page.getByRole("combobox", { name: "Errors of" });
  const title = page.locator(".chart figcaption").first();
  await of.selectOption({ label: "camera" });
  await expect(title).toContainText("camera from the camera: position");
  await expect.poll(() => selected(page)).toBe("camera");
  await of.selectOption({ label: "the camera" });
  await expect(title).toContainText("camera in the world: position");
  await page.getByRole("tab", { name: "Metrics" }).click();
  const heads = await page.locator("table.metrics tr.first").allTextContents();
  expect(new Set(heads).size).toBe(heads.length);
  expect(heads).toEqual(expect.arrayContaining(["camera in the world", "camera from the camera"]));
  expect(complaints).toEqual([]);
});
