// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The salt box of the MPG paper: flags by stage.
import type { Payload } from "../payload.ts";
import type { Mixture } from "../mixture/mixture.ts";
import { chartFigure } from "../plots/explorer.ts";
import { key } from "../plots/drawing.ts";
import type { TableChart } from "../plots/table_chart.ts";
import { button, element } from "../ui/dom.ts";
import { colourOf } from "../ui/palette.ts";
import { type Tab, tabs } from "../ui/tabs.ts";
import type { Table } from "../ui/csv.ts";
import { mixtureDocuments, type MixtureView, mixtureView } from "./mixture.ts";
import { footer, header, picture, publish } from "./page.ts";
import { printMixtures } from "./print_mixture.ts";
import { storyNode, studyTables, tablesNode } from "./study.ts";

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

/** Standard deviations by stage. Stages are two branches that meet, so that no line joins them. */
export function spread(stages: Table): TableChart[] {
  const names = stages.rows.map((row) => String(row[0]));
  const chart = (title: string, key: (axis: string) => string, scale: number): TableChart => {
    const lines = ["x", "y", "z"].map((axis, index) => {
      const k = stages.columns.indexOf(key(axis));
      const points = stages.rows.flatMap((row, i) =>
        k >= 0 && typeof row[k] === "number" ? [{ x: names[i], value: scale * (row[k] as number), low: undefined, high: undefined, rows: 1 }] : []);
      return { group: axis, index, points };
    });
    return { title, xLabel: "stage", yLabel: title, names, words: true, panel: { unit: "", lines }, log: false };
  };
  return [
    chart("rotation standard deviation [deg]", (axis) => `rotation_std_${axis}_deg`, 1),
    chart("translation standard deviation [mm]", (axis) => `translation_std_${axis}_m`, 1000),
  ];
}

function spreadNode(stages: Table): HTMLElement {
  const axes = ["x", "y", "z"].map((name, k) => ({ name: `about or along ${name}`, colour: colourOf(k), shape: k }));
  return element("div", {}, key(axes), element("div", { class: "panel-grid" }, ...spread(stages).map(chartFigure)));
}

export function saltBoxPage(payload: Payload): HTMLElement {
  const found = studyTables(payload);
  const stages = found["rows"] ?? { columns: [], rows: [] };
  const stageNames = stages.rows.map((row) => String(row[0]));
  const pictures = inOrder(Object.keys(payload.pictures), stageNames);
  const mixtures = inOrder(Object.keys(payload.documents), stageNames);
  const ordered: Mixture[] = mixtureDocuments(payload).sort((a, b) => mixtures.indexOf(a.name) - mixtures.indexOf(b.name));
  const list: Tab[] = [];
  let view: MixtureView | undefined;
  if (pictures.length > 0) list.push({ name: "Flags by stage", build: () => stepper(payload, pictures) });
  if (ordered.length > 0) {
    list.push({
      name: "In space",
      build: () => {
        view = mixtureView(ordered);
        return view.node;
      },
    });
  }
  if (stages.rows.length > 0) list.push({ name: "Spread", build: () => spreadNode(stages) });
  list.push({ name: "Tables", build: () => tablesNode(found) });
  publish({ kind: "salt_box", pictures, mixtures: ordered.map(({ name }) => name), get flags() { return view?.flagCount() ?? 0; } });
  const subtitle = "Salt box: a pose from three features, flags by stage";
  printMixtures(payload, subtitle, ordered, () => view, pictures, found);
  return element("div", { class: "page study" }, header(payload, subtitle),
    element("main", {}, ...storyNode("salt-box", found), tabs("Salt box", list).node), footer(payload));
}
