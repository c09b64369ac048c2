// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The salt box of the MPG paper: flags by stage.
import type { Payload } from "../payload.ts";
import type { Mixture } from "../mixture/mixture.ts";
import { Chart } from "../plots/chart.ts";
import { ChartGroup } from "../plots/group.ts";
import { button, element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { type Tab, tabs } from "../ui/tabs.ts";
import type { Table } from "../ui/csv.ts";
import { tableNode } from "./files.ts";
import { mixtureDocuments, mixtureView } from "./mixture.ts";
import { footer, header, picture, publish } from "./page.ts";
import { studyTables } from "./study.ts";

/** Pictures and mixtures in the order of the stages. */
export function inOrder(names: string[], stages: string[]): string[] {
  const place = (name: string) => {
    const bare = name.replace(/^(flags|mixture)_/, "").replace(/\.(svg|json)$/, "");
    const exact = stages.indexOf(bare);
    if (exact >= 0) return 2 * exact;
    // The pictures "features" and "objects" show several mixtures; the first of them counts.
    const group = stages.findIndex((stage) => stage.startsWith(bare.replace(/s$/, "_")));
    return group >= 0 ? 2 * group - 1 : 2 * stages.length;
  };
  return [...names].sort((a, b) => place(a) - place(b));
}

/** One picture at a time, with buttons to the previous and the next one. */
function stepper(payload: Payload, names: string[]): HTMLElement {
  const place = element("div", { "aria-live": "polite" });
  const list = element("div", { class: "steps", role: "group", "aria-label": "Stage" });
  let at = 0;
  const show = (index: number) => {
    at = Math.max(0, Math.min(names.length - 1, index));
    place.replaceChildren(picture(names[at], payload.pictures[names[at]]));
    [...list.children].forEach((node, i) => node.setAttribute("aria-pressed", String(i === at)));
  };
  names.forEach((name, i) => list.append(button(name.replace(/^flags_|\.svg$/g, "").replaceAll("_", " "), () => show(i))));
  list.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (step === 0) return;
    event.preventDefault();
    show(at + step);
    (list.children[at] as HTMLElement).focus();
  });
  show(0);
  return element("div", { class: "stepper" }, list, place);
}

/** Standard deviations over the stages. */
function spread(stages: Table): ChartGroup {
  const group = new ChartGroup();
  const names = stages.rows.map((row) => String(row[0]));
  const x = names.map((_, i) => i + 1);
  const column = (name: string, scale: number) => {
    const k = stages.columns.indexOf(name);
    return stages.rows.map((row) => (k >= 0 && typeof row[k] === "number" ? scale * (row[k] as number) : null));
  };
  const chart = (title: string, key: (axis: string) => string, scale: number) =>
    new Chart({
      title, x, xNames: names, height: 300,
      series: ["x", "y", "z"].map((axis, k) => ({ label: axis, values: column(key(axis), scale), colour: colourOf(k), kind: "both" as const })),
    });
  group.replace([
    chart("rotation standard deviation [deg]", (axis) => `rotation_std_${axis}_deg`, 1),
    chart("translation standard deviation [mm]", (axis) => `translation_std_${axis}_m`, 1000),
  ]);
  return group;
}

export function saltBoxPage(payload: Payload): HTMLElement {
  const found = studyTables(payload);
  const stages = found["rows"] ?? { columns: [], rows: [] };
  const stageNames = stages.rows.map((row) => String(row[0]));
  const pictures = inOrder(Object.keys(payload.pictures), stageNames);
  const mixtures = inOrder(Object.keys(payload.documents), stageNames);
  const ordered: Mixture[] = mixtureDocuments(payload).sort((a, b) => mixtures.indexOf(a.name) - mixtures.indexOf(b.name));
  const list: Tab[] = [];
  let flags = () => 0;
  if (pictures.length > 0) list.push({ name: "Flags by stage", build: () => stepper(payload, pictures) });
  if (ordered.length > 0) {
    list.push({
      name: "In space",
      build: () => {
        const view = mixtureView(ordered);
        flags = view.flagCount;
        return view.node;
      },
    });
  }
  if (stages.rows.length > 0) list.push({ name: "Spread", build: () => spread(stages).node });
  list.push({ name: "Tables", build: () => element("div", { class: "tables" }, ...Object.entries(found).map(([name, table]) => tableNode(name, table))) });
  publish({ kind: "salt_box", pictures, mixtures: ordered.map(({ name }) => name), get flags() { return flags(); } });
  return element("div", { class: "page" }, header(payload, "Salt box: a pose from three features, flags by stage"),
    element("main", {}, tabs("Salt box", list)), footer(payload));
}
