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

export interface Tabs {
  node: HTMLElement;
  /** Opens a tab by its name, in any case; what is no name is ignored. */
  show: (name: string) => void;
  /** Builds the tabs that were not opened so far, as for print. */
  buildAll: () => void;
}

const slug = (text: string) => text.toLowerCase().replaceAll(/[^a-z0-9]+/g, "-");

/** Tabs with the keys of the ARIA practices: left, right, home, end. `opened` is told the name of the one that is shown. */
export function tabs(label: string, list: Tab[], opened: (name: string) => void = () => {}): Tabs {
  const bar = element("div", { role: "tablist", "aria-label": label, class: "tabs" });
  const node = element("section", { class: "tabbed" }, bar);
  const ids = list.map(({ name }) => `${slug(label)}-${slug(name)}`);
  const heads = list.map((tab, i) =>
    element("button", { type: "button", role: "tab", id: `tab-${ids[i]}`, "aria-controls": `panel-${ids[i]}` }, tab.name),
  );
  const panels = list.map((_, i) =>
    element("div", { role: "tabpanel", id: `panel-${ids[i]}`, "aria-labelledby": `tab-${ids[i]}`, hidden: true, tabindex: 0 }),
  );
  const built = new Set<number>();
  const buildOne = (index: number) => {
    if (!built.has(index)) panels[index].append(list[index].build());
    built.add(index);
  };
  let shown = -1;
  const show = (chosen: number) => {
    if (chosen === shown) return;
    shown = chosen;
    heads.forEach((head, i) => {
      head.setAttribute("aria-selected", String(i === chosen));
      head.tabIndex = i === chosen ? 0 : -1;
      panels[i].hidden = i !== chosen;
    });
    buildOne(chosen);
    list[chosen].open?.();
    opened(list[chosen].name);
  };
  heads.forEach((head, i) => {
    head.addEventListener("click", () => show(i));
    head.addEventListener("keydown", (event) => {
      const steps: Record<string, number> = {
        ArrowRight: i + 1, ArrowLeft: i - 1 + heads.length, Home: 0, End: heads.length - 1,
      };
      const step = steps[event.key];
      if (step === undefined || event.shiftKey) return;
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
  return {
    node,
    show: (name) => {
      const index = list.findIndex((tab) => tab.name.toLowerCase() === name.toLowerCase());
      if (index >= 0) show(index);
    },
    buildAll: () => list.forEach((_, i) => buildOne(i)),
  };
}
