// @ts-check
// Values of views in words.

import { fixed } from "./dom.js";

/** @import {PixelValues, ViewInfo} from "./messages.js" */

/**
 * The values of a pixel in words, view by view.
 * @param {PixelValues} values
 * @param {readonly ViewInfo[]} specs
 * @returns {[string, string][]}
 */
export function told(values, specs) {
  const all = /** @type {Record<string, any>} */ (values); // by the views' names
  /** @type {[string, string][]} */
  const rows = specs
    .filter(({ name }) => name in all)
    .map((spec) => [spec.name, (WORDS[spec.display] ?? numberWords)(all[spec.name], spec, all)]);
  return [["pixel", `${values.u}, ${values.v}`], ...rows];
}

/** @type {Partial<Record<ViewInfo["display"], (value: any, spec: ViewInfo, values: Record<string, any>) => string>>} */
const WORDS = {
  category: (name, spec, values) => `${name || "unlabelled"} (${values[`${spec.name}_id`]})`,
  instance: (name, spec, values) =>
    values[`${spec.name}_id`] ? `${name} (${values[`${spec.name}_id`]})` : "none",
  depth: (value) => depthWords(value),
  flow: (value) => flowWords(value),
};

/** @param {number | string | readonly number[] | null} value @param {ViewInfo} spec */
function numberWords(value, { unit }) {
  if (value === null) return "none";
  const words = [value].flat().map((x) => (typeof x === "number" && !Number.isInteger(x) ? fixed(x, 3) : String(x)));
  return `${words.join(", ")} ${unit}`.trim();
}

/** @param {number | "near" | null} depth */
export function depthWords(depth) {
  if (depth === null) return "nothing hit";
  return depth === "near" ? "nearer than the near plane" : `${fixed(depth, 3)} m`;
}

/** @param {readonly [number, number] | null} flow */
export function flowWords(flow) {
  return flow === null ? "none" : `${fixed(flow[0], 1)}, ${fixed(flow[1], 1)} px/s`;
}
