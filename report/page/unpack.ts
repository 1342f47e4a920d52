// SPDX-License-Identifier: Apache-2.0
// From the page's text blocks to bytes, JSON and layers; the coding is that of report/layers.hpp.
import { unzlibSync } from "fflate";
import type { Layer } from "./data";

function bytesOf(id: string): Uint8Array {
  const block = document.getElementById(id);
  if (!block?.textContent) throw new Error(`This page was cut short: block ${id} is missing.`);
  const text = atob(block.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return unzlibSync(bytes);
}

export function textOf(payload: number | "data"): string {
  return new TextDecoder().decode(bytesOf(payload === "data" ? "data" : `p${payload}`));
}

export function jsonOf<T>(payload: number | "data"): T {
  return JSON.parse(textOf(payload)) as T;
}

const halves = (() => {
  const table = new Float32Array(65536);
  for (let h = 0; h < 65536; ++h) {
    const exponent = (h >> 10) & 31, mantissa = h & 1023;
    const size = exponent === 31 ? (mantissa ? NaN : Infinity)
      : exponent === 0 ? mantissa * 2 ** -24 : (1 + mantissa / 1024) * 2 ** (exponent - 15);
    table[h] = h & 0x8000 ? -size : size;
  }
  return table;
})();

const layers = new Map<number, Float32Array[]>();

/** The channels of a layer, row by row from the top left; kept once unpacked. */
export function layerPixels(layer: Layer, width: number, height: number): Float32Array[] {
  const known = layers.get(layer.payload);
  if (known) return known;
  const bytes = bytesOf(`p${layer.payload}`), n = width * height;
  const before = new Uint16Array(n);  // the previous channel's halves
  const channels = layer.exponents.map((exponent, c) => {
    const low = bytes.subarray(2 * c * n, (2 * c + 1) * n), high = bytes.subarray((2 * c + 1) * n, (2 * c + 2) * n);
    const out = new Float32Array(n), scale = 2 ** exponent;
    let bits = 0, above = 0;
    for (let i = 0; i < n; ++i) {
      if (i % width === 0) bits = above;
      bits = (bits + low[i]! + (high[i]! << 8)) & 0xffff;
      if (i % width === 0) above = bits;
      const half = layer.chained && c > 0 ? (bits + before[i]!) & 0xffff : bits;
      before[i] = half;
      out[i] = halves[half]! * scale;
    }
    return out;
  });
  layers.set(layer.payload, channels);
  return channels;
}

/** A map of values in [0, 1]. */
export function mapPixels(payload: number, width: number, height: number): Float32Array {
  const bytes = bytesOf(`p${payload}`), out = new Float32Array(width * height);
  let value = 0, above = 0;
  for (let i = 0; i < out.length; ++i) {
    if (i % width === 0) value = above;
    value = (value + bytes[i]!) & 255;
    if (i % width === 0) above = value;
    out[i] = value / 255;
  }
  return out;
}
