// SPDX-License-Identifier: Apache-2.0
// The sections of a run.
import type { Resource, Run } from "./data";
import { command, figure, h, table } from "./dom";
import { fieldsSection } from "./fields";
import type { Section } from "./main";
import { packetsSection } from "./packets";
import { planTable } from "./plan";
import { utilisationSection } from "./utilisation";
import { Viewer } from "./viewer";

export function card(name: string, value: string, unit: string, source: string): HTMLElement {
  return h("dl", { class: "card" }, h("dt", {}, name),
    h("dd", { class: "value" }, value, unit ? h("span", { class: "quiet" }, ` ${unit}`) : ""), h("dd", { class: "source" }, source));
}

/** Where gathers found too few photons, and what mends it. */
function shortages(run: Run): Node[] {
  const regions = run.summary.diagnosis?.regions;
  if (!regions) return [];
  return [h("h4", {}, "Photons"), regions.length === 0
    ? h("p", {}, "No region is short of photons.")
    : h("ul", {}, ...regions.map((r) => h("li", {}, h("strong", {}, `${r.cause}: `), r.message))),
  h("p", { class: "quiet" }, "From summary.json: diagnosis. The layers noPhoton, fewPhotons and starvedLight show where (docs/frame.md).")];
}

/** What ended at the end of a range, and how often. */
function saturations(run: Run): Node[] {
  const s = run.summary, counts = s.counts;
  if (!counts) return [];
  const ofFrame: [string, string][] = [
    ["gathers with r² below r2_floor", "clamped"],
    ["samples that found their tile's cache full", "cache_full"],
    ["weights that did not fit the pixel", "saturated_weights"],
    ["values of direct light that did not fit the pixel", "saturated_direct"],
    ["values of light that were no number", "not_finite"],
    ["queries and lookups outside of the cube", "outside_positions"],
    ["radii of records beyond cache.radius_min or radius_max", "clamped_radii"],
    ["reaches of records below a position unit or beyond the cube", "clamped_reaches"],
    ["numbers of gradients that did not fit", "saturated_gradients"],
    ["channels of a record's light that would change by more than all of it", "clamped_changes"]];
  const ofPhotons: [string, number | undefined, string][] = [
    ["photons whose power became 0", s.zeroed_photons, "zeroed_photons"],
    ["photons whose power was clipped", s.saturated_photons, "saturated_photons"],
    ["photons outside of the cube", s.outside_photons, "outside_photons"]];
  return [h("h4", {}, "Saturation"), table(["what", run.hardware, "golden", "summary.json"], [
    ...ofFrame.map(([what, name]) => [what, figure(counts[name] ?? null), figure(s.golden_counts?.[name] ?? null), `counts.${name}`]),
    ...ofPhotons.map(([what, n, source]) => [what, figure(n ?? null), figure(n ?? null), source])], "saturation")];
}

function summary(run: Run): Node {
  const s = run.summary, good = s.differences === 0 && s.images_identical;
  const gatherer = s.units["photon_gatherer"]?.counters, cards: HTMLElement[] = [];
  const put = (name: string, value: number | undefined, unit: string, source: string, digits = 4) => {
    if (value !== undefined && Number.isFinite(value)) cards.push(card(name, figure(value, digits), unit, source));
  };
  put("compared with golden", s.packets, "packets", "summary.json: packets");
  put("differ", s.differences, "packets", "summary.json: differences");
  const pair = run.images.pairs.find((p) => p.a === "golden" && p.b === run.images.list[0]!.label);
  if (pair) {
    const source = `golden.exr against ${run.images.list[0]!.file.split("/").pop()}, all pixels`;
    put(`relMSE against ${pair.b}`, pair.relmse, "", source);
    put(`HDR-FLIP against ${pair.b}`, pair.flip, "", source);
    put("mean ratio", pair.mean_ratio, "", source, 5);
  }
  if (gatherer) {
    const asked = (gatherer["packets in"] ?? NaN) - (gatherer["packets resumed"] ?? 0);
    if (!gatherer["link bytes out"])
      put("photon_gatherer", (gatherer["cycles"] ?? NaN) / asked, "cycles a gather", "summary.json: counters cycles / packets in");
    put("photon_gatherer", (gatherer["bytes read"] ?? NaN) / asked, "bytes a gather", "summary.json: counters bytes read / packets in");
  }
  put("predicted logic", run.resources.reduce((sum, u) => sum + u.lut.value, 0), "LUT-equivalents, all units", "prediction from plan.toml");
  put("final gathers", s.final_gathers, "queries", "summary.json: final_gathers");
  return h("div", {},
    h("p", { class: good ? "good" : "bad" }, good
      ? `✓ ${run.hardware} is golden: every packet equal, and the image's bytes.`
      : `✗ ${run.hardware} is not golden: ${figure(s.differences)} of ${figure(s.packets)} packets differ, the image's bytes are ${s.images_identical ? "equal" : "different"}.`),
    h("div", { class: "cards" }, ...cards),
    ...shortages(run),
    ...saturations(run),
    h("h4", {}, "Units"),
    table(["unit", "backend", "packets compared", "differ", "bypassed", "cycles", "busy %"],
      Object.entries(s.units).map(([name, u]) => [name, u.backend, figure(u.packets), figure(u.differences), figure(u.bypassed),
        figure(u.counters["cycles"] ?? null), figure(u.busy_percent, 3)]), "units"),
    h("p", { class: "quiet" }, "From summary.json. Cycles are of the unit's own clock, under the memory and stalls that the command asks for."),
    h("h4", {}, "Again"),
    s.command ? command(s.command) : h("p", { class: "quiet" }, "This run's summary does not hold its command."));
}

function divergence(run: Run): Node {
  const reports = Object.entries(run.summary.units).filter(([, u]) => u.first_difference);
  if (reports.length === 0)
    return h("p", {}, run.summary.differences === 0
      ? `There was none: ${figure(run.summary.packets)} packets compared, 0 differences.`
      : "Packets differ, but this run's summary does not hold the first of them.");
  return h("div", {}, ...reports.flatMap(([unit, u]) => [
    h("h4", {}, `${unit}: the first of ${figure(u.differences)}`), h("pre", { tabindex: 0 }, u.first_difference!)]));
}

function resources(run: Run): Node {
  const names: [Resource, string][] = [["lut", "LUT-equivalents"], ["ff", "flip-flops"], ["dsp", "multipliers"], ["ebr", "block RAMs"]];
  return h("div", {},
    table(["unit", ...names.map(([, text]) => text)], [
      ...run.resources.map((u) => [u.unit, ...names.map(([n]) => `${figure(Math.round(u[n].value))} (±${figure(100 * u[n].error, 2)} %)`)]),
      ["all units", ...names.map(([n]) => figure(Math.round(run.resources.reduce((sum, u) => sum + u[n].value, 0))))]], "resources"),
    h("p", { class: "quiet" }, "Predicted from the plan for an LFE5U, not synthesized. In brackets the largest relative error over the plans that were " +
      "(docs/fpga-plans.md). LUT-equivalents are LUT4 + 2 CCU2C + 4 DPR16X4; a block RAM has 18 Kibit."));
}

export function runSections(run: Run): Section[] {
  return [
    { title: "Summary", early: true, build: () => summary(run) },
    { title: "Images", build: () => new Viewer(run.images).element },
    { title: "First divergence", build: () => divergence(run) },
    { title: "Units over time", build: () => utilisationSection(run) },
    { title: "Bits given and used", build: () => fieldsSection(run) },
    { title: "Packets", build: () => packetsSection(run) },
    { title: "Resources", build: () => resources(run) },
    { title: "Plan", build: () => planTable(run.plan.hash, run.plan.lines) },
  ];
}
