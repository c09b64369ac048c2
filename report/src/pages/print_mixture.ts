// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The summary of mixtures for print, also of a study whose result is one.
import { DEGREES, log } from "../math/rotation.ts";
import { type Mixture, positionCovariance, rotationSd } from "../mixture/mixture.ts";
import type { Payload } from "../payload.ts";
import { shownTable } from "../study/shown.ts";
import { storyOf } from "../study/stories.ts";
import type { Table } from "../ui/csv.ts";
import { element } from "../ui/dom.ts";
import { onPrint, printHeader, type PrintTable, printTable, scenePicture, sheetOf } from "../ui/print.ts";
import type { MixtureView } from "./mixture.ts";
import { loaded } from "./print_study.ts";
import { provenanceLines } from "./provenance.ts";

const MOST_COMPONENTS = 24;

/** The components, the heaviest first. */
function components(mixture: Mixture): PrintTable {
  const order = mixture.components.map((_, k) => k).sort((a, b) => mixture.components[b].weight - mixture.components[a].weight);
  const list = (values: number[], digits: number) => values.map((value) => value.toFixed(digits)).join(", ");
  return {
    name: `T_${mixture.from}_${mixture.to}: components by weight, ${mixture.distribution} Gaussians (${mixture.name})`,
    columns: ["", "weight", "position x, y, z_mm", "rotation vector_deg", "rotation sd_deg", "position sd_mm"],
    rows: order.map((k) => {
      const component = mixture.components[k];
      const r = [0, 0, 0];
      log(component.quaternion, r);
      const p = positionCovariance(mixture, component);
      return [`${k + 1}`, component.weight, list(component.translation.map((value) => 1000 * value), 1), list(r.map((angle) => angle * DEGREES), 1),
        list(rotationSd(mixture, component).map((sd) => sd * DEGREES), 2), list([0, 4, 8].map((i) => 1000 * Math.sqrt(p[i])), 2)];
    }),
  };
}

export function printMixtures(
  payload: Payload, subtitle: string, mixtures: Mixture[], view: () => MixtureView | undefined,
  pictures = Object.keys(payload.pictures), tables: Record<string, Table> = {},
): void {
  const shown = loaded(Object.fromEntries(pictures.map((name) => [name, payload.pictures[name]])), 2);
  const left = Object.keys(payload.pictures).length - shown.length;
  onPrint(() => {
    const one = view()?.shown() ?? mixtures[mixtures.length - 1];
    const others = mixtures.filter((mixture) => mixture !== one).map(({ name }) => name);
    const rows = tables["rows"];
    const scene = one ? scenePicture(view()?.viewport, `Samples from ${one.to} (${one.name}) as flags: the foot is the position, the pole the z axis, the pennant points along x`) : [];
    return [
      sheetOf(printHeader(payload.title, [subtitle, ...provenanceLines(payload.documents)]),
        ...storyOf("salt-box", tables).map((text) => element("p", { class: "sentence" }, text)), ...scene,
        ...(scene.length === 0 ? shown : []), ...(one && scene.length > 0 ? [printTable(components(one), 12)] : [])),
      sheetOf(...(scene.length > 0 ? shown : []), ...(left > 0 ? [element("p", { class: "hint" }, `${left} more figures are in the page.`)] : []),
        ...(rows ? [printTable({ name: "stages", ...shownTable(rows) }, 16)] : []),
        ...(one && (scene.length === 0 || one.components.length > 12) ? [printTable(components(one), MOST_COMPONENTS)] : []),
        ...(others.length > 0 ? [element("p", { class: "hint" }, `The page has further mixtures: ${others.join(", ")}.`)] : [])),
    ];
  });
}
