// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Tables with a row per object: a press on a row selects its object, and the selected one is marked.
import type { RunState } from "../state/run_state.ts";

/** Links the rows below a node with the name of an object or the camera as `data-entity`; a heading may be the same word and mean something else. */
export function linkRows(node: HTMLElement, state: RunState): HTMLElement {
  const rows = [...node.querySelectorAll<HTMLElement>("tbody tr[data-entity]")].flatMap((row) => {
    const entity = state.entityOf(row.dataset["entity"]!);
    return entity === undefined ? [] : [{ row, entity }];
  });
  const mark = () => {
    for (const { row, entity } of rows) {
      if (entity === state.selected) row.setAttribute("aria-current", "true");
      else row.removeAttribute("aria-current");
    }
  };
  for (const { row, entity } of rows) {
    row.classList.add("linked");
    row.addEventListener("click", () => state.select(entity));
  }
  state.on("selection", mark);
  mark();
  return node;
}
