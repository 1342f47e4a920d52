// SPDX-License-Identifier: Apache-2.0
// Points with error bars, a frontier a series, marks; hover and keys. uPlot gives scales and axes.
import uPlot from "uplot";
import { seriesColors, seriesDashes, seriesShapes, tracePath } from "./color";
import { figure, h } from "./dom";
import { frontier } from "./figures";
import { themeColor } from "./theme";

export interface Dot { id: number; series: number; x: number; y: number; error: number; mark: string; modelled: boolean }
export interface Axes { x: string; y: string; log: boolean }

/** Ticks at 1, 2, 5 a decade where the range is wide, else evenly. */
function ticks(low: number, high: number, log: boolean): number[] {
  const all: number[] = [];
  if (log && high / low > 30) {
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e)
      for (const m of high / low > 500 ? [1] : [1, 2, 5]) all.push(Number(`${m}e${e}`));
  } else {
    const rough = (high - low) / 6, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 5, 10].find((m) => m * power >= rough) ?? 10);
    for (let i = Math.ceil(low / step); i * step <= high; ++i) all.push(Number((i * step).toPrecision(12)));
  }
  return all.filter((t) => t >= low && t <= high);
}

function padded(values: number[], log: boolean): [number, number] {
  const low = Math.min(...values), high = Math.max(...values);
  if (log) return [low / 1.15, high * 1.15];
  const pad = 0.06 * (high - low || Math.abs(high) || 1);
  return [low - pad, high + pad];
}

export class Scatter {
  readonly element: HTMLElement;
  private readonly tip = h("div", { class: "tip", hidden: true });
  private readonly said = h("p", { class: "status", role: "status" });
  private readonly holder = h("div", {});
  private plot: uPlot | undefined;
  private dots: Dot[] = [];
  private axes: Axes = { x: "", y: "", log: true };
  private current = -1;

  constructor(private readonly describe: (id: number) => string, private readonly chosen: (id: number) => void) {
    const box = h("div", { class: "plot", tabindex: 0, role: "group", "aria-label": "plot of error against cost; arrow keys go from point to point, Enter opens one" },
      this.holder, this.tip);
    box.addEventListener("keydown", (e) => this.key(e));
    this.element = h("div", {}, box, this.said);
    new ResizeObserver(() => this.draw()).observe(box);
    document.addEventListener("theme", () => this.draw());
  }

  show(dots: Dot[], axes: Axes): void {
    const id = this.dots[this.current]?.id;
    this.dots = [...dots].sort((a, b) => a.x - b.x || a.y - b.y);
    this.axes = axes;
    this.current = this.dots.findIndex((d) => d.id === id);
    this.tip.hidden = true;
    this.draw();
  }

  /** Marks the point without opening it. */
  point(id: number): void {
    this.current = this.dots.findIndex((d) => d.id === id);
    this.plot?.redraw(false);
  }

  private key(e: KeyboardEvent): void {
    const last = this.dots.length - 1;
    const to: Record<string, number> = {
      ArrowRight: Math.min(this.current + 1, last), ArrowLeft: Math.max(this.current - 1, 0), Home: 0, End: last,
    };
    if (e.key === "Enter" && this.dots[this.current]) this.chosen(this.dots[this.current]!.id);
    else if (e.key in to && last >= 0) this.goTo(to[e.key]!);
    else return;
    e.preventDefault();
  }

  private goTo(index: number): void {
    this.current = index;
    this.plot?.redraw(false);
    this.showTip();
    this.said.textContent = this.dots[index] ? this.describe(this.dots[index]!.id) : "";
  }

  private showTip(): void {
    const dot = this.dots[this.current], plot = this.plot;
    this.tip.hidden = !dot || !plot;
    if (!dot || !plot) return;
    this.tip.textContent = this.describe(dot.id);
    const left = plot.over.offsetLeft + plot.valToPos(dot.x, "x"), top = plot.over.offsetTop + plot.valToPos(dot.y, "y");
    this.tip.style.left = `${left > plot.width / 2 ? left - this.tip.offsetWidth - 14 : left + 14}px`;
    this.tip.style.top = `${Math.max(0, Math.min(top + 10, plot.height - this.tip.offsetHeight))}px`;
  }

  private draw(): void {
    const width = Math.min(this.holder.clientWidth, 1160);
    if (width === 0) return;
    this.plot?.destroy();
    this.plot = undefined;
    this.holder.replaceChildren();
    if (this.dots.length === 0) {
      this.holder.append(h("p", {}, "No point to draw."));
      return;
    }
    const { log } = this.axes, ink = themeColor("ink"), grid = { stroke: themeColor("line"), width: 1 };
    const axis = (label: string) => ({ label, labelSize: 20, stroke: ink, grid, size: 62,
      splits: (_p: uPlot, _i: number, low: number, high: number) => ticks(low, high, log),
      values: (_p: uPlot, v: (number | null)[]) => v.map((t) => (t === null ? "" : figure(t))), filter: (_p: uPlot, v: number[]) => v });
    const scale = (values: number[]) => ({ distr: (log ? 3 : 1) as 1 | 3, time: false, range: padded(values, log) });
    const bars = this.dots.flatMap((d) => [d.y - d.error, d.y + d.error]).filter((y) => !log || y > 0);
    this.plot = new uPlot({
      width, height: 430, legend: { show: false },
      cursor: { drag: { x: false, y: false }, points: { show: false }, x: false, y: false },
      scales: { x: scale(this.dots.map((d) => d.x)), y: scale([...bars, ...this.dots.map((d) => d.y)]) },
      axes: [{ ...axis(this.axes.x), size: 36 }, { ...axis(this.axes.y), size: 74 }],
      series: [{}, { paths: () => null, points: { show: false } }],
      hooks: { draw: [(p) => this.paint(p)] },
    }, [this.dots.map((d) => d.x), this.dots.map((d) => d.y)], this.holder);
    const over = this.plot.over;
    over.addEventListener("mousemove", (e) => this.hover(e.offsetX, e.offsetY));
    over.addEventListener("mouseleave", () => { this.tip.hidden = true; });
    over.addEventListener("click", () => { if (!this.tip.hidden && this.dots[this.current]) this.chosen(this.dots[this.current]!.id); });
  }

  private hover(x: number, y: number): void {
    let near = -1, least = 18;
    this.dots.forEach((d, i) => {
      const far = Math.hypot(this.plot!.valToPos(d.x, "x") - x, this.plot!.valToPos(d.y, "y") - y);
      if (far < least) [near, least] = [i, far];
    });
    if (near < 0) this.tip.hidden = true;
    else if (near !== this.current || this.tip.hidden) this.goTo(near);
  }

  private paint(p: uPlot): void {
    const c = p.ctx, r = 5 * devicePixelRatio, ink = themeColor("ink"), back = themeColor("back");
    const at = (d: { x: number; y: number }) => [p.valToPos(d.x, "x", true), p.valToPos(d.y, "y", true)] as const;
    c.save();
    c.beginPath();
    c.rect(p.bbox.left, p.bbox.top, p.bbox.width, p.bbox.height);
    c.clip();
    for (const series of new Set(this.dots.map((d) => d.series))) {
      const color = seriesColors[series % seriesColors.length]!;
      c.strokeStyle = color;
      c.lineWidth = 1.5 * devicePixelRatio;
      c.setLineDash(seriesDashes[series % seriesDashes.length]!.map((d) => d * devicePixelRatio));
      c.beginPath();
      let before: number | null = null;
      for (const d of frontier(this.dots.filter((d) => d.series === series))) {
        const [x, y] = at(d);
        if (before === null) c.moveTo(x, p.bbox.top);
        else c.lineTo(x, before);
        c.lineTo(x, y);
        before = y;
      }
      if (before !== null) c.lineTo(p.bbox.left + p.bbox.width, before);
      c.stroke();
    }
    c.setLineDash([]);
    for (const d of this.dots) {
      const [x, y] = at(d), shape = seriesShapes[d.series % seriesShapes.length]!;
      c.strokeStyle = c.fillStyle = seriesColors[d.series % seriesColors.length]!;
      c.lineWidth = devicePixelRatio;
      if (d.error > 0) {
        const high = p.valToPos(d.y + d.error, "y", true), low = this.axes.log && d.y <= d.error ? p.bbox.top + p.bbox.height : p.valToPos(d.y - d.error, "y", true);
        c.beginPath();
        c.moveTo(x, high);
        c.lineTo(x, low);
        c.stroke();
      }
      // Modelled points are hollow; a shape of lines alone is thinner.
      const lines = shape === "cross" || shape === "plus", color = c.fillStyle;
      tracePath(c, shape, x, y, r);
      c.lineWidth = (lines && d.modelled ? 1 : 2) * devicePixelRatio;
      c.fillStyle = d.modelled ? back : color;
      if (!lines) c.fill();
      c.strokeStyle = lines || d.modelled ? color : back;
      c.stroke();
    }
    // Marks over everything.
    c.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    c.textBaseline = "bottom";
    for (const [i, d] of this.dots.entries()) {
      const [x, y] = at(d);
      if (!d.mark && i !== this.current) continue;
      c.strokeStyle = c.fillStyle = ink;
      c.lineWidth = (i === this.current ? 3 : 1.5) * devicePixelRatio;
      c.beginPath();
      c.arc(x, y, 2 * r, 0, 2 * Math.PI);
      c.stroke();
      if (!d.mark) continue;
      const right = x > p.bbox.left + 0.75 * p.bbox.width;
      c.textAlign = right ? "right" : "left";
      c.fillText(d.mark, x + (right ? -1.6 : 1.6) * r, y - 1.4 * r);
    }
    c.restore();
  }
}

/** What a series looks like, for a legend. */
export function swatch(series: number): HTMLCanvasElement {
  const canvas = h("canvas", { width: 56, height: 28, style: "width: 28px; height: 14px", "aria-hidden": "true" });
  const c = canvas.getContext("2d")!, color = seriesColors[series % seriesColors.length]!, shape = seriesShapes[series % seriesShapes.length]!;
  c.strokeStyle = c.fillStyle = color;
  c.lineWidth = 3;
  c.setLineDash(seriesDashes[series % seriesDashes.length]!.map((d) => 1.5 * d));
  c.beginPath();
  c.moveTo(0, 14);
  c.lineTo(56, 14);
  c.stroke();
  c.setLineDash([]);
  tracePath(c, shape, 28, 14, 9);
  if (shape === "cross" || shape === "plus") c.stroke();
  else c.fill();
  return canvas;
}
