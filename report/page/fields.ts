// SPDX-License-Identifier: Apache-2.0
// Bits that the plan gives to each packet field beside the bits that this frame's widest value takes.
import type { Run } from "./data";
import { figure, h, table } from "./dom";

export function fieldsSection(run: Run): Node {
  if (!run.streams) return h("p", {}, "This run has no packets.json; an older cosim wrote it.");
  const rows: (Node | string)[][] = [];
  for (const s of run.streams.filter((s) => s.count > 0 && s.stream !== "reorder_in"))
    for (const f of s.fields) {
      const meter = h("span", { class: "meter", role: "img", "aria-label": `${f.used} of ${f.bits} bits used`, style: `width: ${4 * f.bits + 2}px` },
        h("span", { style: `width: ${(100 * f.used) / f.bits}%` }));
      rows.push([h("code", {}, `${s.stream}.${f.name}`), figure(f.bits), figure(f.used), figure(f.bits - f.used), meter,
        typeof f.most === "number" ? figure(f.most) : f.most, f.unit, f.elements > 1 ? `${f.meaning} (each of ${f.elements})` : f.meaning]);
    }
  const silent = run.streams.filter((s) => s.count === 0).map((s) => s.stream);
  return h("div", {},
    table(["field", "given", "used", "spare", "bits", "largest value", "unit", "meaning"], rows, "bits given and used"),
    h("p", { class: "quiet" }, "Over all of golden's packets of this frame, from packets.json. Filled: used; hatched: spare in this frame. " +
      "Another seed or view may need bits that this one spares: the plan's proof of no overflow counts the worst case. " +
      (silent.length ? `No packets: ${silent.join(", ")}.` : "")));
}
