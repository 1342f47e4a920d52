// SPDX-License-Identifier: Apache-2.0
// The keys, as the page lists them.
import { h, table } from "./dom";

export const viewerKeys: [string, string][] = [
  ["1 2 3 4", "single image, side by side, signed difference, error map"],
  ["F", "flip: A becomes B and B becomes A"],
  ["A, B", "the next image as A, as B"],
  ["L, Shift+L", "next, previous layer"],
  ["], [", "exposure up, down by half a stop; in error maps the range down, up by half a stop"],
  ["+, −, 0", "zoom in, out, fit"],
  ["arrows", "move the inspected pixel; with Shift by ten"],
];
export const plotKeys: [string, string][] = [
  ["←, →", "previous, next point in order of cost"],
  ["Home, End", "cheapest, dearest point"],
  ["Enter", "open the point: its figures, plan and command"],
];

export function keysSection(): HTMLElement {
  const rows = (keys: [string, string][]) => keys.map(([k, what]) => [h("kbd", {}, k), what] as (Node | string)[]);
  return h("article", { id: "keys" }, h("h2", {}, "Keys"),
    h("p", {}, "Tab goes from control to control. The keys below act while the images or the plot have the focus."),
    h("h3", {}, "Images"), table(["key", "does"], rows(viewerKeys), "keys of the images"),
    h("h3", {}, "Plot"), table(["key", "does"], rows(plotKeys), "keys of the plot"));
}
