// SPDX-License-Identifier: Apache-2.0
// Dark or light: as the system says, until the reader says otherwise. Plots redraw on "theme".
import { h } from "./dom";

const dark = matchMedia("(prefers-color-scheme: dark)");

export function themeButton(): HTMLButtonElement {
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : dark.matches);
  const show = () => {
    button.textContent = isDark() ? "light" : "dark";
    button.setAttribute("aria-label", `use the ${button.textContent} theme`);
    document.dispatchEvent(new Event("theme"));
  };
  const button = h("button", { type: "button", id: "theme", onclick: () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    show();
  } });
  dark.addEventListener("change", show);
  show();
  return button;
}

/** A colour of the style sheet, as it is now. */
export function themeColor(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
