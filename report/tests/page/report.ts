// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Opens pages with given data, from a file, as a reader does.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { expect, type Locator, type Page } from "@playwright/test";
import { fill } from "../folder.ts";

const root = path.join(path.dirname(fileURLToPath(import.meta.url)), "..", "..");

/** Where the page of a name is written. */
export function placeOf(name: string): string {
  return path.join(root, "test-results", "pages", `${name}.html`);
}

function write(name: string, payload: unknown): string {
  const target = placeOf(name);
  mkdirSync(path.dirname(target), { recursive: true });
  const template = readFileSync(path.join(root, "dist", "report.html"), "utf8");
  writeFileSync(target, payload === undefined ? template : fill(template, payload));
  return target;
}

/** Everything that the page complained about, or asked another place for. */
export function watch(page: Page): string[] {
  const complaints: string[] = [];
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`request of ${request.url()}`);
  });
  return complaints;
}

export async function open(page: Page, name: string, payload: unknown): Promise<string[]> {
  const complaints = watch(page);
  await page.goto(pathToFileURL(write(name, payload)).href);
  await page.waitForSelector("html[data-ready]");
  return complaints;
}

/** Moves the timeline, as dragging its thumb does. */
export async function scrub(page: Page, frame: number): Promise<void> {
  await page.getByRole("slider", { name: "Frame" }).evaluate((bar: HTMLInputElement, to) => {
    bar.value = String(to);
    bar.dispatchEvent(new Event("input"));
  }, frame);
}

export async function openAllTabs(page: Page): Promise<void> {
  for (const tab of await page.getByRole("tab").all()) {
    await tab.click();
    await expect(tab).toHaveAttribute("aria-selected", "true");
  }
}

/** A value of window.posemix. */
export function probe<T>(page: Page, name: string): Promise<T> {
  return page.evaluate((key) => window.posemix![key] as T, name);
}

export interface ShownPose {
  position: number[];
  quaternion: number[];
}

export function shownPose(page: Page, id: string): Promise<ShownPose | undefined> {
  return page.evaluate((name) => (window.posemix!["pose"] as (id: string) => ShownPose | undefined)(name), id);
}

/** Selects an object by the address, as of a link; a page opens on the most uncertain one. */
export async function selectObject(page: Page, id: string): Promise<void> {
  await page.evaluate((name) => (location.hash = `object=${encodeURIComponent(name)}`), id);
  await expect.poll(() => probe(page, "selected")).toBe(id);
}

/** The box of an element once it stands still: two drawn frames later it is the same. */
export async function boxOf(locator: Locator): Promise<{ x: number; y: number; width: number; height: number }> {
  const read = async () => {
    const box = await locator.boundingBox();
    await locator.page().evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return box;
  };
  let box = await read();
  for (;;) {
    const next = await read();
    if (box && next && JSON.stringify(next) === JSON.stringify(box)) return box;
    box = next;
  }
}
