// @ts-check
// The lens of a picture: the page's only place that knows how points come into it.

/**
 * Return column and row [px] of a point of the optical frame; `lens` as a frame's head has it.
 * @param {readonly [number, number, number, number]} lens
 * @param {number} across
 * @param {number} down
 * @param {number} depth
 * @returns {[number, number]}
 */
export function placeOf([fx, fy, cx, cy], across, down, depth) {
  return [(fx * across) / depth + cx, (fy * down) / depth + cy];
}
