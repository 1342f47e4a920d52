// SPDX-License-Identifier: Apache-2.0
// A pane that shows pixels under a view that several panes share: zoom, and the image point at its centre.
import { h } from "./dom";

export interface View { zoom: number; x: number; y: number }  // zoom 1: the image fills the pane

export class Pane {
  readonly canvas = h("canvas", { role: "img" });
  readonly caption = h("figcaption", {});
  readonly element = h("figure", { class: "pane" }, this.canvas, this.caption);
  private readonly source = document.createElement("canvas");

  constructor(private readonly width: number, private readonly height: number, private readonly view: View,
              private readonly moved: () => void, picked: (x: number, y: number) => void) {
    this.source.width = width;
    this.source.height = height;
    let drag: { x: number; y: number; far: boolean } | null = null;
    this.canvas.addEventListener("pointerdown", (e) => {
      drag = { x: e.clientX, y: e.clientY, far: false };
      this.canvas.setPointerCapture(e.pointerId);
    });
    this.canvas.addEventListener("pointermove", (e) => {
      if (!drag) return;
      const dx = e.clientX - drag.x, dy = e.clientY - drag.y;
      if (!drag.far && Math.hypot(dx, dy) < 4) return;
      drag = { x: e.clientX, y: e.clientY, far: true };
      this.view.x -= dx / this.cssScale();
      this.view.y -= dy / this.cssScale();
      this.moved();
    });
    this.canvas.addEventListener("pointerup", (e) => {
      if (drag && !drag.far) {
        const box = this.canvas.getBoundingClientRect();
        const x = Math.floor(this.view.x + (e.clientX - box.left - box.width / 2) / this.cssScale());
        const y = Math.floor(this.view.y + (e.clientY - box.top - box.height / 2) / this.cssScale());
        if (x >= 0 && y >= 0 && x < width && y < height) picked(x, y);
      }
      drag = null;
    });
  }

  /** CSS pixels an image pixel. */
  private cssScale(): number { return (this.canvas.clientWidth / this.width) * this.view.zoom; }

  show(rgba: Uint8ClampedArray<ArrayBuffer>, caption: string): void {
    this.source.getContext("2d")!.putImageData(new ImageData(rgba, this.width, this.height), 0, 0);
    this.caption.textContent = caption;
    this.canvas.setAttribute("aria-label", caption);
  }

  draw(pixel: { x: number; y: number } | null): void {
    const ratio = window.devicePixelRatio || 1, css = this.canvas.clientWidth;
    if (css === 0) return;
    const w = Math.round(css * ratio), hgt = Math.round((w * this.height) / this.width);
    if (this.canvas.width !== w || this.canvas.height !== hgt) {
      this.canvas.width = w;
      this.canvas.height = hgt;
    }
    const c = this.canvas.getContext("2d")!, scale = (w / this.width) * this.view.zoom;
    const left = w / 2 - this.view.x * scale, top = hgt / 2 - this.view.y * scale;
    c.imageSmoothingEnabled = scale < 1;
    c.clearRect(0, 0, w, hgt);
    c.drawImage(this.source, left, top, this.width * scale, this.height * scale);
    if (!pixel) return;
    const size = Math.max(scale, 5 * ratio), px = left + (pixel.x + 0.5) * scale - size / 2, py = top + (pixel.y + 0.5) * scale - size / 2;
    c.lineWidth = 3 * ratio;
    c.strokeStyle = "#000";
    c.strokeRect(px, py, size, size);
    c.lineWidth = ratio;
    c.strokeStyle = "#fff";
    c.strokeRect(px, py, size, size);
  }
}
