// SPDX-License-Identifier: Apache-2.0
// What the C++ side puts into a page (report/run.cpp, report/study.cpp).

export interface Layer { name: string; channels: string[]; exponents: number[]; difference: boolean; chained: boolean; payload: number }
export interface Picture { label: string; file: string; about: string; same_as: string; layers?: Layer[] }
export interface Pair {
  a: string; b: string; relmse: number; rmse: number; mape: number; mean_ratio: number; flip: number; flip_map: number;
}
export interface Images { width: number; height: number; mantissa: number; base: string; list: Picture[]; pairs: Pair[] }

export interface UnitSummary {
  backend: string; packets: number; differences: number; bypassed: number; busy_percent: number;
  counters: Record<string, number>; first_difference?: string; mean_displacement?: number;
}
export interface Summary {
  scene: string; command?: string; plan_hash: string; units: Record<string, UnitSummary>;
  packets: number; differences: number; images_identical: boolean;
  camera_samples?: number; caustic_queries?: number; table_gathers?: number; directions?: number; final_gathers?: number;
  counts?: Record<string, number>; golden_counts?: Record<string, number>;
  zeroed_photons?: number; saturated_photons?: number; outside_photons?: number;
  diagnosis?: { regions: { cause: string; pixels: number; found: number; message: string }[] };
}
export interface PlanLine { section: string; key: string; value: string; meaning: string; reason: string }
export interface Predicted { value: number; error: number }
export type Resource = "lut" | "ff" | "dsp" | "ebr";
export interface UnitResources extends Record<Resource, Predicted> { unit: string }
export interface Utilisation {
  unit: string; packets: number; first: number; last: number; bucket: number; latency: number; busy: number[]; inside: number[];
}
export interface Field {
  name: string; elements: number; bits: number; used: number; most: number | string; unit: string; meaning: string;
}
export interface Stream { unit: string; stream: string; count: number; kept: number; payload: number; fields: Field[] }
export interface Run {
  name: string; folder: string; hardware: string; summary: Summary; plan: { hash: string; lines: PlanLine[] };
  plan_text: number; resources: UnitResources[]; images: Images; utilisation: Utilisation[]; streams: Stream[] | null;
}

export interface Mean { mean: number | null; error: number | null; ratio: number | null; ratio_error: number | null }
export interface Point {
  point: number; scene: string; plan: string; origin: string; state: string; seeds?: number; reason?: string;
  lines: Record<string, string>; command?: string; front?: string[]; values: Record<string, Mean>;
}
export interface StudyScene {
  scene: string; file?: string; hash?: string; failure?: string; baseline: number | null; reference_relmse?: number | null;
  images: Images | null;
}
export interface Measure { measure: string; meaning: string; columns: { name: string; unit: string; meaning: string }[] }
export interface Study {
  study: string; folder: string; seeds?: number[]; scenes: StudyScene[]; measures: Measure[];
  fronts: { front: string; cost: string }[]; points: Point[]; plans: number; plans_kept: number;
}
export interface Plans { meanings: [section: string, key: string, meaning: string][]; plans: Record<string, [string, string][]> }

export interface Data { program: string; runs: Run[]; studies: Study[] }
