// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The address of the page is its state: the whole of it, so that who opens it sees what its sender saw.
import { pathToFileURL } from "node:url";
import { expect, type Page, test } from "@playwright/test";
import { eventfulReport } from "../eventful.ts";
import { open, placeOf, probe } from "./report.ts";

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
