// SPDX-License-Identifier: Apache-2.0
// Images of one size beside each other: single, side by side, difference, error map, and a pixel's values in all layers.
import { Pane, type View } from "./canvas";
import type { Images, Layer, Picture } from "./data";
import { figure, h, picker, table } from "./dom";
import { combined, errorColor, errorKinds, mapped, most, signedColor, toneMapped } from "./pixels";
import { layerPixels, mapPixels } from "./unpack";

const modes = { single: "single", side: "side by side", difference: "difference", map: "error map" } as const;
type Mode = keyof typeof modes;
interface Pixels { layer: Layer; channels: Float32Array[]; delta: Float32Array[] | null }
type Kind = keyof typeof errorKinds | "flip";

const layerName = (name: string) => name || "image";
const isNormal = (layer: Layer) => layer.channels.some((c) => c.endsWith(".X"));

export class Viewer {
  readonly element: HTMLElement;
  private mode: Mode = "single";
  private kind: Kind = "absolute";
  private a: Picture;
  private b: Picture;
  private layer = "";
  private exposure = 0;
  private readonly exposures = new Map<string, number>();
  private readonly sums = new Map<string, Float32Array[]>();
  private pixel: { x: number; y: number } | null = null;
  private readonly view: View;
  private readonly panes: Pane[];
  private readonly bar = h("div", { class: "bar" });
  private readonly legend = h("div", { class: "legend" });
  private readonly status = h("p", { class: "status", role: "status" });
  private readonly inspector = h("div", { class: "inspector" });

  constructor(private readonly images: Images) {
    const { width, height, list } = images;
    this.a = list.find((p) => p.label === "golden") ?? list[list.length - 1]!;
    this.b = list.find((p) => p.label === "reference") ?? list[0]!;
    this.layer = this.layers()[0]!;
    this.exposure = this.goodExposure();
    this.view = { zoom: 1, x: width / 2, y: height / 2 };
    this.panes = [0, 1].map(() => new Pane(width, height, this.view, () => this.drawPanes(), (x, y) => this.pick(x, y)));
    const stage = h("div", { class: "panes" }, ...this.panes.map((p) => p.element));
    this.element = h("div", { class: "viewer", tabindex: 0, role: "group", "aria-label": "images; keys are listed at the end of the page" },
      this.bar, stage, this.legend, this.status, this.inspector);
    this.element.addEventListener("keydown", (e) => this.key(e));
    stage.addEventListener("wheel", (e) => {
      if (!this.element.contains(document.activeElement)) return;  // the page scrolls
      e.preventDefault();
      this.zoom(e.deltaY < 0 ? 1.25 : 0.8);
    }, { passive: false });
    new ResizeObserver(() => this.drawPanes()).observe(stage);
    this.paint();
  }

  // An image that equals another has that one's pixels.
  private source(p: Picture): Picture { return p.same_as ? this.images.list.find((q) => q.label === p.same_as)! : p; }
  private layersOf(p: Picture): Layer[] { return this.source(p).layers ?? []; }
  private layers(): string[] {
    return [...new Set([this.a, this.b].flatMap((p) => this.layersOf(p).map((l) => l.name)))];
  }
  /** `delta` is what the image differs from the base by; nothing where the layer was stored by itself. */
  private pixelsOf(p: Picture, name = this.layer): Pixels | null {
    const layer = this.layersOf(p).find((l) => l.name === name);
    if (!layer) return null;
    const stored = layerPixels(layer, this.images.width, this.images.height);
    if (this.source(p).label === this.images.base) return { layer, channels: stored, delta: stored.map((c) => new Float32Array(c.length)) };
    if (!layer.difference) return { layer, channels: stored, delta: null };
    const key = `${layer.payload}`, known = this.sums.get(key);
    const base = this.pixelsOf(this.images.list.find((q) => q.label === this.images.base)!, name)!;
    const at = layer.channels.map((c) => base.channels[base.layer.channels.indexOf(c)]!);
    const channels = known ?? stored.map((c, i) => c.map((v, k) => v + at[i]![k]!));
    this.sums.set(key, channels);
    return { layer, channels, delta: stored };
  }

  /** A − B channel by channel: of what was stored as differences, so that rounding of the images does not show. */
  private differences(a: Pixels, b: Pixels): Float32Array[] {
    const [x, y] = a.delta && b.delta ? [a.delta, b.delta] : [a.channels, b.channels];
    return x.map((c, i) => c.map((v, k) => v - (y[i]?.[k] ?? NaN)));
  }

  /** In half stops: 95 % of the pixels below 0.8. Kept, since maps ask for it again and again. */
  private goodExposure(): number {
    const key = `${this.source(this.a).label} ${this.layer}`, known = this.exposures.get(key);
    if (known !== undefined) return known;
    const pixels = this.pixelsOf(this.a);
    const bright = pixels?.channels[0]!.map((_, i) => Math.max(...pixels.channels.map((c) => c[i]!))).sort() ?? new Float32Array(1);
    const high = bright[Math.floor(0.95 * bright.length)]!;
    const exposure = high > 0 && Number.isFinite(high) ? Math.round(2 * Math.log2(0.8 / high)) / 2 : 0;
    this.exposures.set(key, exposure);
    return exposure;
  }

  private key(e: KeyboardEvent): void {
    if (e.ctrlKey || e.metaKey || e.altKey || e.target instanceof HTMLSelectElement || e.target instanceof HTMLInputElement) return;
    const step = e.shiftKey ? 10 : 1;
    const next = (p: Picture) => this.images.list[(this.images.list.indexOf(p) + 1) % this.images.list.length]!;
    const turn = (by: number) => {
      const all = this.layers();
      this.chooseLayer(all[(all.indexOf(this.layer) + by + all.length) % all.length]!);
    };
    const actions: Record<string, () => void> = {
      "1": () => { this.mode = "single"; }, "2": () => { this.mode = "side"; },
      "3": () => { this.mode = "difference"; }, "4": () => { this.mode = "map"; },
      f: () => { [this.a, this.b] = [this.b, this.a]; },
      a: () => { this.a = next(this.a); }, b: () => { this.b = next(this.b); },
      l: () => turn(e.shiftKey ? -1 : 1),
      "]": () => { this.exposure += 0.5; }, "[": () => { this.exposure -= 0.5; },
      "+": () => this.zoom(1.25), "=": () => this.zoom(1.25), "-": () => this.zoom(0.8), "0": () => this.fit(),
      arrowleft: () => this.move(-step, 0), arrowright: () => this.move(step, 0),
      arrowup: () => this.move(0, -step), arrowdown: () => this.move(0, step),
    };
    const action = actions[e.key.toLowerCase()];
    if (!action) return;
    e.preventDefault();
    action();
    this.paint();
  }

  private chooseLayer(name: string): void {
    this.layer = name;
    this.exposure = this.goodExposure();
  }
  private zoom(factor: number): void {
    if (this.pixel && this.view.zoom === 1) Object.assign(this.view, { x: this.pixel.x + 0.5, y: this.pixel.y + 0.5 });
    this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 0.5), 64);
    this.drawPanes();
    this.tell();
  }
  private fit(): void { Object.assign(this.view, { zoom: 1, x: this.images.width / 2, y: this.images.height / 2 }); }
  private move(dx: number, dy: number): void {
    const { width, height } = this.images, p = this.pixel ?? { x: width >> 1, y: height >> 1 };
    this.pick(Math.min(Math.max(p.x + dx, 0), width - 1), Math.min(Math.max(p.y + dy, 0), height - 1));
  }
  private pick(x: number, y: number): void {
    this.pixel = { x, y };
    this.drawPanes();
    this.tell();
    this.inspect();
  }

  private shows(...any: Mode[]): boolean { return any.includes(this.mode); }

  private paint(newBar = true): void {
    if (!this.layers().includes(this.layer)) this.layer = this.layers()[0]!;
    if (newBar) this.controls();
    this.legend.replaceChildren();
    const shown = this.mode === "side" ? 2 : 1;
    this.panes.forEach((p, i) => { p.element.hidden = i >= shown; });
    if (this.shows("single", "side"))
      [this.a, this.b].slice(0, shown).forEach((p, i) => this.paintImage(this.panes[i]!, p, i === 0 ? "A" : "B"));
    else this.paintError(this.panes[0]!);
    this.drawPanes();
    this.tell();
    this.inspect();
  }

  private caption(p: Picture, letter: string): string {
    return `${letter}: ${p.label}${p.same_as ? ` (every layer equal to ${p.same_as}, bit for bit)` : ""}, ${layerName(this.layer)}. ${p.about}; ${p.file}`;
  }
  private paintImage(pane: Pane, p: Picture, letter: string): void {
    const pixels = this.pixelsOf(p);
    if (!pixels) return this.blank(pane, `${letter}: ${p.label} has no layer ${layerName(this.layer)}`);
    pane.show(toneMapped(pixels.channels, this.exposure, isNormal(pixels.layer)), this.caption(p, letter));
  }
  private blank(pane: Pane, why: string): void {
    pane.show(new Uint8ClampedArray(4 * this.images.width * this.images.height), why);
  }

  private paintError(pane: Pane): void {
    const a = this.pixelsOf(this.a), b = this.pixelsOf(this.b), names = `A ${this.a.label}, B ${this.b.label}, ${layerName(this.layer)}`;
    if (!a || !b) return this.blank(pane, `${(a ? this.b : this.a).label} has no layer ${layerName(this.layer)}`);
    if (this.source(this.a) === this.source(this.b)) {
      pane.show(mapped(new Float32Array(this.images.width * this.images.height), () => errorColor(0)),
        `${names}: the same values in every layer, the difference is 0 everywhere`);
      return;
    }
    if (this.mode === "map" && this.kind === "flip") {
      const pair = this.images.pairs.find((p) => p.a === this.source(this.a).label && p.b === this.source(this.b).label);
      if (!pair || this.layer !== "") {
        this.blank(pane, pair ? "HDR-FLIP is of the image, not of a layer" : `HDR-FLIP was computed with the images in their listed order: press F for A and B the other way`);
        return;
      }
      pane.show(mapped(mapPixels(pair.flip_map, this.images.width, this.images.height), errorColor),
        `HDR-FLIP, ${names}: mean ${figure(pair.flip)}`);
      this.showLegend((t) => errorColor(t), ["0", "0.5", "1"], "HDR-FLIP");
      return;
    }
    const signed = this.mode === "difference", kind = errorKinds[this.kind === "flip" ? "absolute" : this.kind];
    const values = combined(this.differences(a, b), b.channels, signed ? (d) => d : kind.of);
    const whole = most(values), range = whole * 2 ** -this.rangeStops();
    const scale = range > 0 ? 1 / range : 0;
    pane.show(mapped(values, (v) => (signed ? signedColor : errorColor)(v * scale)),
      `${signed ? "A − B, mean of the channels" : kind.text}: ${names}; largest ${figure(whole, 3)}`);
    const unit = signed ? "A − B" : kind.text;
    if (signed) this.showLegend((t) => signedColor(2 * t - 1), [`${figure(-range, 3)}: A is darker`, "0", `${figure(range, 3)}: A is brighter`], unit);
    else this.showLegend(errorColor, ["0", figure(range / 2, 3), `${figure(range, 3)}${range < whole ? " and more" : ""}`], unit);
  }

  /** Stops by which an error map's range is below its largest value: the exposure above the image's own. */
  private rangeStops(): number { return this.exposure - this.goodExposure(); }

  private showLegend(color: (t: number) => readonly number[], labels: string[], unit: string): void {
    const stops = Array.from({ length: 17 }, (_, i) => `rgb(${color(i / 16).map(Math.round).join(" ")})`);
    this.legend.append(h("span", {}, unit), h("div", { class: "scale" },
      h("div", { class: "ramp", style: `background: linear-gradient(to right, ${stops.join(", ")})` }),
      h("div", { class: "ends" }, ...labels.map((l) => h("span", {}, l)))));
  }

  private drawPanes(): void { for (const p of this.panes) p.draw(this.pixel); }

  private tell(): void {
    const pair = this.images.pairs.find((p) => p.a === this.source(this.a).label && p.b === this.source(this.b).label);
    this.status.textContent = `zoom ${figure(this.view.zoom, 3)}×, ` +
      (this.shows("single", "side") ? `exposure ${figure(this.exposure, 3)} stops. ` : `range ${figure(0 - this.rangeStops(), 3)} stops. `) +
      (pair ? `${pair.a} against ${pair.b}: relMSE ${figure(pair.relmse)}, RMSE ${figure(pair.rmse)}, MAPE ${figure(pair.mape)}, ` +
        `mean ratio ${figure(pair.mean_ratio, 5)}, HDR-FLIP ${figure(pair.flip)} (of the files' 32-bit floats).` : "");
  }

  private controls(): void {
    const labels = this.images.list.map((p): [string, string] => [p.label, p.label]);
    const set = (change: () => void) => () => { change(); this.paint(); };
    const find = (label: string) => this.images.list.find((p) => p.label === label)!;
    const focused = this.bar.contains(document.activeElement) ? [...this.bar.querySelectorAll("select, button, input")].indexOf(document.activeElement!) : -1;
    const slider = h("input", { type: "range", min: -12, max: 12, step: 0.5, value: this.exposure, "aria-label": "exposure in stops" });
    const amount = () => figure(this.shows("single", "side") ? this.exposure : 0 - this.rangeStops(), 3);
    const output = h("output", {}, amount());
    slider.addEventListener("input", () => {
      this.exposure = Number(slider.value);
      output.textContent = amount();
      this.paint(false);  // a new bar would end the drag
    });
    this.bar.replaceChildren(
      h("span", { class: "modes", role: "group", "aria-label": "mode" }, ...(Object.keys(modes) as Mode[]).map((m) =>
        h("button", { type: "button", "data-mode": m, "aria-pressed": String(this.mode === m), onclick: set(() => { this.mode = m; }) }, modes[m]))),
      picker("A", labels, this.a.label, (v) => set(() => { this.a = find(v); })()),
      h("button", { type: "button", "data-flip": true, "aria-label": "flip A and B", onclick: set(() => { [this.a, this.b] = [this.b, this.a]; }) }, "A ⇄ B"),
      picker("B", labels, this.b.label, (v) => set(() => { this.b = find(v); })()),
      picker("layer", this.layers().map((l) => [l, layerName(l)]), this.layer, (v) => set(() => this.chooseLayer(v))()),
      ...(this.mode !== "map" ? [] : [picker("error", [...Object.entries(errorKinds).map(([k, e]): [string, string] => [k, e.text]), ["flip", "HDR-FLIP"]],
        this.kind, (v) => set(() => { this.kind = v as Kind; })())]),
      h("label", { class: "field" }, this.shows("single", "side") ? "exposure" : "range", slider, output),
      h("button", { type: "button", "aria-label": "zoom in", onclick: () => this.zoom(1.25) }, "+"),
      h("button", { type: "button", "aria-label": "zoom out", onclick: () => this.zoom(0.8) }, "−"),
      h("button", { type: "button", onclick: set(() => this.fit()) }, "fit"));
    if (focused >= 0) this.bar.querySelectorAll<HTMLElement>("select, button, input")[focused]?.focus();
  }

  private differenceAt(a: Pixels, b: Pixels, channel: string, at: number): number {
    const i = a.layer.channels.indexOf(channel), j = b.layer.channels.indexOf(channel);
    const [x, y] = a.delta && b.delta ? [a.delta, b.delta] : [a.channels, b.channels];
    return (x[i]?.[at] ?? NaN) - (y[j]?.[at] ?? NaN);
  }

  private inspect(): void {
    if (!this.pixel) {
      this.inspector.replaceChildren(h("p", { class: "quiet" }, "Click a pixel, or press an arrow key, for its values in all layers."));
      return;
    }
    const { x, y } = this.pixel, at = y * this.images.width + x, list = this.images.list;
    const rows: string[][] = [];
    for (const name of [...new Set(list.flatMap((p) => this.layersOf(p).map((l) => l.name)))]) {
      const of = list.map((p) => this.pixelsOf(p, name));
      for (const channel of [...new Set(of.flatMap((o) => o?.layer.channels ?? []))]) {
        const values = of.map((o) => o?.channels[o.layer.channels.indexOf(channel)]?.[at]);
        const a = of[list.indexOf(this.a)], b = of[list.indexOf(this.b)];
        const difference = a && b ? this.differenceAt(a, b, channel, at) : NaN;
        rows.push([channel, ...values.map((v) => figure(v)), Number.isNaN(difference) ? "–" : figure(difference, 3)]);
      }
    }
    this.inspector.replaceChildren(
      h("h4", {}, `Pixel (${x}, ${y}), number ${at}`),
      table(["channel", ...list.map((p) => p.label), "A − B"], rows, "values of the pixel"),
      h("p", { class: "quiet" }, `Rows and columns count from the top left, from 0. Values here are rounded to ${this.images.mantissa} mantissa bits ` +
        `(relative error up to 2^−${this.images.mantissa + 1}). Differences from ${this.images.base} were taken before that, and have this precision of their own; ` +
        "equality was decided on the files."));
  }
}
