// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The tabs with plots of a run.
import { ChartGroup } from "../plots/group.ts";
import type { RunFacts } from "../state/run_facts.ts";
import type { RunState } from "../state/run_state.ts";
import type { Tab } from "../ui/tabs.ts";
import { consistencyTab, hasConsistency } from "./consistency_tab.ts";
import { detectionPlots } from "./detection_plots.ts";
import { errorPlots } from "./error_plots.ts";
import { hypothesisPlots } from "./hypothesis_plots.ts";
import { type Plots, plotsOf, type PlotTab } from "./plot_settings.ts";
import { statusPlots } from "./status_plots.ts";
import { trackPlots } from "./track_plots.ts";

type Build = (plots: Plots, ...groups: ChartGroup[]) => PlotTab;

/** The tabs; their charts are put into `groups`, which are told the shown time. */
export function plotTabs(state: RunState, facts: RunFacts, groups: ChartGroup[]): Tab[] {
  const plots = plotsOf(state);
  const tab = (name: string, count: number, build: Build): Tab => {
    const own = Array.from({ length: count }, () => new ChartGroup());
    groups.push(...own);
    let made: PlotTab | undefined;
    return {
      name,
      build: () => (made = build(plots, ...own)).node,
      open: () => {
        made?.opened();
        for (const group of own) group.mark();
      },
    };
  };
  const { trace } = state;
  return [
    tab("Detections", 1, detectionPlots),
    // Without ground truth nothing is an error.
    tab(trace.hasTruth ? "Errors" : "Spread", 1, errorPlots),
    ...(hasConsistency(trace) ? [tab("Consistency", 1, (shared, group) => consistencyTab(shared, facts, group))] : []),
    tab("Hypotheses", 2, hypothesisPlots),
    tab("Status", 1, statusPlots),
    ...(trace.hasTracks ? [tab("Tracks", 1, trackPlots)] : []),
  ];
}
