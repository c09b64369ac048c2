// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The views of the scene: without perspective, through the camera, the wheel, its picture, and a browser that cannot draw it.
import { readFileSync } from "node:fs";
import { expect, type Page, test } from "@playwright/test";
import { pixelOf, sceneReport, sceneTrace } from "../scene_run.ts";
import { open, probe, scrub, selectObject } from "./report.ts";
import { canvas, drawn, scene } from "./scene.ts";

// Drawing by software on a machine that does other things takes its time.
test.describe.configure({ timeout: 240_000 });

test("Top, Front and Side have no perspective and name their axes; a press on an axis looks along it", async ({ page }) => {
  await open(page, "scene-views", sceneReport());
  expect(await scene(page, "isFlat")).toBe(false);
  for (const [name, words] of [["Top", "along -z: +x to the right, +y up"], ["Front", "along +y: +x to the right, +z up"], ["Side", "along -x: +y to the right, +z up"]]) {
    await page.getByRole("button", { name, exact: true }).click();
    await expect(page.getByRole("button", { name, exact: true })).toHaveAttribute("aria-pressed", "true");
    expect(await scene(page, "isFlat")).toBe(true);
    expect((await scene<string[]>(page, "notes")).join()).toContain(words);
    // Without perspective a metre is as long everywhere as the scale says.
    await drawn(page);
    const { metres, pixels } = await scene<{ metres: number; pixels: number }>(page, "scale");
    const points = await page.evaluate(() => {
      const { point } = window.posemix!["scene"] as { point: (x: number, y: number, z: number) => number[] };
      return [point(0, 0, 0), point(1, 1, 1), point(5, 5, 5), point(6, 6, 6)];
    });
    const long = (k: number) => Math.hypot(points[k + 1][0] - points[k][0], points[k + 1][1] - points[k][1]);
    expect(Math.abs(long(0) - (Math.SQRT2 * pixels) / metres)).toBeLessThan(0.5);
    expect(Math.abs(long(2) - long(0))).toBeLessThan(0.01);
  }
  const [x, y] = (await scene<Record<string, [number, number]>>(page, "axisEnds"))["-y"];
  await canvas(page).click({ position: { x, y } });
  expect((await scene<string[]>(page, "notes")).join()).toContain("along +y: +x to the right, +z up");
  await page.getByRole("button", { name: "All", exact: true }).click();
  await drawn(page);
  const ends = await scene<Record<string, [number, number]>>(page, "axisEnds");
  await canvas(page).click({ position: { x: ends["y"][0], y: ends["y"][1] } });
  expect((await scene<string[]>(page, "notes")).join()).toContain("along -y: -x to the right, +z up");
  await expect.poll(() => page.evaluate(() => location.hash)).toContain("view=y");
});

/** The colour at a point of the scene. */
async function colourAt(page: Page, x: number, y: number): Promise<number[]> {
  const png = (await canvas(page).screenshot()).toString("base64");
  return page.evaluate(async ([data, px, py]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const context = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }).getContext("2d")!;
    context.drawImage(image, 0, 0);
    return [...context.getImageData(Number(px), Number(py), 1, 1).data.slice(0, 3)];
  }, [png, x, y] as const);
}

test("through the camera: its intrinsics, and its image lies behind what is projected", async ({ page }) => {
  const complaints = await open(page, "scene-eye", sceneReport({ lens: true, images: true }));
  await selectObject(page, "mug");
  await scrub(page, 40);
  await page.getByRole("button", { name: "Camera", exact: true }).click();
  await expect.poll(() => scene(page, "image")).toBe(20);
  for (const name of ["Labels", "Ellipsoids", "Rotation cones", "Hypotheses", "Ground truth", "Axes in mm"]) await page.getByRole("checkbox", { name }).uncheck();
  await drawn(page);
  const box = await scene<{ x: number; y: number; width: number; height: number }>(page, "imageBox");
  const place = sceneTrace().objects["soup-can"].world.truth![40]!.slice(0, 3);
  const [u, v] = pixelOf(40, place);
  const expected = [box.x + ((u + 0.5) * box.width) / 320, box.y + ((v + 0.5) * box.height) / 240];
  const seen = await page.evaluate(([px, py, pz]) => (window.posemix!["scene"] as { point: (x: number, y: number, z: number) => number[] }).point(px, py, pz), place);
  // The trace rounds the camera's rotation to 1/32767.
  expected.forEach((value, i) => expect(Math.abs(seen[i] - value)).toBeLessThan(0.2));
  // The image has a yellow disc there, which is seen beside the object's axes.
  const zoom = box.height / 240;
  const [red, green, blue] = await colourAt(page, seen[0] - 4 * zoom, seen[1] + 3 * zoom);
  expect(red > 200 && green > 180 && blue < 110, `${red} ${green} ${blue}`).toBe(true);
  await scrub(page, 41);
  await expect.poll(() => scene(page, "image")).toBe(20);
  expect((await scene<string[]>(page, "notes")).join()).toContain("image of 0.10 s before");
  await page.getByRole("checkbox", { name: "Camera images" }).uncheck();
  expect(await scene(page, "image")).toBe(-1);
  expect(complaints).toEqual([]);
});

test("through a camera whose intrinsics are not known, the picture says what is assumed", async ({ page }) => {
  await open(page, "scene-eye-unknown", sceneReport());
  await page.getByRole("button", { name: "Camera", exact: true }).click();
  expect((await scene<string[]>(page, "notes")).join()).toContain("intrinsics not known");
});

test("the wheel scrolls the page until the scene was pressed, or with Ctrl", async ({ page }) => {
  await page.setViewportSize({ width: 900, height: 600 });
  await open(page, "scene-wheel", sceneReport());
  const distance = () => scene<number>(page, "distance");
  const first = await distance();
  await canvas(page).hover({ position: { x: 300, y: 60 } });
  await page.mouse.wheel(0, 120);
  await expect(page.getByText("Ctrl and wheel zoom;")).toBeVisible();
  await expect.poll(() => page.evaluate(() => scrollY)).toBeGreaterThan(50);
  expect(await distance()).toBe(first);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -60);
  await page.keyboard.up("Control");
  await expect.poll(distance).toBeLessThan(first);
  const second = await distance();
  await canvas(page).click({ position: { x: 300, y: 160 } });
  const scrolled = await page.evaluate(() => scrollY);
  await page.mouse.wheel(0, -120);
  await expect.poll(distance).toBeLessThan(second);
  expect(await page.evaluate(() => scrollY)).toBe(scrolled);
});

test("the scene is saved as PNG with a legend, by the name of run and time", async ({ page }) => {
  await open(page, "scene-save", sceneReport());
  await scrub(page, 30);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
  expect(download.suggestedFilename()).toBe("Table-a-test_t3.00s_scene.png");
  const bytes = readFileSync((await download.path())!);
  expect(bytes.subarray(1, 4).toString()).toBe("PNG");
  const [width, height] = await scene<number[]>(page, "size");
  expect(bytes.readUInt32BE(16)).toBe(width);
  expect(bytes.readUInt32BE(20)).toBeGreaterThan(height + 20);
  // An empty picture would be much smaller.
  expect(bytes.length).toBeGreaterThan(15_000);
});

test("without WebGL the page says what to do, and all else is there", async ({ page }) => {
  await page.addInitScript(() => {
    const original = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
      return kind.startsWith("webgl") ? null : (original as (...all: unknown[]) => unknown).call(this, kind, ...rest);
    } as typeof original;
  });
  await open(page, "scene-no-webgl", sceneReport());
  await expect(page.getByText("hardware acceleration")).toBeVisible();
  await scrub(page, 10);
  expect(await probe(page, "frame")).toBe(10);
  await expect(page.getByRole("button", { name: "Save picture" })).toHaveCount(0);
});
