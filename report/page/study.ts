// SPDX-License-Identifier: Apache-2.0
// The sections of a study.
import type { Point, Run, Study } from "./data";
import { figure, h, picker, table } from "./dom";
import { figuresOf, isError, linesText, reading } from "./figures";
import type { Section } from "./main";
import { pointDetail } from "./point";
import { card } from "./run";
import { Scatter, swatch, type Dot } from "./scatter";
import { Viewer } from "./viewer";

const limits = [1.02, 1.1, 1.2, 1.5, 2];
const states = ["done", "refused", "failed", "missing"];

/** The first error that the study measured, by which its fronts go too. */
const mainError = (study: Study): string | undefined =>
  ["visible.relmse", "formats.relmse"].find((name) => study.points.some((p) => reading(p, name, false)));

function answers(study: Study): Node {
  const error = mainError(study);
  if (!error) return h("p", {}, "This study measured no error.");
  const rows = study.scenes.flatMap((scene) => limits.map((limit) => {
    const within = study.points.filter((p) => p.scene === scene.scene && p.state === "done" && (reading(p, error, true)?.value ?? Infinity) <= limit);
    return [scene.scene, figure(limit), ...study.fronts.map(({ cost }) => {
      const best = within.flatMap((p) => { const r = reading(p, cost, true); return r ? [{ p, r }] : []; }).sort((a, b) => a.r.value - b.r.value)[0];
      return best ? `${figure(best.r.value, 3)} (point ${best.p.point})` : "–";
    })];
  }));
  return h("div", {},
    h("h4", {}, "What accepting more error saves"),
    table(["scene", `${error} at most, times the baseline's`, ...study.fronts.map((f) => `${f.cost}, ratio`)], rows, "answers"),
    h("p", { class: "quiet" }, `The least cost of a measured point as a ratio to the scene's baseline, on the same seeds (summary.json). ` +
      "The mean of the error's ratio has to meet the limit; its standard error stands with the point."));
}

function summary(study: Study): Node {
  const cards = states.map((s) => card(`points ${s}`, figure(study.points.filter((p) => p.state === s).length), `of ${study.points.length}`, "summary.json: state"));
  const error = mainError(study);
  const unit = new Map(figuresOf(study).map((f) => [f.name, f.unit]));
  const names = [...(error ? [error] : []), "visible.flip", ...study.fronts.map((f) => f.cost)].filter((n, i, all) => unit.has(n) && all.indexOf(n) === i);
  const rows = study.scenes.map((s) => {
    const base = study.points.find((p) => p.point === s.baseline);
    return [s.scene, `${base?.seeds ?? (study.seeds ?? []).length}`, ...names.map((n) => {
      const r = base ? reading(base, n, false) : null;
      return r ? `${figure(r.value)}${r.error ? ` ± ${figure(r.error, 2)}` : ""}` : "–";
    }), s.reference_relmse === null || s.reference_relmse === undefined ? "–" : figure(s.reference_relmse, 3)];
  });
  return h("div", {}, h("div", { class: "cards" }, ...cards),
    h("h4", {}, "Baselines: the default plan of each scene"),
    table(["scene", "seeds", ...names.map((n) => n + (unit.get(n) ? `, ${unit.get(n)}` : "")), "references' own relMSE"], rows, "baselines"),
    h("p", { class: "quiet" }, `Means over so many first seeds of the study, or fewer where a measure takes fewer, with the standard error that other seeds would show (docs/sweep.md).`),
    ...study.scenes.filter((s) => s.failure).map((s) => h("p", { class: "bad" }, `✗ Scene ${s.scene} cannot be used: ${s.failure}`)),
    answers(study));
}

/** Whether the figure comes from the model that was fitted to the RTL (docs/sweep.md). */
const isModelled = (point: Point, name: string): boolean =>
  ["gather.cycles", "gather.bytes", "gather.frame_cycles"].includes(name) && reading(point, "gather.source", false)?.value === 0;

/** Mark of a point in the plot: the plan in use is a run's where there is one, else the default. */
function markOf(study: Study, point: Point, runs: Run[]): string {
  const run = runs.find((r) => r.plan.hash === point.plan && r.name === point.scene);
  const base = study.scenes.some((s) => s.baseline === point.point);
  const inUse = run || (base && !runs.some((r) => r.name === point.scene && study.points.some((p) => p.plan === r.plan.hash && p.scene === r.name)));
  return [inUse ? "plan in use" : "", base ? "default" : ""].filter(Boolean).join(", ");
}

function tradeoff(study: Study, runs: Run[]): Node {
  const figures = figuresOf(study).filter((f) => study.points.some((p) => reading(p, f.name, false)));
  const errors = figures.filter((f) => isError(f.name)), costs = figures.filter((f) => !isError(f.name));
  if (errors.length === 0 || costs.length === 0) return h("p", {}, "This study has not both an error and a cost.");
  const option = (f: { name: string; unit: string }): [string, string] => [f.name, f.unit ? `${f.name}, ${f.unit}` : f.name];
  const text = (f: { name: string }) => f.name;
  let x = costs.find((f) => f.name === study.fronts[0]?.cost)?.name ?? text(costs[0]!), y = mainError(study) ?? text(errors[0]!);
  let scene = "", asRatio = study.scenes.length > 1, log = true, words: string[] = [];
  const shape = new Map(study.scenes.map((s, i) => [s.scene, i]));
  const byId = new Map(study.points.map((p) => [p.point, p]));
  const value = (p: Point, name: string) => {
    const r = reading(p, name, asRatio);
    return r ? `${figure(r.value)}${r.error ? ` ± ${figure(r.error, 2)}` : ""}` : "–";
  };
  const describe = (id: number) => {
    const p = byId.get(id)!, mark = markOf(study, p, runs);
    return `point ${id}, ${p.scene}${mark ? ` (${mark})` : ""}: ${linesText(p)}. ${y}${asRatio ? " ratio" : ""} ${value(p, y)}, ${x}${asRatio ? " ratio" : ""} ${value(p, x)}${isModelled(p, x) ? ", from the model" : ""}`;
  };
  const detail = h("div", { class: "detail" }), list = h("div", {}), absent = h("div", {}), note = h("p", { class: "quiet" });
  const open = (id: number) => {
    detail.replaceChildren(pointDetail(study, byId.get(id)!, markOf(study, byId.get(id)!, runs)));
    scatter.point(id);
    detail.querySelector<HTMLElement>("[tabindex]")?.focus();
  };
  const scatter = new Scatter(describe, open);
  const matches = (p: Point) => {
    const all = `${p.point} ${p.scene} ${p.plan} ${p.origin} ${p.state} ${p.reason ?? ""} ${linesText(p)} ${(p.front ?? []).join(" ")}`.toLowerCase();
    return (!scene || p.scene === scene) && words.every((w) => all.includes(w));
  };
  const show = () => {
    const kept = study.points.filter(matches), dots: Dot[] = [], without: [Point, string][] = [];
    for (const p of kept) {
      const px = reading(p, x, asRatio), py = reading(p, y, asRatio);
      if (p.state !== "done") without.push([p, `${p.state}${p.reason ? `: ${p.reason}` : ""}`]);
      else if (!px || !py) without.push([p, `has no ${px ? y : x}`]);
      else if (log && (px.value <= 0 || py.value <= 0)) without.push([p, `has no place on logarithmic axes: ${px.value <= 0 ? x : y} is ${figure(Math.min(px.value, py.value))}`]);
      else dots.push({ id: p.point, series: shape.get(p.scene) ?? 0, x: px.value, y: py.value, error: py.error, mark: markOf(study, p, runs), modelled: isModelled(p, x) });
    }
    const label = (name: string) => {
      const f = figures.find((g) => g.name === name)!;
      return asRatio ? `${name}, ratio to the scene's default plan` : `${name}${f.unit ? `, ${f.unit}` : ""}`;
    };
    scatter.show(dots, { x: label(x), y: label(y), log });
    note.textContent = `${figure(dots.length)} points drawn, ${figure(without.length)} listed below and not drawn, ${figure(study.points.length - kept.length)} filtered out. ` +
      `${y}: ${figures.find((f) => f.name === y)!.meaning}; bars: ± one standard error. ${x}: ${figures.find((f) => f.name === x)!.meaning}. Stairs: no point shown of that scene has less of both.`;
    const button = (p: Point) => h("button", { type: "button", "data-point": p.point, onclick: () => open(p.point) }, String(p.point));
    list.replaceChildren(table(["point", "scene", "lines", y, x, "mark, fronts"], dots.map((d) => {
      const p = byId.get(d.id)!;
      return [button(p), p.scene, linesText(p), value(p, y), value(p, x), [d.mark, ...(p.front ?? [])].filter(Boolean).join(", ")];
    }), "points drawn"));
    absent.replaceChildren(without.length === 0 ? "" : table(["point", "scene", "lines", "why it is not drawn"],
      without.map(([p, why]) => [button(p), p.scene, linesText(p), why]), "points not drawn"));
  };
  const filter = h("input", { type: "search", size: 26, placeholder: "gather.k = 8, grid, failed, ...", "aria-label": "filter points" });
  filter.addEventListener("input", () => { words = filter.value.toLowerCase().split(",").map((w) => w.trim()).filter(Boolean); show(); });
  const box = (label: string, on: boolean, change: (on: boolean) => void) => {
    const input = h("input", { type: "checkbox" });
    input.checked = on;
    input.addEventListener("change", () => { change(input.checked); show(); });
    return h("label", { class: "field" }, input, label);
  };
  show();
  return h("div", {},
    h("div", { class: "bar" },
      picker("error", errors.map(option), y, (v) => { y = v; show(); }), picker("cost", costs.map(option), x, (v) => { x = v; show(); }),
      picker("scene", [["", "all"], ...study.scenes.map((s): [string, string] => [s.scene, s.scene])], scene, (v) => { scene = v; show(); }),
      h("label", { class: "field" }, "filter", filter),
      box("ratio to the default", asRatio, (on) => { asRatio = on; }), box("logarithmic", log, (on) => { log = on; })),
    h("div", { class: "marks" }, ...study.scenes.map((s, i) => h("span", {}, swatch(i), ` ${s.scene}`)), h("span", { class: "quiet" }, "ring: plan in use, default; hollow: cost from the model fitted to the RTL")),
    scatter.element, note, detail,
    h("details", { open: true }, h("summary", {}, "Points drawn"), list),
    h("details", { open: true }, h("summary", {}, "Points not drawn"), absent));
}

function pictures(study: Study): Node {
  const shown = study.scenes.filter((s) => s.images);
  if (shown.length === 0) return h("p", {}, "The sweep's folder holds no images: its references came from other files. photonloom report --image SCENE/LABEL=FILE.exr adds some.");
  return h("div", {}, ...shown.flatMap((s) => [h("h4", {}, s.scene), new Viewer(s.images!).element]),
    h("p", { class: "quiet" }, "Images that the points of a scene share, for looking at. A point's own image: run its command, then photonloom render or cosim with the plan."));
}

export function studySections(study: Study, runs: Run[]): Section[] {
  return [
    { title: "Summary", early: true, build: () => summary(study) },
    { title: "Error against cost", build: () => tradeoff(study, runs) },
    { title: "Images", build: () => pictures(study) },
  ];
}
