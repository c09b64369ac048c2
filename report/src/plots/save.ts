// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Saves a plot: PNG and SVG drawn from its series, CSV of what is drawn.
import { button, element } from "../ui/dom.ts";
import type { Chart, Rows } from "./chart.ts";
import { xLabelOf } from "./chart_options.ts";
import { figureOf } from "./figure.ts";

/** Pixels of a PNG per pixel of the page. */
const SHARPNESS = 2;

export function fileName(title: string, end: string): string {
  const slug = title.toLowerCase().replaceAll(/[^a-z0-9]+/g, "-").replaceAll(/^-|-$/g, "").slice(0, 80);
  return `${slug || "plot"}.${end}`;
}

/** Gives the reader a file. */
export function download(name: string, content: Blob): void {
  const link = element("a", { href: URL.createObjectURL(content), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const cell = (value: number | string | null | undefined): string => {
  if (value === null || value === undefined) return "";
  if (typeof value === "number") return String(value);
  return /[",\r\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value;
};

export function csvText({ columns, rows }: Rows): string {
  return [columns, ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
}

/** The series that are shown, over the part of x that is. */
export function rowsOf(chart: Chart): Rows {
  const { settings, plot } = chart;
  if (settings.rows) return settings.rows();
  const shown = settings.series.filter((_, k) => chart.isShown(k));
  const columns = [xLabelOf(settings) || "x", ...shown.flatMap(({ label, lower }) => (lower ? [`${label} high`, `${label} low`] : [label]))];
  const { min, max } = plot.scales["x"];
  const rows: Rows["rows"] = [];
  for (let i = 0; i < settings.x.length; ++i) {
    const at = settings.x[i];
    if (min != null && max != null && (at < min || at > max)) continue;
    rows.push([settings.xNames?.[at - 1] ?? at, ...shown.flatMap(({ values, lower }) => (lower ? [values[i], lower[i]] : [values[i]]))]);
  }
  return { columns, rows };
}

async function savePng(name: string, svg: string): Promise<void> {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = element("canvas", { width: SHARPNESS * image.naturalWidth, height: SHARPNESS * image.naturalHeight });
  canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => blob && download(name, blob), "image/png");
}

/** A small menu; it is a disclosure, so that it works by keys. */
export function saveMenu(chart: Chart): HTMLElement {
  const { title } = chart.settings;
  const summary = element("summary", { "aria-label": `Save plot: ${title}`, title: "Save this plot" }, "⤓");
  const list = element("div", { class: "choices" });
  const node = element("details", { class: "save" }, summary, list);
  const choice = (text: string, save: () => void) => button(text, () => {
    node.open = false;
    summary.focus();
    save();
  });
  const choices = () => [
    choice("PNG", () => void savePng(fileName(title, "png"), figureOf(chart))),
    choice("SVG", () => download(fileName(title, "svg"), new Blob([figureOf(chart)], { type: "image/svg+xml" }))),
    choice("CSV", () => download(fileName(title, "csv"), new Blob([csvText(rowsOf(chart))], { type: "text/csv" }))),
  ];
  // A page has many plots, and few of them are saved.
  summary.addEventListener("click", () => node.open || list.replaceChildren(...choices()));
  node.addEventListener("toggle", () => node.open || list.replaceChildren());
  node.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !node.open) return;
    event.stopPropagation();
    node.open = false;
    summary.focus();
  });
  node.addEventListener("focusout", (event) => {
    if (!(event.relatedTarget instanceof Node) || !node.contains(event.relatedTarget)) node.open = false;
  });
  return node;
}
