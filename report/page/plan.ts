// SPDX-License-Identifier: Apache-2.0
// A plan, line by line, with the reason for each.
import type { PlanLine } from "./data";
import { h, table } from "./dom";

/** `set`: lines that the point itself sets, marked. */
export function planTable(hash: string, lines: PlanLine[], set: string[] = []): HTMLElement {
  const rows = lines.map((l) => {
    const line = `${l.section}.${l.key}`, mine = set.includes(line);
    return [h("code", {}, mine ? `▸ ${line}` : line), h("code", {}, l.value), l.meaning, l.reason || "–"];
  });
  const search = h("input", { type: "search", placeholder: "line, value or reason", "aria-label": "search the plan" });
  const holder = h("div", {});
  const show = () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = rows.filter((_, i) => {
      const l = lines[i]!, text = `${l.section}.${l.key} ${l.value} ${l.meaning} ${l.reason}`.toLowerCase();
      return words.every((w) => text.includes(w));
    });
    holder.replaceChildren(table(["line", "value", "meaning", "reason"], kept, `plan ${hash}`));
  };
  search.addEventListener("input", show);
  show();
  return h("div", {}, h("div", { class: "bar" }, h("span", {}, "Plan ", h("code", {}, hash)), search,
    set.length ? h("span", { class: "quiet" }, "▸ set by this point") : null), holder,
    h("p", { class: "quiet" }, "Values and reasons as in plan.toml; a dash: the planner gave the line no reason, or the file came without."));
}
