// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { expect, test } from "@playwright/test";
import { consistencyReport, mixtureReport, mug, saltBoxReport, studyReport } from "../documents.ts";
import { syntheticReport } from "../synthetic.ts";
import { open, openAllTabs, probe } from "./report.ts";

const small = { frames: 60, objects: 3, hypotheses: 3 };

test("a run loads without complaints, all tabs", async ({ page }) => {
  const report = syntheticReport(small, { tables: { "timing.csv": "a,b\n1,2\n" }, texts: { "report.md": "# Text" } });
  report["documents"] = { ...(report["documents"] as object), "mixture_object-0.json": mug };
  const complaints = await open(page, "slam", report);
  await openAllTabs(page);
  await expect(page.getByRole("tab", { name: "Mixtures" })).toBeVisible();
  await page.getByRole("tab", { name: "Files" }).click();
  await page.getByText("report.md").click();
  await expect(page.getByText("# Text")).toBeVisible();
  for (const view of ["Objects", "Top", "Front", "Side", "Camera", "All"]) await page.getByRole("button", { name: view, exact: true }).click();
  expect(complaints).toEqual([]);
});

test("a mixture loads: flags, table and marginal of both distributions", async ({ page }) => {
  const complaints = await open(page, "mixture", mixtureReport());
  expect(await probe(page, "flags")).toBe(400);
  await expect(page.getByRole("row", { name: /^1 0\.7 / })).toBeVisible();
  await page.getByRole("group", { name: "Components" }).getByLabel("2").uncheck();
  expect(await probe<number>(page, "flags")).toBeLessThan(320);
  await page.getByRole("combobox", { name: "Axis", exact: true }).selectOption("x");
  await page.getByRole("combobox", { name: "Mixture", exact: true }).selectOption({ label: "box (box.json)" });
  await expect(page.getByText("T_camera_box: projected Gaussians")).toBeVisible();
  expect(complaints).toEqual([]);
});

test("the salt box: stages in their order, flags in space, tables", async ({ page }) => {
  const complaints = await open(page, "salt_box", saltBoxReport());
  expect(await probe(page, "pictures")).toEqual(["flags_features.svg", "flags_objects.svg", "flags_fused_l.svg", "flags_merged_l.svg"]);
  await page.getByRole("button", { name: "features" }).focus();
  await page.keyboard.press("ArrowRight");
  await expect(page.getByRole("img", { name: "flags_objects.svg" })).toBeVisible();
  await openAllTabs(page);
  expect(await probe(page, "flags")).toBe(400);
  await expect(page.getByRole("row", { name: /shared_view 3 1.08/ })).toBeVisible();
  expect(complaints).toEqual([]);
});

test("consistency: findings first, tables of parts and axes, figures", async ({ page }) => {
  const complaints = await open(page, "consistency", consistencyReport());
  expect(await probe(page, "poses")).toEqual(["pose", "objects/ball/world"]);
  await expect(page.getByText("Consistency of estimates, aligned (first)")).toBeVisible();
  await expect(page.getByText("too small by a factor of 1.54").first()).toBeVisible();
  await expect(page.getByRole("row", { name: /^rotation 3 3\.74 3\.366 / })).toHaveCount(1);
  await expect(page.getByRole("row", { name: /^rotation z 0\.001 0\.05 0\.01645 / }).first()).toBeVisible();
  await openAllTabs(page);
  expect(complaints).toEqual([]);
});

test("a study: figures, charts and tables", async ({ page }) => {
  const complaints = await open(page, "study", studyReport());
  await openAllTabs(page);
  await page.getByRole("tab", { name: "Charts" }).click();
  await expect(page.locator("figcaption").first()).toHaveText("robot rotation RMSE [deg], by noise exponent");
  await page.getByRole("combobox", { name: "Value", exact: true }).selectOption("anees");
  await page.getByRole("combobox", { name: "Scale", exact: true }).selectOption("log");
  await page.getByRole("combobox", { name: "Table", exact: true }).selectOption("timing.csv");
  await page.getByRole("tab", { name: "Figures" }).click();
  const image = page.getByRole("img", { name: "errors.svg" });
  await expect(image).toBeVisible();
  expect(await image.evaluate((node: HTMLImageElement) => node.naturalWidth)).toBe(320);
  expect(complaints).toEqual([]);
});

test("meshes are drawn where they are given", async ({ page }) => {
  const base64 = (array: Float32Array | Uint32Array) => Buffer.from(array.buffer).toString("base64");
  const vertices = base64(new Float32Array([0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1]));
  const triangles = base64(new Uint32Array([0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3]));
  const complaints = await open(page, "meshes", syntheticReport(small, { meshes: { "object-1": { vertices, triangles } } }));
  expect(await probe(page, "bodies")).toEqual(["object-1"]);
  expect(complaints).toEqual([]);
});

const broken: [string, unknown, RegExp][] = [
  ["empty", undefined, /empty template/],
  ["foreign", { type: "posemix.trace" }, /not of type "posemix.report"/],
  ["newer", { type: "posemix.report", schema: 2 }, /schema 2/],
  ["unknown", { type: "posemix.report", schema: 1, kind: "poem" }, /kind "poem"/],
  ["no-trace", { type: "posemix.report", schema: 1, kind: "slam" }, /needs a "trace"/],
  ["no-mixture", { type: "posemix.report", schema: 1, kind: "mixture" }, /needs a document/],
  ["damaged", { ...syntheticReport(small), trace: { ...(syntheticReport(small)["trace"] as object), data: "AAAA" } }, /damaged/],
];
for (const [name, payload, message] of broken) {
  test(`data that cannot be shown say why: ${name}`, async ({ page }) => {
    const complaints = await open(page, `broken-${name}`, payload);
    await expect(page.getByRole("alert")).toContainText(message);
    expect(complaints).toEqual([]);
  });
}

test("names are text, whatever they contain", async ({ page }) => {
  const evil = '<img src=x onerror="window.hacked=1"></script><script>window.hacked=1</script>';
  const report = syntheticReport({ frames: 5, objects: 1, hypotheses: 1 }, {
    title: evil, pictures: { [evil]: `<svg xmlns="http://www.w3.org/2000/svg" onload="window.hacked=1"><script>window.hacked=1</script></svg>` },
    texts: { [evil]: evil }, tables: { [evil]: `${evil},b\n${evil},1\n` },
    documents: { "metrics.json": { schema: 1, objects: { [evil]: { [evil]: evil } } } },
  });
  const trace = report["trace"] as { order: string[]; columns: { name: string }[] };
  trace.order = [evil];
  for (const column of trace.columns) column.name = column.name.replace("object-0", evil);
  await open(page, "evil", report);
  await openAllTabs(page);
  await expect(page.getByRole("heading", { level: 1 })).toHaveText(evil);
  expect(await page.evaluate(() => "hacked" in window)).toBe(false);
  expect(await page.locator("#app img[src=x], #app script").count()).toBe(0);
});
