// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The address of the page is its state: the whole of it, so that who opens it sees what its sender saw.
import { pathToFileURL } from "node:url";
import { expect, type Page, test } from "@playwright/test";
import { eventfulReport } from "../eventful.ts";
import { sceneReport } from "../scene_run.ts";
import { open, placeOf, probe } from "./report.ts";
import { scene } from "./scene.ts";

const button = (page: Page, name: string) => page.getByRole("button", { name, exact: true });
const tab = (page: Page, name: string) => page.getByRole("tab", { name, exact: true });
const enter = (page: Page, hash: string) => page.evaluate((text) => void (location.hash = text), hash);

test("an address that is entered replaces the whole state, an empty one too", async ({ page }) => {
  await open(page, "address", eventfulReport());
  const first = await probe<string>(page, "selected");
  const other = first === "mug" ? "cart" : "mug";
  for (const next of ["#view=top", ""]) {
    await enter(page, `#t=7&object=${other}&hide=cart&hide=camera&follow=1&tab=events&view=side`);
    await expect.poll(() => probe<number>(page, "frame")).toBe(70);
    expect(await probe<string>(page, "selected")).toBe(other);
    await expect(button(page, "Show cart")).toBeVisible();
    await expect(tab(page, "Events")).toHaveAttribute("aria-selected", "true");
    await expect(button(page, "Side")).toHaveAttribute("aria-pressed", "true");
    await enter(page, next);
    await expect.poll(() => probe<number>(page, "frame")).toBe(0);
    expect(await probe<string>(page, "selected")).toBe(first);
    await expect(button(page, "Hide cart")).toBeVisible();
    await expect(tab(page, "Overview")).toHaveAttribute("aria-selected", "true");
    await expect(page.getByRole("checkbox", { name: "Follow" })).not.toBeChecked();
    await expect(button(page, next === "" ? "All" : "Top")).toHaveAttribute("aria-pressed", "true");
    await expect.poll(() => page.evaluate(() => location.hash)).toBe(next);
  }
});

test("a page that is opened with an address hides the camera; what it does not know is as at the beginning", async ({ page }) => {
  await open(page, "address-load", eventfulReport());
  const address = pathToFileURL(placeOf("address-load")).href;
  await page.goto("about:blank");
  await page.goto(`${address}#hide=camera&hide=mug&view=sideways&tab=nowhere&t=3`);
  await page.waitForSelector("html[data-ready]");
  expect(await probe<number>(page, "frame")).toBe(30);
  await expect(button(page, "Show mug")).toBeVisible();
  await expect(button(page, "All")).toHaveAttribute("aria-pressed", "true");
  await expect(tab(page, "Overview")).toHaveAttribute("aria-selected", "true");
  await page.keyboard.press("End");
  await expect.poll(() => page.evaluate(() => location.hash)).toBe("#t=29.9&hide=camera&hide=mug");
});

const list = (page: Page, name: string) => page.getByRole("combobox", { name, exact: true });
const hash = (page: Page) => page.evaluate(() => location.hash);
const CHOICES = [["Size", "3", "1"], ["drawn", "visible", "10"], ["Covariance", "world", "object"], ["Poses in", "world", "camera"], ["rotation as", "rpy", "quaternion"]] as const;
const CHOSEN = "#sigma=1&exaggeration=10&covariance=object&poses=camera&rotation=quaternion";
const AT_FIRST = { sigma: 3, factor: 0, frame: "world" };

async function expectChoices(page: Page, which: 1 | 2): Promise<void> {
  for (const choice of CHOICES) await expect(list(page, choice[0])).toHaveValue(choice[which]);
}

test("how uncertainty is drawn, and the frame of the poses, are in the address where they are not as at the beginning", async ({ page }) => {
  await open(page, "address-look", sceneReport());
  const x = page.locator("#state tr[data-entity=mug] td").first();
  const inWorld = await x.textContent();
  for (const [name, , value] of CHOICES) await list(page, name).selectOption(value);
  await expect.poll(() => hash(page)).toBe(CHOSEN);
  expect(await scene(page, "look")).toEqual({ sigma: 1, factor: 10, frame: "object" });
  await expect(x).not.toHaveText(inWorld!);
  for (const [name, first] of CHOICES) await list(page, name).selectOption(first);
  await expect.poll(() => hash(page)).toBe("");
  await expect(x).toHaveText(inWorld!);
  // The setting of all three ellipsoids at once.
  await list(page, "Size").selectOption({ label: "1, 2, 3 sigma" });
  await expect.poll(() => hash(page)).toBe("#sigma=all");
});

test("back, forward and a sent link restore them", async ({ page }) => {
  await open(page, "address-back", sceneReport());
  await enter(page, CHOSEN);
  await expectChoices(page, 2);
  expect(await scene(page, "factor")).toBe(10);
  await enter(page, "#t=2&sigma=2&covariance=camera");
  await expect.poll(() => scene(page, "look")).toEqual({ sigma: 2, factor: 0, frame: "camera" });
  await page.goBack();
  await expectChoices(page, 2);
  await page.goBack();
  await expectChoices(page, 1);
  await page.goForward();
  await expectChoices(page, 2);
  await page.goto("about:blank");
  await page.goto(`${pathToFileURL(placeOf("address-back")).href}${CHOSEN}`);
  await page.waitForSelector("html[data-ready]");
  await expectChoices(page, 2);
  expect(await scene(page, "look")).toEqual({ sigma: 1, factor: 10, frame: "object" });
});

test("an address that is entered while the page is busy is not written over by the address before", async ({ page }) => {
  await open(page, "address-busy", sceneReport());
  // The page writes its address a moment after a change, and hears of an address that is entered only when it is at rest.
  for (const [entered, sigma] of [["#sigma=2", 2], ["#sigma=1", 1], ["#sigma=2", 2]] as const) {
    await page.evaluate(async (address) => {
      location.hash = "#sigma=all";
      await new Promise((done) => addEventListener("hashchange", done, { once: true }));
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = () => void (location.hash = address);
      port2.postMessage("enter it");
      for (const end = performance.now() + 500; performance.now() < end;);
    }, entered);
    await expect.poll(() => scene(page, "look")).toEqual({ ...AT_FIRST, sigma });
    expect(await hash(page)).toBe(entered);
  }
});

test("a bad value in an address is as at the beginning, beside good ones", async ({ page }) => {
  await open(page, "address-bad", sceneReport());
  await enter(page, CHOSEN);
  await expectChoices(page, 2);
  await enter(page, "#t=3&sigma=4&exaggeration=-10&covariance=moon&poses=object&rotation=constructor");
  await expectChoices(page, 1);
  expect(await scene(page, "look")).toEqual(AT_FIRST);
  expect(await probe<number>(page, "frame")).toBe(30);
  await enter(page, "#sigma=&exaggeration=10%00&covariance=Camera&poses=camera&poses=world");
  await expect(list(page, "Poses in")).toHaveValue("camera");
  expect(await scene(page, "look")).toEqual(AT_FIRST);
});
