// SPDX-License-Identifier: Apache-2.0
// Elements in one expression, and how the page writes numbers.

type Value = string | number | boolean | EventListener;
type Child = Node | string | null;

/** An element with attributes (`onclick` and its kin are listeners; false leaves one out) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Record<string, Value> = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (value !== false) element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children.filter((c): c is Node | string => c !== null));
  return element;
}

/** A labelled drop-down; `chosen` is called with the value. */
export function picker(label: string, options: [value: string, text: string][], value: string,
                       chosen: (value: string) => void): HTMLLabelElement {
  const select = h("select", { "aria-label": label, onchange: () => chosen(select.value) },
    ...options.map(([v, text]) => h("option", { value: v, selected: v === value }, text)));
  return h("label", { class: "field" }, label, select);
}

const numeric = /^[−+±]?\d[\d.,]*(e[−+]?\d+)?( ± [\d.,e−+]+)?( \([^()]*\))?$/;

/** A table whose first row is the head; cells may be elements. Numbers stand to the right, a column of them under its head. */
export function table(head: string[], rows: (Node | string)[][], name = ""): HTMLElement {
  const right = (cell: Node | string | undefined) => (typeof cell === "string" && numeric.test(cell) ? "number" : "");
  return h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": name || head.join(", ") },
    h("table", {},
      h("thead", {}, h("tr", {}, ...head.map((t, i) => h("th", { scope: "col", class: right(rows[0]?.[i]) }, t)))),
      h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((cell) => h("td", { class: right(cell) }, cell)))))));
}

/** Whole numbers in groups of three, others with so many significant digits. */
export function figure(x: number | null | undefined, digits = 4): string {
  if (x === null || x === undefined) return "–";
  if (!Number.isFinite(x)) return String(x);
  if (Number.isInteger(x) && Math.abs(x) < 1e15) return x.toLocaleString("en-US").replace("-", "−");
  const a = Math.abs(x);
  const text = a >= 1e-4 && a < 1e6
    ? (a >= 10 ** (digits - 1) ? Math.round(x).toLocaleString("en-US") : Number(x.toPrecision(digits)).toString())
    : x.toExponential(digits - 1);
  return text.replace("-", "−");
}

/** A command in a box with a button that copies it. */
export function command(text: string): HTMLElement {
  const button = h("button", { type: "button", onclick: () => {
    void navigator.clipboard?.writeText(text);
    button.textContent = "copied";
  } }, "copy");
  return h("div", { class: "command" }, h("code", {}, text), button);
}
