// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Overview, events, one selection in the tables, the timeline on a phone.
import { expect, type Page, test } from "@playwright/test";
import { fixed } from "../../src/ui/numbers.ts";
import { comparisonReport } from "../comparison_documents.ts";
import { AT, eventfulReport, eventfulTrace, FRAMES, IDS, SD } from "../eventful.ts";
import { packTrace } from "../pack.ts";
import { boxOf, open, openAllTabs, probe, scrub, shownPose } from "./report.ts";

interface ShownEvent {
  kind: string;
  entity: number;
  from: number;
  to: number;
}

const selected = (page: Page) => probe<string>(page, "selected");
const frame = (page: Page) => probe<number>(page, "frame");
const row = (page: Page, id: string) => page.locator(`#state tr[data-entity="${id}"]`);
const card = (page: Page, id: string) => page.locator(`.card[data-entity="${id}"]`);

/** Keeps what the page copies, for a headless browser has no clipboard to read. */
async function watchClipboard(page: Page): Promise<() => Promise<string>> {
  await page.addInitScript(() => {
    Object.defineProperty(navigator, "clipboard", {
      value: { writeText: (text: string) => ((window as unknown as { copied: string }).copied = text, Promise.resolve()) },
    });
  });
  return () => page.evaluate(() => (window as unknown as { copied: string }).copied);
}

test("the overview is open first, says what went wrong, and its cards are the poses at the playhead", async ({ page }) => {
  const trace = eventfulTrace();
  const complaints = await open(page, "overview", eventfulReport());
  await expect(page.getByRole("tab", { name: "Overview" })).toHaveAttribute("aria-selected", "true");
  await expect(page.locator(".summary")).toContainText("300 frames in 29.90 s");
  await expect(page.locator(".summary")).toContainText("Camera: rms error 5.88 mm and 0.758 deg. Odometry alone has 45.1 mm");
  await expect(page.locator(".troubles li")).toHaveCount(3);
  await expect(page.locator(".troubles li", { hasText: "late-cup" })).toContainText("lost for 4.00 s, first at 20.00 s");
  expect(await page.locator(".card").first().getAttribute("data-entity")).toBe("tea-box");
  for (const at of [0, 70]) {
    await scrub(page, at);
    const p = trace.objects["mug"].world.pose[at]!;
    await expect(card(page, "mug").locator(".numbers").first()).toContainText(`${[0, 1, 2].map((i) => fixed(p[i], 3)).join(", ")} m`);
    await expect(card(page, "mug").locator(".numbers small").first()).toHaveText(`± ${fixed(3000 * SD[3], 2)}, ${fixed(3000 * SD[4], 2)}, ${fixed(3000 * SD[5], 1)} mm`);
    const mode = trace.objects["tea-box"].mode_probability![at]!;
    await expect(card(page, "tea-box")).toContainText(`${fixed(100 * mode, 1)} % by the filter's own belief`);
  }
  await scrub(page, 0);
  await expect(card(page, "tea-box").locator(".hypotheses li")).toHaveText(["as is: 57 %", /^turned (17\d|180) deg about z, 1\d\.\d mm apart: 43 %$/]);
  await expect(card(page, "late-cup").locator(".hypotheses li")).toHaveText(["none"]);
  await openAllTabs(page);
  expect(complaints).toEqual([]);
});

test("cards select, and their links go to the moment", async ({ page }) => {
  await open(page, "overview-cards", eventfulReport());
  await card(page, "mug").locator("dl").click({ position: { x: 5, y: 5 } });
  expect(await selected(page)).toBe("mug");
  await expect(card(page, "mug")).toHaveAttribute("aria-current", "true");
  await expect(card(page, "tea-box")).not.toHaveAttribute("aria-current", "true");
  await card(page, "tea-box").locator("dd", { hasText: "flip or jump" }).getByRole("button").click();
  expect([await selected(page), await frame(page)]).toEqual(["tea-box", AT.flip]);
  await page.locator(".troubles li", { hasText: "cracker-box" }).getByRole("button", { name: "14.00 s" }).click();
  expect([await selected(page), await frame(page)]).toEqual(["cracker-box", AT.unexplained[0]]);
  const spark = card(page, "camera").locator(".spark");
  const box = await boxOf(spark);
  await spark.click({ position: { x: box.width / 2, y: 10 } });
  expect(Math.abs((await frame(page)) - (FRAMES - 1) / 2)).toBeLessThan(2);
});

test("without ground truth nothing is called an error", async ({ page }) => {
  await open(page, "overview-no-truth", eventfulReport({ truth: false }));
  await expect(page.locator(".summary")).toContainText("There is no ground truth");
  await expect(card(page, "mug").locator(".verdict")).toContainText("innovations as expected");
  await expect(card(page, "camera").locator(".verdict")).toContainText("not known");
  await expect(page.locator(".card", { hasText: "error" })).toHaveCount(0);
  await page.getByRole("tab", { name: "Numbers" }).click();
  await expect(page.locator("#metrics table")).toHaveCount(1);
});

test("events are a list that filters, jumps and selects", async ({ page }) => {
  await open(page, "events", eventfulReport());
  const events = await probe<ShownEvent[]>(page, "events");
  await page.getByRole("tab", { name: "Events" }).click();
  const rows = page.locator(".events tbody tr");
  await expect(rows).toHaveCount(events.length);
  await rows.locator("xpath=self::*[@data-kind='unexplained']").locator(".what").click();
  expect([await selected(page), await frame(page)]).toEqual(["cracker-box", AT.unexplained[0]]);
  await expect(rows.locator("xpath=self::*[@data-kind='unexplained']")).toHaveClass(/now/);
  await page.getByRole("checkbox", { name: "entered" }).uncheck();
  await expect(rows).toHaveCount(events.filter(({ kind }) => kind !== "entered").length);
  await page.getByLabel("Object", { exact: true }).last().selectOption({ label: "late-cup" });
  await expect(rows).toHaveCount(events.filter(({ kind, entity }) => kind !== "entered" && entity === IDS.indexOf("late-cup")).length);
});

test("n and p go from event to event, with shift of the selected object", async ({ page }) => {
  await open(page, "events-keys", eventfulReport());
  const events = await probe<ShownEvent[]>(page, "events");
  await page.getByRole("tab", { name: "Events" }).click();
  const starts = [...new Set(events.map(({ from }) => from))].filter((from) => from > 0);
  for (const from of starts.slice(0, 3)) {
    await page.keyboard.press("n");
    expect(await frame(page)).toBe(from);
  }
  await page.keyboard.press("p");
  expect(await frame(page)).toBe(starts[1]);
  await row(page, "late-cup").getByRole("button", { name: "late-cup", exact: true }).click();
  await page.keyboard.press("Shift+N");
  expect([await selected(page), await frame(page)]).toEqual(["late-cup", AT.lost[0]]);
  await page.keyboard.press("Shift+P");
  expect(await frame(page)).toBe(AT.enters);
});

test("keys work after a press anywhere: tab, list, link", async ({ page }) => {
  await open(page, "keys-anywhere", eventfulReport());
  await page.getByRole("tab", { name: "Events" }).click();
  await page.keyboard.press(".");
  expect(await frame(page)).toBe(1);
  await page.keyboard.press("Space");
  await expect(page.getByRole("button", { name: "Pause" })).toBeVisible();
  await page.keyboard.press("Space");
  await expect(page.getByRole("button", { name: "Play" })).toBeVisible();
  await page.getByLabel("Poses in").selectOption("camera");
  await page.keyboard.press("Home");
  await page.getByText("Poses at this frame").click();
  const before = await frame(page);
  await page.keyboard.press("l");
  expect(await frame(page)).toBe(before + 10);
});

test("a press on a strip goes there and selects its object", async ({ page }) => {
  await open(page, "strips", eventfulReport());
  const canvas = page.locator(".strips canvas");
  await expect(canvas).toHaveAttribute("aria-label", /Mode probability of 5 objects/);
  const box = await boxOf(canvas);
  const bar = await boxOf(page.getByRole("slider", { name: "Frame" }));
  expect(box.x >= bar.x && box.x + box.width <= bar.x + bar.width).toBe(true);
  await canvas.click({ position: { x: box.width * 0.5, y: ((IDS.indexOf("late-cup") + 0.5) / IDS.length) * box.height } });
  expect(await selected(page)).toBe("late-cup");
  expect(Math.abs((await frame(page)) - (FRAMES - 1) / 2)).toBeLessThan(3);
  await scrub(page, 205);
  await expect(page.locator(".strips .now")).toHaveText("late-cup: lost for 4.00 s, then found again");
});

test("rows of the table select, hide and solo", async ({ page }) => {
  await open(page, "rows", eventfulReport());
  await row(page, "mug").locator("td").first().click();
  expect(await selected(page)).toBe("mug");
  await expect(row(page, "mug")).toHaveAttribute("aria-current", "true");
  await row(page, "mug").getByRole("button", { name: "Hide mug" }).click();
  expect(await shownPose(page, "mug")).toBeUndefined();
  await row(page, "mug").getByRole("button", { name: "Show mug", exact: true }).click();
  expect(await shownPose(page, "mug")).toBeDefined();
  await row(page, "cart").getByRole("button", { name: "Show cart alone, or all" }).click();
  expect(await shownPose(page, "mug")).toBeUndefined();
  expect(await shownPose(page, "cart")).toBeDefined();
  await row(page, "cart").getByRole("button", { name: "Show cart alone, or all" }).click();
  expect(await shownPose(page, "mug")).toBeDefined();
});

test("poses in the table: three sigmas, rotation as chosen, as seen from the camera, copied", async ({ page }) => {
  const copied = await watchClipboard(page);
  const trace = eventfulTrace();
  await open(page, "copy", eventfulReport());
  await scrub(page, 70);
  const cells = row(page, "mug").locator("td");
  const world = trace.objects["mug"].world.pose[70]!;
  await expect(cells.nth(0)).toHaveText(`${fixed(world[0], 4)}± 6.00`);
  await expect(cells.nth(3).locator("small")).toHaveText("± 1.72, 1.72, 2.58");
  await page.getByLabel("rotation as").selectOption("quaternion");
  await expect(cells.nth(3).locator("span")).toHaveText(world.slice(3).map((value) => fixed(world[6] < 0 ? -value : value, 4)).join(", "));
  await page.getByLabel("Poses in").selectOption("camera");
  const seen = trace.objects["mug"].relative.pose[70]!;
  await expect(cells.nth(2).locator("span")).toHaveText(fixed(seen[2], 4));
  await expect(row(page, "camera").locator("td").first()).toHaveText("–");
  await row(page, "mug").getByRole("button", { name: "Copy the pose of mug" }).click();
  await page.getByRole("menuitem", { name: "tx ty tz" }).click();
  const numbers = (await copied()).split(" ").map(Number);
  // A quaternion and its negative are one rotation.
  const sign = Math.sign(numbers[6] * seen[6]);
  seen.forEach((value, i) => expect(Math.abs(numbers[i] - (i < 3 ? 1 : sign) * value)).toBeLessThan(1e-4));
  await row(page, "mug").getByRole("button", { name: "Copy the pose of mug" }).click();
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  expect(await copied()).toContain('frame_id: "camera"');
  await expect(page.locator(".state [role=status]")).toHaveText("Copied mug as ROS YAML.");
});

test("the theme is kept, and a browser that keeps nothing does no harm", async ({ page }) => {
  await open(page, "theme", eventfulReport());
  await page.getByRole("button", { name: "Use dark colours" }).click();
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  expect(await page.evaluate(() => document.documentElement.dataset["theme"])).toBe("dark");
  await expect(page.getByRole("button", { name: "Use light colours" })).toBeVisible();
  await page.addInitScript(() => Object.defineProperty(window, "localStorage", { get: () => { throw new Error("refused"); } }));
  const complaints = await open(page, "theme", eventfulReport());
  await page.getByRole("button", { name: "Use dark colours" }).click();
  expect(await page.evaluate(() => document.documentElement.dataset["theme"])).toBe("dark");
  expect(complaints).toEqual([]);
});

test("on a phone the timeline is in sight in every tab, wherever the page is scrolled to", async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await open(page, "phone-timeline", eventfulReport());
  for (const tab of await page.getByRole("tab").all()) {
    await tab.click();
    for (const share of [0, 0.5, 1]) {
      await page.evaluate((part) => scrollTo(0, part * (document.documentElement.scrollHeight - innerHeight - 80)), share);
      const box = await boxOf(page.getByRole("slider", { name: "Frame" }));
      expect(box.y).toBeGreaterThan(0);
      expect(box.y + box.height).toBeLessThanOrEqual(844);
      expect(box.x + box.width).toBeLessThanOrEqual(390);
    }
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
  }
});

for (const [width, height] of [[844, 390], [1024, 768]] as const) {
  test(`at ${width} x ${height} the timeline is in sight, wherever the page is scrolled to`, async ({ page }) => {
    await page.setViewportSize({ width, height });
    await open(page, `timeline-${width}`, eventfulReport());
    for (const share of [0, 0.5, 1]) {
      await page.evaluate((part) => scrollTo(0, part * (document.documentElement.scrollHeight - innerHeight - 80)), share);
      await expect(page.getByRole("slider", { name: "Frame" })).toBeInViewport({ ratio: 1 });
      await expect(page.getByRole("button", { name: "Play" })).toBeInViewport({ ratio: 1 });
    }
    await page.evaluate(() => scrollTo(0, 0));
    const scene = await boxOf(page.locator(".viewport").first());
    const player = await boxOf(page.locator(".player"));
    expect(player.y - scene.y).toBeGreaterThan(0.45 * height);
  });
}

test("of several runs the timeline is in sight on a small screen, wherever the columns are", async ({ page }) => {
  await page.setViewportSize({ width: 1366, height: 768 });
  await open(page, "timeline-comparison", comparisonReport());
  for (const at of [0, 200, 500]) {
    await page.evaluate((y) => scrollTo(0, y), at);
    await expect(page.getByRole("slider", { name: "Frame" })).toBeInViewport({ ratio: 1 });
  }
});

test("the table of poses fits its column, or has a shadow where it goes on", async ({ page }) => {
  await page.setViewportSize({ width: 1366, height: 768 });
  const json = eventfulTrace();
  for (const id of IDS) for (const key of ["existence", "health", "register_again", "models", "model_names"] as const) delete json.objects[id][key];
  await open(page, "poses-fit", eventfulReport({}, { trace: packTrace(json) as never }));
  const scroll = page.getByRole("region", { name: "Poses at this frame" });
  expect(await scroll.evaluate((node) => node.scrollWidth - node.clientWidth)).toBeLessThanOrEqual(0);
  await expect(page.getByRole("columnheader", { name: "mode probability" }).first()).toBeInViewport({ ratio: 1 });
  await open(page, "poses-scroll", eventfulReport());
  expect(await scroll.evaluate((node) => getComputedStyle(node).backgroundAttachment)).toBe("local, local, scroll, scroll");
});

test("on a small screen the poses of the first rows are seen without scrolling", async ({ page }) => {
  await page.setViewportSize({ width: 1366, height: 768 });
  await open(page, "small-screen", eventfulReport());
  for (const cell of [row(page, "mug").locator("th"), row(page, "mug").locator("td").nth(3)]) await expect(cell).toBeInViewport({ ratio: 1 });
  await row(page, "cart").scrollIntoViewIfNeeded();
  await expect(row(page, "cart")).toBeInViewport();
});

test("numbers: no column of dashes, words for what is shown, and rows that select", async ({ page }) => {
  await page.setViewportSize({ width: 1440, height: 900 });
  await open(page, "numbers", eventfulReport());
  await page.getByRole("tab", { name: "Numbers" }).click();
  await expect(page.getByRole("columnheader", { name: "reduction" })).toHaveCount(0);
  await expect(page.getByRole("columnheader", { name: "not explained" })).toHaveAttribute("title", /doubted, birth or gated/);
  await page.getByText("Words", { exact: true }).click();
  await expect(page.locator(".words dt", { hasText: "not explained" }).first()).toBeVisible();
  await page.locator("#metrics tr[data-entity=cart] td").first().click();
  expect(await selected(page)).toBe("cart");
  const overflow = await page.locator("#metrics .scroll").evaluateAll((nodes) => nodes.filter((node) => node.scrollWidth > node.clientWidth + 1).length);
  expect(overflow).toBe(0);
});
