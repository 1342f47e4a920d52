// SPDX-License-Identifier: Apache-2.0
// From layers to what is painted: one function a mode, each gives width × height RGBA bytes.
import { errorColor, invalidColor, signedColor, srgbByte, type Rgb } from "./color";

function put(out: Uint8ClampedArray, i: number, c: Rgb): void {
  out[4 * i] = c[0];
  out[4 * i + 1] = c[1];
  out[4 * i + 2] = c[2];
  out[4 * i + 3] = 255;
}

/** Channels of three as R, G, B; of one as grey. Normals (`signed`) from −1..1 to 0..1. */
export function toneMapped(channels: Float32Array[], exposure: number, signed: boolean): Uint8ClampedArray<ArrayBuffer> {
  const n = channels[0]!.length, scale = 2 ** exposure, out = new Uint8ClampedArray(4 * n);
  for (let c = 0; c < 3; ++c) {
    const from = channels[channels.length >= 3 ? c : 0]!;
    for (let i = 0; i < n; ++i) out[4 * i + c] = signed ? 127.5 * (from[i]! + 1) : srgbByte(from[i]! * scale);
  }
  for (let i = 0; i < n; ++i) {
    out[4 * i + 3] = 255;
    if (channels.some((c) => !Number.isFinite(c[i]!))) put(out, i, invalidColor);
  }
  return out;
}

/** Mean over the channels of f(difference, b). */
export function combined(a: Float32Array[], b: Float32Array[], f: (difference: number, b: number) => number): Float32Array {
  const out = new Float32Array(a[0]!.length);
  for (let c = 0; c < a.length; ++c) {
    const x = a[c]!, y = b[c]!;
    for (let i = 0; i < out.length; ++i) out[i]! += f(x[i]!, y[i]!) / a.length;
  }
  return out;
}

export function mapped(values: Float32Array, color: (v: number) => Rgb): Uint8ClampedArray<ArrayBuffer> {
  const out = new Uint8ClampedArray(4 * values.length);
  for (let i = 0; i < values.length; ++i)
    put(out, i, Number.isFinite(values[i]!) ? color(values[i]!) : invalidColor);
  return out;
}

/** Largest finite magnitude; the whole range of a map. */
export function most(values: Float32Array): number {
  let m = 0;
  for (const v of values) if (Number.isFinite(v)) m = Math.max(m, Math.abs(v));
  return m;
}

/** What an error map shows: of a pixel's channels their mean. */
export const errorKinds = {
  absolute: { text: "absolute |A − B|", unit: "radiance", of: (d: number, _b: number) => Math.abs(d) },
  relative: { text: "relative (A − B)² / (B² + 0.01)", unit: "", of: (d: number, b: number) => d * d / (b * b + 0.01) },
} as const;

export { errorColor, signedColor };
