// @ts-check
// The floor plan as a picture: grid, objects, walls with their openings, grips.

import { fixed } from "./dom.js";

/** @import {FloorPlanValues, PlannedObject} from "./messages.js" */

/** @typedef {CanvasRenderingContext2D} Pen */
/** @typedef {readonly [number, number]} Point */
/** @typedef {(point: Point) => [number, number]} At From metres to pixels. */
/** @typedef {(name: string) => string} Colour A colour of the page's style. */
/** @typedef {{ scale: number, selected: number, dragged: boolean, grips: boolean }} Looks */

/** Faces of a box by its corners' numbers: together they cover what is seen of it from above. */
const FACES = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
/** Places of the grips, in halves of the room. @type {readonly Point[]} */
const GRIPS = [[0, 1], [1, 0], [0, -1], [-1, 0], [1, 1], [1, -1], [-1, 1], [-1, -1]];

/**
 * Draw a plan; false where it is not shown.
 * @param {HTMLCanvasElement} canvas
 * @param {FloorPlanValues} plan
 * @param {Looks} looks
 */
export function drawPlan(canvas, plan, looks) {
  const side = canvas.clientWidth;
  const pen = canvas.getContext("2d");
  if (!side || !pen) return false;
  const ratio = devicePixelRatio;
  const pixels = Math.round(side * ratio);
  if (canvas.width !== pixels) canvas.width = canvas.height = pixels;
  const styles = getComputedStyle(document.body);
  /** @type {Colour} */
  const colour = (name) => styles.getPropertyValue(name).trim();
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, side, side);
  pen.translate(side / 2, side / 2);
  /** @type {At} */
  const at = ([x, y]) => [x * looks.scale, -y * looks.scale];
  drawGrid(pen, side, looks.scale, colour);
  drawObjects(pen, plan.objects, looks.selected, at, colour);
  if (plan.size) drawWalls(pen, plan.openings, plan.size, looks, at, colour);
  return true;
}

/** @param {Pen} pen @param {number} side @param {number} scale @param {Colour} colour */
function drawGrid(pen, side, scale, colour) {
  const step = scale > 8 ? 1 : 10;
  pen.strokeStyle = colour("--line");
  pen.lineWidth = 1;
  pen.beginPath();
  for (let line = -Math.floor(side / 2 / scale / step) * step; line * scale < side / 2; line += step) {
    pen.moveTo(line * scale, -side / 2);
    pen.lineTo(line * scale, side / 2);
    pen.moveTo(-side / 2, line * scale);
    pen.lineTo(side / 2, line * scale);
  }
  pen.stroke();
  pen.strokeStyle = colour("--soft");
  pen.beginPath();
  pen.moveTo(-6, 0);
  pen.lineTo(6, 0);
  pen.moveTo(0, -6);
  pen.lineTo(0, 6);
  pen.stroke();
}

/** @param {Pen} pen @param {readonly PlannedObject[]} objects @param {number} selected @param {At} at @param {Colour} colour */
function drawObjects(pen, objects, selected, at, colour) {
  for (const { id, corners } of objects) {
    const path = new Path2D();
    for (const face of FACES) {
      const points = face.map((number) => at(corners[number] ?? [0, 0]));
      // All the same way round, so that faces which overlap stay filled.
      if (area(points) < 0) points.reverse();
      points.forEach((point, nth) => (nth ? path.lineTo(...point) : path.moveTo(...point)));
      path.closePath();
    }
    const chosen = id === selected;
    pen.globalAlpha = chosen ? 0.7 : 0.28;
    pen.fillStyle = colour(chosen ? "--accent" : "--soft");
    pen.fill(path);
    pen.globalAlpha = 1;
  }
}

/** @param {Pen} pen @param {FloorPlanValues["openings"]} openings @param {readonly [number, number, number]} size @param {Looks} looks @param {At} at @param {Colour} colour */
function drawWalls(pen, openings, size, { dragged, grips }, at, colour) {
  const [halfX, halfY] = [size[0] / 2, size[1] / 2];
  const [left, top] = at([-halfX, halfY]);
  const [right, bottom] = at([halfX, -halfY]);
  pen.lineWidth = 4;
  pen.strokeStyle = colour(dragged ? "--accent" : "--ink");
  pen.strokeRect(left, top, right - left, bottom - top);
  for (const { type, wall, at: middle, width } of openings) {
    const along = wall === "north" || wall === "south";
    const side = wall === "north" || wall === "east" ? 1 : -1;
    pen.strokeStyle = colour(type === "door" ? "--card" : "--accent");
    pen.beginPath();
    pen.moveTo(...at(along ? [middle - width / 2, side * halfY] : [side * halfX, middle - width / 2]));
    pen.lineTo(...at(along ? [middle + width / 2, side * halfY] : [side * halfX, middle + width / 2]));
    pen.stroke();
  }
  if (grips) {
    pen.fillStyle = colour("--accent");
    for (const [x, y] of GRIPS) {
      const [u, v] = at([x * halfX, y * halfY]);
      pen.fillRect(u - 4, v - 4, 8, 8);
    }
  }
  pen.fillStyle = colour("--ink");
  pen.font = "600 12px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.fillText(`${fixed(size[0])} × ${fixed(size[1])} m`, 0, bottom + 18);
}

/** Twice the area within points, below 0 where they go the other way round. @param {readonly Point[]} points */
function area(points) {
  return points.reduce((sum, [x, y], nth) => {
    const [nextX, nextY] = points[(nth + 1) % points.length] ?? [x, y];
    return sum + x * nextY - nextX * y;
  }, 0);
}
