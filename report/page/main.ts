// SPDX-License-Identifier: Apache-2.0
// The page: one part a run or study, each a list of sections. What is far down is built when it comes near.
import "uplot/dist/uPlot.min.css";
import "./style.css";
import type { Data } from "./data";
import { h } from "./dom";
import { keysSection } from "./keys";
import { runSections } from "./run";
import { studySections } from "./study";
import { themeButton } from "./theme";
import { jsonOf } from "./unpack";

/** `early` sections need no block of those that stand behind this script. */
export interface Section { title: string; early?: boolean; build: () => Node }

const parsed = new Promise<void>((done) => {
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", () => done());
  else done();
});

/** Builds a section once it is within a screen of being seen, or is asked for. */
function lazily(section: Section, id: string): HTMLElement {
  const heading = h("h3", {}, section.title);
  const part = h("section", { id, "aria-label": section.title }, heading);
  const watcher = new IntersectionObserver(async (entries) => {
    if (!entries.some((e) => e.isIntersecting)) return;
    watcher.disconnect();
    if (!section.early) await parsed;
    try {
      part.append(section.build());
    } catch (error) {
      part.append(h("p", { class: "bad", role: "alert" }, String(error)));
    }
    part.dataset.built = "";
  }, { rootMargin: "60% 0%" });
  watcher.observe(part);
  return part;
}

function part(kind: string, name: string, folder: string, number: number, sections: Section[]): HTMLElement {
  const id = (s: Section) => `${kind}${number}-${s.title.toLowerCase().replace(/[^a-z]+/g, "-")}`;
  return h("article", { id: `${kind}${number}` },
    h("h2", {}, `${kind === "run" ? "Run" : "Study"}: ${name} `, h("span", { class: "quiet" }, folder)),
    h("nav", { "aria-label": `sections of ${name}` }, ...sections.map((s) => h("a", { href: `#${id(s)}` }, s.title))),
    ...sections.map((s) => lazily(s, id(s))));
}


const page = document.getElementById("page")!;
try {
  const data = jsonOf<Data>("data");
  page.append(
    h("header", {},
      h("h1", {}, "Photonloom report"),
      h("span", { class: "quiet" }, data.program),
      themeButton()),
    ...data.studies.map((s, i) => part("study", s.study, s.folder, i, studySections(s, data.runs))),
    ...data.runs.map((r, i) => part("run", r.name, r.folder, i, runSections(r))),
    keysSection());
} catch (error) {
  page.append(h("p", { class: "bad", role: "alert" }, `This page cannot be shown: ${String(error)}`));
}
