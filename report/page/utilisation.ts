// SPDX-License-Identifier: Apache-2.0
// How full each unit was, over its first packets' cycles.
import uPlot from "uplot";
import type { Run, Utilisation } from "./data";
import { figure, h } from "./dom";
import { seriesColors } from "./color";
import { themeColor } from "./theme";

function chart(u: Utilisation): HTMLElement {
  const holder = h("div", { class: "plot" });
  const x = u.busy.map((_, i) => u.first + (i + 0.5) * u.bucket);
  let plot: uPlot | undefined;
  const draw = () => {
    if (holder.clientWidth === 0) return;
    plot?.destroy();
    const ink = themeColor("ink"), grid = { stroke: themeColor("line"), width: 1 };
    plot = new uPlot({
      width: Math.min(holder.clientWidth, 1100), height: 200,
      cursor: { drag: { x: false, y: false } },
      scales: { x: { time: false }, y: { range: (_p, _low, high) => [0, Math.max(1, high * 1.08)] }, busy: { range: [0, 108] } },
      axes: [
        { stroke: ink, grid, label: "cycle", labelSize: 18, size: 34, values: (_p, v) => v.map((c) => figure(c)) },
        { stroke: ink, grid, label: "packets inside (solid)", labelSize: 18 },
        { scale: "busy", side: 1, stroke: ink, grid: { show: false }, label: "busy, % (dashed)", labelSize: 18, values: (_p, v) => v.map((c) => figure(c)) }],
      series: [{ label: "cycle", value: (_p, v) => figure(v) },
        { label: "packets inside, mean (solid)", stroke: seriesColors[0]!, width: 1.5, fill: `${seriesColors[0]!}22`, value: (_p, v) => figure(v, 3) },
        { label: "busy % (dashed)", scale: "busy", stroke: seriesColors[1]!, width: 1.5, dash: [6, 4], value: (_p, v) => figure(v, 3) }],
    }, [x, u.inside, u.busy.map((b) => 100 * b)], holder);
  };
  new ResizeObserver(draw).observe(holder);
  document.addEventListener("theme", draw);
  return holder;
}

export function utilisationSection(run: Run): Node {
  if (run.utilisation.length === 0) return h("p", {}, "timeline.json holds no packets (cosim --timeline 0, or units without a clock).");
  return h("div", {}, ...run.utilisation.flatMap((u) => {
    const whole = run.summary.units[u.unit];
    return [h("h4", {}, u.unit), chart(u),
      h("p", { class: "quiet" }, `Its first ${figure(u.packets)} packets, cycles ${figure(u.first)} to ${figure(u.last)}, ${figure(u.bucket)} cycles a step, ` +
        `on average ${figure(u.latency, 3)} cycles inside (timeline.json).` +
        (whole ? ` Over the whole run: ${figure(whole.counters["cycles"])} cycles, its own counter busy in ${figure(whole.busy_percent, 3)} % (summary.json).` : ""))];
  }), h("p", { class: "quiet" }, "A unit counts as busy here in a cycle in which at least one of these packets is inside. Packets beyond these are not counted, so a curve falls at its end while the unit stays full."));
}
