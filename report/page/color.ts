// SPDX-License-Identifier: Apache-2.0
// Colours that hold without colour vision: lightness alone orders the error scale; the two signs of a difference are blue
// and orange, and lightness says how large.

export type Rgb = readonly [number, number, number];

function between(stops: readonly Rgb[], t: number): Rgb {
  const at = Math.min(Math.max(t, 0), 1) * (stops.length - 1), i = Math.min(Math.floor(at), stops.length - 2), f = at - i;
  const a = stops[i]!, b = stops[i + 1]!;
  return [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2])];
}

const errorStops: Rgb[] = [[8, 12, 40], [24, 52, 110], [92, 96, 116], [156, 146, 108], [216, 196, 82], [255, 246, 160]];
const lessStops: Rgb[] = [[16, 16, 16], [20, 72, 150], [120, 190, 255]];
const moreStops: Rgb[] = [[16, 16, 16], [150, 80, 0], [255, 190, 90]];

/** t from 0 to 1: dark blue to light yellow, lighter all the way. */
export const errorColor = (t: number): Rgb => between(errorStops, t);
/** t from −1 to 1: light blue, black, light orange. */
export const signedColor = (t: number): Rgb => (t < 0 ? between(lessStops, -t) : between(moreStops, t));
/** Shown where a value is not finite. */
export const invalidColor: Rgb = [255, 0, 255];

const steps = 4096;
const srgb = (() => {
  const table = new Uint8ClampedArray(steps + 1);
  for (let i = 0; i <= steps; ++i) {
    const x = (i / steps) ** 2;  // finer near black
    table[i] = 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055) + 0.5;
  }
  return table;
})();

/** The sRGB byte of a linear value, 1 is white. */
export function srgbByte(x: number): number {
  return x <= 0 ? 0 : x >= 1 ? 255 : srgb[Math.round(Math.sqrt(x) * steps)]!;
}

/** Series by number: colour, and what tells it apart without. */
export const seriesColors = ["#3b82c4", "#d97706", "#0f9b77", "#b0539b", "#8a7a00", "#7f8791"];
export const seriesDashes = [[], [8, 4], [2, 3], [10, 3, 2, 3], [14, 4], [4, 2]];
export const seriesShapes = ["circle", "square", "triangle", "diamond", "cross", "plus"] as const;
export type Shape = (typeof seriesShapes)[number];

export function tracePath(c: CanvasRenderingContext2D, shape: Shape, x: number, y: number, r: number): void {
  c.beginPath();
  switch (shape) {
    case "circle": c.arc(x, y, r, 0, 2 * Math.PI); break;
    case "square": c.rect(x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r); break;
    case "triangle": c.moveTo(x, y - 1.2 * r); c.lineTo(x + 1.1 * r, y + 0.8 * r); c.lineTo(x - 1.1 * r, y + 0.8 * r); c.closePath(); break;
    case "diamond": c.moveTo(x, y - 1.3 * r); c.lineTo(x + 1.3 * r, y); c.lineTo(x, y + 1.3 * r); c.lineTo(x - 1.3 * r, y); c.closePath(); break;
    case "cross": c.moveTo(x - r, y - r); c.lineTo(x + r, y + r); c.moveTo(x + r, y - r); c.lineTo(x - r, y + r); break;
    case "plus": c.moveTo(x - 1.2 * r, y); c.lineTo(x + 1.2 * r, y); c.moveTo(x, y - 1.2 * r); c.lineTo(x, y + 1.2 * r); break;
  }
}
