// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
import { element } from "./dom.ts";

export interface Tab {
  name: string;
  /** Called when the tab is opened for the first time. */
  build: () => HTMLElement;
  /** Called whenever it is opened. */
  open?: () => void;
}

/** Tabs with the keys of the ARIA practices: left, right, home, end. */
export function tabs(label: string, list: Tab[]): HTMLElement {
  const bar = element("div", { role: "tablist", "aria-label": label, class: "tabs" });
  const node = element("section", { class: "tabbed" }, bar);
  const heads = list.map((tab, i) =>
    element("button", { type: "button", role: "tab", id: `tab-${label}-${i}`, "aria-controls": `panel-${label}-${i}` }, tab.name),
  );
  const panels = list.map((_, i) =>
    element("div", { role: "tabpanel", id: `panel-${label}-${i}`, "aria-labelledby": `tab-${label}-${i}`, hidden: true, tabindex: 0 }),
  );
  const built = new Set<number>();
  const show = (chosen: number) => {
    heads.forEach((head, i) => {
      head.setAttribute("aria-selected", String(i === chosen));
      head.tabIndex = i === chosen ? 0 : -1;
      panels[i].hidden = i !== chosen;
    });
    if (!built.has(chosen)) panels[chosen].append(list[chosen].build());
    built.add(chosen);
    list[chosen].open?.();
  };
  heads.forEach((head, i) => {
    head.addEventListener("click", () => show(i));
    head.addEventListener("keydown", (event) => {
      const steps: Record<string, number> = {
        ArrowRight: i + 1, ArrowLeft: i - 1 + heads.length, Home: 0, End: heads.length - 1,
      };
      const step = steps[event.key];
      if (step === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      const next = step % heads.length;
      show(next);
      heads[next].focus();
    });
  });
  bar.append(...heads);
  node.append(...panels);
  show(0);
  return node;
}
