// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What the scene of a page says of itself.
import type { Locator, Page } from "@playwright/test";

export const scene = <T>(page: Page, name: string): Promise<T> => page.evaluate((key) => (window.posemix!["scene"] as Record<string, T>)[key], name);
export const canvas = (page: Page): Locator => page.locator(".slam .stage .viewport canvas").first();
export const drawn = (page: Page): Promise<unknown> => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
