// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The hypotheses of an object at the shown frame.
import { percent } from "../plots/coverage.ts";
import { axisName, type Living, livingAt, type River } from "../plots/river.ts";
import { element } from "../ui/dom.ts";

const COLUMNS = ["hypothesis", "weight", "turn", "about", "distance", "age", "last support", ""];

export interface HypothesisTable {
  node: HTMLElement;
  /** Shows a frame; `support` has the lane by frame that a detection supported. */
  show: (river: River, support: Int32Array, seconds: Float64Array, frame: number) => void;
  highlight: (lane: number | undefined) => void;
}

const time = (seconds: number) => (seconds < 10 ? `${seconds.toFixed(2)} s` : `${seconds.toFixed(1)} s`);

/** The seconds since a detection supported a lane. */
function supportText(river: River, support: Int32Array, seconds: Float64Array, lane: number, frame: number): string {
  for (let k = frame; k >= river.lanes[lane].first; --k) {
    if (support[k] === lane) return k === frame ? "now" : `${time(seconds[frame] - seconds[k])} ago`;
  }
  return "none";
}

function cellsOf(river: River, support: Int32Array, seconds: Float64Array, frame: number, { lane, weight, turn, angleDeg, distanceMm }: Living, leads: boolean): string[] {
  const { first, last, end, into } = river.lanes[lane];
  const future = river.kept && frame === last && end !== "alive" ? (end === "merged" ? `merges into #${river.lanes[into!].id}` : "is dropped") : "";
  return [
    percent(weight), leads ? "leading" : `${angleDeg.toFixed(1)} deg`, leads ? "" : axisName(turn), leads ? "" : `${distanceMm.toFixed(1)} mm`,
    river.kept ? time(seconds[frame] - seconds[first]) : "–", river.kept ? supportText(river, support, seconds, lane, frame) : "–", future,
  ];
}

/** `pointed` is told the hypothesis that is hovered or focused. */
export function hypothesisTable(colour: (lane: number) => string, pointed: (lane: number | undefined) => void): HypothesisTable {
  const body = element("tbody");
  const caption = element("caption");
  const made = element("table", { class: "hypotheses" }, caption,
    element("thead", {}, element("tr", {}, ...COLUMNS.map((name) => (name === "" ? element("td") : element("th", { scope: "col" }, name))))), body);
  const node = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Hypotheses at this frame" }, made);
  const rows: HTMLTableRowElement[] = [];
  const rowAt = (k: number): HTMLTableRowElement => {
    const swatch = element("span", { class: "swatch" });
    const name = element("button", { type: "button", class: "plain" });
    const row = element("tr", {}, element("th", { scope: "row" }, swatch, name), ...COLUMNS.slice(1).map(() => element("td", { class: "number" })));
    const tell = () => pointed(Number(row.dataset["lane"]));
    row.addEventListener("mouseenter", tell);
    row.addEventListener("mouseleave", () => pointed(undefined));
    name.addEventListener("focus", tell);
    name.addEventListener("blur", () => pointed(undefined));
    rows[k] = row;
    return row;
  };
  const set = (cell: Element, text: string) => cell.textContent === text || (cell.textContent = text);
  return {
    node,
    show: (river, support, seconds, frame) => {
      const living = livingAt(river, frame);
      const rest = 1 - living.reduce((sum, { weight }) => sum + weight, 0);
      set(caption, living.length === 0 ? "There is no hypothesis at this frame" : `Hypotheses at ${seconds[frame].toFixed(2)} s${rest > 0.0005 && river.kept ? `; none of them ${percent(rest)}` : ""}`);
      living.forEach((one, k) => {
        const row = rows[k] ?? rowAt(k);
        if (!row.isConnected) body.append(row);
        row.dataset["lane"] = String(one.lane);
        (row.querySelector(".swatch") as HTMLElement).style.background = colour(one.lane);
        set(row.querySelector("button")!, `#${one.id}`);
        cellsOf(river, support, seconds, frame, one, k === 0).forEach((text, i) => set(row.cells[i + 1], text));
      });
      rows.slice(living.length).forEach((row) => row.remove());
    },
    highlight: (lane) => rows.forEach((row) => row.classList.toggle("highlighted", lane !== undefined && row.dataset["lane"] === String(lane))),
  };
}
