// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The scene of a run: uncertainty, selection, what is hidden, extent and labels.
import { expect, type Page, test } from "@playwright/test";
import type { JsonObject } from "../../src/payload.ts";
import { packTrace } from "../pack.ts";
import { covarianceOf, FRAMES, IDS, LATE, sceneReport, sceneTrace, sdOf } from "../scene_run.ts";
import { syntheticReport } from "../synthetic.ts";
import { boxOf, open, probe, scrub, selectObject } from "./report.ts";
import { canvas, drawn, scene } from "./scene.ts";

// Drawing by software on a machine that does other things takes its time.
test.describe.configure({ timeout: 240_000 });

interface Label { text: string; entity: number; x: number; y: number; width: number; height: number }
interface Spread { principal: number[]; along: number[]; about: number[] }

const screen = (page: Page, id: string): Promise<[number, number]> =>
  page.evaluate((name) => (window.posemix!["scene"] as { screen: (id: string) => [number, number] }).screen(name), id);
const choose = (page: Page, name: string, value: string) => page.getByRole("combobox", { name, exact: true }).selectOption(value);
const labels = async (page: Page) => (await drawn(page), scene<Label[]>(page, "labels"));
const close = (actual: number[], expected: number[], share = 0.01) =>
  expected.forEach((value, i) => expect(Math.abs(actual[i] - value)).toBeLessThanOrEqual(share * Math.abs(value)));

test("ellipsoids, cones and samples are as many as there are poses, sigmas and choices", async ({ page }) => {
  await open(page, "scene-counts", sceneReport({ meshes: true }));
  const counts = () => scene<Record<string, number>>(page, "counts");
  // Before the late one comes there are four objects and the camera; the camera has no cones.
  expect(await counts()).toEqual({ shells: 5, cones: 12, bars: 3, samples: 0, wireframes: 5 });
  await scrub(page, LATE.frame);
  expect(await counts()).toEqual({ shells: 6, cones: 15, bars: 3, samples: 0, wireframes: 5 });
  await choose(page, "Size", "all");
  expect((await counts())["shells"]).toBe(18);
  await page.getByRole("checkbox", { name: "Samples" }).check();
  await page.getByRole("checkbox", { name: "Rotation cones" }).uncheck();
  await page.getByRole("checkbox", { name: "Ground truth" }).uncheck();
  expect(await counts()).toEqual({ shells: 18, cones: 0, bars: 3, samples: 80, wireframes: 0 });
  // The camera is certain relative to itself.
  await choose(page, "Covariance", "camera");
  expect((await counts())["shells"]).toBe(15);
});

test("sigmas of the selected object are the trace's: in the world, relative to the camera, along its own axes", async ({ page }) => {
  await open(page, "scene-sigmas", sceneReport());
  await scrub(page, 30);
  const index = IDS.indexOf("soup-can");
  await page.evaluate((hash) => (location.hash = hash), "t=3&object=soup-can");
  await expect.poll(() => probe(page, "selected")).toBe("soup-can");
  const of = async (isRelative: boolean) => {
    const spread = await scene<Spread>(page, "selected");
    const [xx, xy, , yy, , zz] = covarianceOf(index, 30, isRelative);
    const [mean, off] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
    const principal = [mean + off, mean - off, zz].sort((a, b) => b - a).map((value) => 1000 * Math.sqrt(value));
    return { spread, principal, sd: sdOf(index, 30, isRelative) };
  };
  const world = await of(false);
  close(world.spread.principal, world.principal);
  close(world.spread.along, world.sd.slice(3).map((sd) => 1000 * sd));
  close(world.spread.about, world.sd.slice(0, 3).map((sd) => (sd * 180) / Math.PI));
  await choose(page, "Covariance", "camera");
  const relative = await of(true);
  close(relative.spread.principal, relative.principal);
  close(relative.spread.along, relative.sd.slice(3).map((sd) => 1000 * sd));
  await choose(page, "Covariance", "object");
  const own = await of(false);
  close(own.spread.principal, own.principal);
  // The object is turned about z by 0.5 of its number, and a little.
  const angle = 0.5 * index + 0.03 / 31;
  const [xx, xy, , yy] = covarianceOf(index, 30, false);
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  close([own.spread.along[0]], [1000 * Math.sqrt(c * c * xx + 2 * c * s * xy + s * s * yy)]);
});

test("the picture says how much larger uncertainty is drawn, and lengths stay true", async ({ page }) => {
  await open(page, "scene-factor", sceneReport());
  await scrub(page, 40);
  const lengths = async () => (await labels(page)).filter(({ text }) => text.endsWith(" mm")).map(({ text }) => text).sort();
  const before = await lengths();
  expect(before).toHaveLength(3);
  for (const [value, words] of [["1", "true size"], ["10", "drawn 10 times larger"], ["100", "drawn 100 times larger"]]) {
    await choose(page, "drawn", value);
    expect((await scene<string[]>(page, "notes"))[0]).toContain(words);
    expect(await scene(page, "factor")).toBe(Number(value));
  }
  await choose(page, "drawn", "visible");
  expect(await lengths()).toEqual(before);
  // It is one factor for the run, so that what shrinks is seen to shrink.
  const factors = new Set<number>();
  for (const frame of [0, 1, 10, 30, FRAMES - 1]) {
    await scrub(page, frame);
    factors.add(await scene<number>(page, "factor"));
  }
  expect(factors.size).toBe(1);
  // Cones end at 75 deg, which is then said.
  await scrub(page, 0);
  await page.getByRole("checkbox", { name: "Rotation cones" }).check();
  await choose(page, "drawn", "1");
  expect((await scene<string[]>(page, "notes"))[0]).not.toContain("cones at most");
  await choose(page, "drawn", "100");
  expect((await scene<string[]>(page, "notes"))[0]).toContain("drawn 100 times larger, cones at most 75 deg wide to each side");
});

test("on a phone the caption of the uncertainty is broken, not cut", async ({ page }) => {
  await open(page, "scene-phone", sceneReport());
  await page.getByRole("checkbox", { name: "Rotation cones" }).check();
  await choose(page, "drawn", "100");
  await page.setViewportSize({ width: 390, height: 844 });
  await drawn(page);
  const [notes, lines] = [await scene<string[]>(page, "notes"), await scene<string[]>(page, "noteLines")];
  expect(lines.length).toBeGreaterThan(notes.length);
  expect(lines.join(" ")).toBe(notes.join(" "));
});

test("a weight stands beside a name only where there can be another hypothesis", async ({ page }) => {
  const trace = sceneTrace();
  const one = trace.objects["mug"] as unknown as { alternatives: unknown[]; mode_probability?: unknown };
  one.alternatives = trace.stamps_s.map((_, k) => [{ id: 0, probability: 1, pose: trace.objects["mug"].world.pose[k] }]);
  delete one.mode_probability;
  await open(page, "scene-weights", { ...sceneReport(), trace: packTrace(trace) as unknown as JsonObject } as JsonObject);
  await scrub(page, 30);
  const names = (await labels(page)).map(({ text }) => text);
  expect(names.filter((text) => text.startsWith("mug"))).toEqual(["mug"]);
  expect(names.some((text) => /^tea-box: \d+ %/.test(text))).toBe(true);
});

test("a click on an object, its label or its ghost selects it; a double click centres it", async ({ page }) => {
  await open(page, "scene-select", sceneReport({ meshes: true }));
  await selectObject(page, "mug");
  await scrub(page, 30);
  await drawn(page);
  expect(await probe(page, "selected")).toBe("mug");
  const [x, y] = await screen(page, "cracker-box");
  await canvas(page).click({ position: { x, y: y + 6 } });
  expect(await probe(page, "selected")).toBe("cracker-box");
  const label = (await labels(page)).find(({ text }) => text.startsWith("soup-can"))!;
  await canvas(page).click({ position: { x: label.x + label.width - 4, y: label.y + label.height / 2 } });
  expect(await probe(page, "selected")).toBe("soup-can");
  const ghost = (await labels(page)).find(({ text }) => text === "36 %")!;
  await canvas(page).click({ position: { x: ghost.x + 8, y: ghost.y + 8 } });
  expect(await probe(page, "selected")).toBe("tea-box");
  await canvas(page).dblclick({ position: { x, y: y + 6 } });
  const place = sceneTrace().objects["cracker-box"].world.pose[30]!;
  (await scene<number[]>(page, "target")).forEach((value, i) => expect(Math.abs(value - place[i])).toBeLessThan(2e-5));
  // A drag turns the view and selects nothing.
  const selected = await probe(page, "selected");
  const box = await boxOf(canvas(page));
  await page.mouse.move(box.x + 30, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 150, box.y + 230, { steps: 4 });
  await page.mouse.up();
  expect(await probe(page, "selected")).toBe(selected);
});

test("the pointer tells id and sigma, and what a hypothesis is", async ({ page }) => {
  await open(page, "scene-tips", sceneReport());
  await selectObject(page, "mug");
  await scrub(page, 30);
  await page.getByRole("checkbox", { name: "Labels" }).uncheck();
  await page.getByRole("button", { name: "Top" }).click();
  await canvas(page).press("+");
  await drawn(page);
  const tip = page.locator(".slam .stage .tooltip");
  const [x, y] = await screen(page, "mug");
  await canvas(page).hover({ position: { x, y } });
  await expect(tip).toBeVisible();
  const sd = sdOf(0, 30, false).slice(3).map((value) => (1000 * value).toFixed(1));
  await expect(tip).toContainText("mug");
  await expect(tip).toContainText(`position x y z ${sd.join(", ")} mm`);
  // The other hypothesis of the tea-box is turned by half a turn: its x axis points the other way.
  const [tx, ty] = await screen(page, "tea-box");
  const angle = 0.5 + Math.PI;
  const ahead = await page.evaluate(([px, py, a]) =>
    (window.posemix!["scene"] as { point: (x: number, y: number, z: number) => number[] }).point(px + 0.06 * Math.cos(a), py + 0.06 * Math.sin(a), 0.08), [0.1, 0.35, angle]);
  expect(Math.hypot(ahead[0] - tx, ahead[1] - ty)).toBeGreaterThan(10);
  await canvas(page).hover({ position: { x: ahead[0], y: ahead[1] } });
  await expect(tip).toContainText("tea-box: hypothesis, 36.0 %");
  await expect(tip).toContainText("180 deg about z");
});

test("what is hidden is nowhere in the scene, and what is followed stays in its place", async ({ page }) => {
  await open(page, "scene-hidden", sceneReport({ meshes: true }));
  await scrub(page, 30);
  await page.evaluate((hash) => (location.hash = hash), "t=3&hide=tea-box&hide=cup");
  await expect.poll(async () => (await labels(page)).some(({ text }) => text.startsWith("cup"))).toBe(false);
  expect((await labels(page)).map(({ text }) => text)).not.toContain("36 %");
  expect(await probe(page, "bodies")).toEqual(["mug", "soup-can", "cracker-box"]);
  // Of the mug the second hypothesis is left, as of the soup-can and the cracker-box.
  expect(await probe(page, "ghosts")).toBe(3);
  expect(await scene(page, "counts")).toMatchObject({ shells: 4, cones: 9, wireframes: 3 });
  await page.evaluate((hash) => (location.hash = hash), "t=3&object=camera&follow=1");
  await expect(page.getByRole("checkbox", { name: "Follow" })).toBeChecked();
  await drawn(page);
  const before = await screen(page, "camera");
  await scrub(page, 50);
  await drawn(page);
  (await screen(page, "camera")).forEach((value, i) => expect(Math.abs(value - before[i])).toBeLessThan(0.5));
});

test("All shows all, at every frame and size: camera with pyramid, objects, what comes late", async ({ page }) => {
  for (const [width, height] of [[1100, 720], [390, 780]]) {
    await page.setViewportSize({ width, height });
    await open(page, "scene-all", sceneReport({ lens: true }));
    await page.getByRole("button", { name: "All", exact: true }).click();
    const [w, h] = await scene<number[]>(page, "size");
    for (let frame = 0; frame < FRAMES; frame += 10) {
      await scrub(page, frame);
      const corners = await page.evaluate(() => (window.posemix!["scene"] as { corners: () => [number, number][] }).corners());
      const places = await Promise.all(["camera", ...IDS.filter((id) => id !== LATE.id || frame >= LATE.frame)].map((id) => screen(page, id)));
      for (const [x, y] of [...corners, ...places]) {
        expect(x > 0 && x < w && y > 0 && y < h, `${x}, ${y} at frame ${frame} in ${w} x ${h}`).toBe(true);
      }
    }
  }
});

test("labels: none over another, with fifteen objects, and what has not come is named", async ({ page }) => {
  await open(page, "scene-labels", syntheticReport({ frames: 100, objects: 15, hypotheses: 5 }));
  for (const view of ["All", "Objects", "Side"]) {
    await page.getByRole("button", { name: view, exact: true }).click();
    const shown = await labels(page);
    expect(shown.length).toBeGreaterThan(5);
    const names = shown.filter(({ text }) => text.startsWith("object-")).length;
    expect(names + (await scene<number>(page, "labelsLeft"))).toBeLessThanOrEqual(16);
    shown.forEach((a, i) => {
      for (const b of shown.slice(i + 1)) {
        const apart = a.x >= b.x + b.width || b.x >= a.x + a.width || a.y >= b.y + b.height || b.y >= a.y + a.height;
        expect(apart, `${a.text} and ${b.text}`).toBe(true);
      }
    });
  }
  await open(page, "scene-late", sceneReport());
  expect((await labels(page)).map(({ text }) => text)).toContain("cup: ground truth, no estimate");
});
