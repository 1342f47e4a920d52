// SPDX-License-Identifier: Apache-2.0
// One point of a study: its figures, its command, its plan with reasons.
import type { Plans, Point, Study } from "./data";
import { command, figure, h, table } from "./dom";
import { figuresOf } from "./figures";
import { linesText } from "./figures";
import { planTable } from "./plan";
import { jsonOf } from "./unpack";

const unpacked = new Map<Study, Plans>();

function plansOf(study: Study): Plans {
  const known = unpacked.get(study) ?? jsonOf<Plans>(study.plans);
  unpacked.set(study, known);
  return known;
}

export function pointDetail(study: Study, point: Point, mark: string): HTMLElement {
  const rows = figuresOf(study).filter((f) => point.values[f.name]).map((f) => {
    const m = point.values[f.name]!, plusMinus = (v: number | null, e: number | null) => (v === null ? "–" : `${figure(v)}${e ? ` ± ${figure(e, 2)}` : ""}`);
    return [f.name, plusMinus(m.mean, m.error), f.unit, plusMinus(m.ratio, m.ratio_error), f.meaning];
  });
  const plans = plansOf(study), plan = plans.plans[point.plan];
  const set = Object.keys(point.lines).flatMap((names) => {
    const [first, ...rest] = names.split("+");  // as docs/sweep.md: one value for several lines
    return [first!, ...rest];
  });
  return h("div", { tabindex: -1, id: `point${point.point}` },
    h("h4", {}, `Point ${point.point}, ${point.scene}${mark ? ` (${mark})` : ""}: ${linesText(point)}`),
    h("p", {}, `From ${point.origin}; ${point.state}${point.reason ? `: ${point.reason}` : ""}.`),
    rows.length ? table(["figure", "mean", "unit", "ratio to the default", "meaning"], rows, "figures of the point") : null,
    h("h4", {}, "The command that writes its plan"),
    point.command ? command(point.command) : h("p", { class: "quiet" }, "There is none: no plan has these lines, or the point was not planned."),
    h("h4", {}, "Its plan, and why each line"),
    plan ? planTable(point.plan, plan.map(([value, reason], i) => {
      const [section, key, meaning] = plans.meanings[i]!;
      return { section, key, meaning, value, reason };
    }), set) : h("p", { class: "quiet" }, "The sweep's folder holds no plan file of this point; the command above writes it."));
}
