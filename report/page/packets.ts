// SPDX-License-Identifier: Apache-2.0
// The first packets of each stream, searchable.
import type { Run, Stream } from "./data";
import { figure, h, picker, table } from "./dom";
import { jsonOf } from "./unpack";

type Row = (number | string)[];
const pageRows = 100;

/** Column names: a field of several elements has one a piece. */
const columns = (s: Stream) => s.fields.flatMap((f) =>
  f.elements > 1 ? Array.from({ length: f.elements }, (_, i) => `${f.name}[${i}]`) : [f.name]);

/** Words that all have to hold: `name=value` of a field, or a number that some field has. */
function matcher(text: string, names: string[]): { test: (row: Row) => boolean; unknown: string[] } {
  const unknown: string[] = [];
  const tests = text.trim().split(/\s+/).filter(Boolean).map((word) => {
    const [name, value] = word.split("=") as [string, string | undefined];
    if (value === undefined) return (row: Row) => row.some((v) => String(v) === word);
    const at = names.flatMap((n, i) => (n === name || n.startsWith(`${name}[`) ? [i] : []));
    if (at.length === 0) unknown.push(name);
    return (row: Row) => at.some((i) => String(row[i]) === value);
  });
  return { test: (row) => tests.every((t) => t(row)), unknown };
}

export function packetsSection(run: Run): Node {
  const streams = run.streams?.filter((s) => s.count > 0);
  if (!streams?.length) return h("p", {}, "This run has no packets.json; an older cosim wrote it.");
  let stream = streams.find((s) => s.stream === "gather_query") ?? streams[0]!, first = 0, rows: Row[] = [];
  const search = h("input", { type: "search", size: 32, placeholder: "pixel=12 map=0, or a number", "aria-label": "search packets" });
  const count = h("p", { class: "status", role: "status" }), holder = h("div", {});
  const turn = (by: number) => { first += by; show(); };
  const back = h("button", { type: "button", onclick: () => turn(-pageRows) }, "previous"), on = h("button", { type: "button", onclick: () => turn(pageRows) }, "next");
  const show = () => {
    const names = columns(stream), { test, unknown } = matcher(search.value, names);
    const hits = rows.flatMap((row, i) => (test(row) ? [{ row, i }] : []));
    first = Math.min(Math.max(first, 0), Math.max(0, hits.length - 1));
    const shown = hits.slice(first, first + pageRows);
    holder.replaceChildren(table(["packet", ...names], shown.map(({ row, i }) => [figure(i), ...row.map(String)]), `packets of ${stream.stream}`));
    const left = stream.count - stream.kept;
    count.textContent = (unknown.length ? `No field ${unknown.join(", ")}. ` : "") +
      `${shown.length ? `${figure(first + 1)} to ${figure(first + shown.length)}` : "None"} of ${figure(hits.length)} that match; the first ${figure(stream.kept)} of ` +
      `${figure(stream.count)} packets are here, ${figure(left)} are left out (cosim --packets).`;
    back.disabled = first === 0;
    on.disabled = first + pageRows >= hits.length;
  };
  const choose = (name: string) => {
    stream = streams.find((s) => s.stream === name)!;
    rows = jsonOf<Row[]>(stream.payload);
    first = 0;
    show();
  };
  search.addEventListener("input", () => { first = 0; show(); });
  choose(stream.stream);
  return h("div", {},
    h("div", { class: "bar" }, picker("stream", streams.map((s) => [s.stream, `${s.unit}: ${s.stream}`]), stream.stream, choose),
      h("label", { class: "field" }, "search", search), back, on),
    count, holder,
    h("p", { class: "quiet" }, "Golden's packets in stream order, from packets.json. The hardware's are the same, packet by packet, up to the first divergence."));
}
