// SPDX-License-Identifier: Apache-2.0
// A study's figures by name ("measure.column"), as values or as ratios to the scene's baseline.
import type { Point, Study } from "./data";

export interface Figure { name: string; unit: string; meaning: string }
export interface Reading { value: number; error: number }

export function figuresOf(study: Study): Figure[] {
  return study.measures.flatMap((m) => m.columns.map((c) => ({ name: `${m.measure}.${c.name}`, unit: c.unit, meaning: `${c.meaning} (${m.meaning})` })));
}

/** Figures that say how wrong an image is; the others are costs. */
export const isError = (name: string): boolean => name.startsWith("visible.") || name.startsWith("formats.");

/** Nothing where the point has no such figure. */
export function reading(point: Point, name: string, asRatio: boolean): Reading | null {
  const mean = point.values[name];
  const value = asRatio ? mean?.ratio : mean?.mean;
  if (value === null || value === undefined || !Number.isFinite(value)) return null;
  return { value, error: (asRatio ? mean?.ratio_error : mean?.error) ?? 0 };
}

/** The points that no other beats in both, cheapest first. */
export function frontier<T extends { x: number; y: number }>(points: T[]): T[] {
  let least = Infinity;
  return [...points].sort((a, b) => a.x - b.x || a.y - b.y).filter((p) => p.y < least && ((least = p.y), true));
}

export const linesText = (point: Point): string =>
  Object.entries(point.lines).map(([line, value]) => `${line} = ${value}`).join(", ") || "the default plan";
