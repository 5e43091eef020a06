// @ts-check
// What is drawn over a picture, in pixels of its frame.

/** @import {Overlay} from "./messages.js" */

/** @typedef {CanvasRenderingContext2D} Pen */

/**
 * The selected object's outline.
 * @param {Pen} pen
 * @param {readonly (readonly number[])[]} outline Closed lines u, v, u, v, … [px].
 * @param {number} line Width of a line of the page [px of the frame].
 */
export function drawOutline(pen, outline, line) {
  if (!outline.length) return;
  const path = closedLines(outline);
  pen.lineJoin = "round";
  pen.strokeStyle = "rgb(0 0 0 / 0.6)";
  pen.lineWidth = 5 * line;
  pen.stroke(path);
  pen.strokeStyle = "#ffd23f";
  pen.lineWidth = 2.5 * line;
  pen.stroke(path);
}

/**
 * Boxes around objects, boxes in space, and the outline of what is hidden too.
 * @param {Pen} pen
 * @param {Overlay} overlay
 * @param {number} line
 */
export function drawObjects(pen, overlay, line) {
  pen.lineJoin = "round";
  pen.lineWidth = 1.5 * line;
  for (const [id, left, top, right, bottom] of overlay.boxes) {
    pen.strokeStyle = colourOf(id);
    pen.strokeRect(left - 0.5, top - 0.5, right - left + 1, bottom - top + 1);
  }
  for (const [id, edges] of overlay.edges) {
    pen.strokeStyle = colourOf(id);
    pen.stroke(pieces(edges));
  }
  if (!overlay.whole.length) return;
  pen.setLineDash([5 * line, 4 * line]);
  pen.lineWidth = 2.5 * line;
  pen.strokeStyle = "white";
  pen.stroke(closedLines(overlay.whole));
  pen.setLineDash([]);
}

/**
 * Keypoints of people with the lines between them; hollow where something hides them.
 * @param {Pen} pen
 * @param {Overlay} overlay
 * @param {number} line
 */
export function drawPeople(pen, { people }, line) {
  pen.lineWidth = 2 * line;
  for (const [id, limbs, points] of people) {
    pen.strokeStyle = pen.fillStyle = colourOf(id);
    pen.stroke(pieces(limbs));
    for (const [u, v, seen] of points) {
      pen.beginPath();
      pen.arc(u, v, 3.5 * line, 0, 2 * Math.PI);
      if (seen) pen.fill();
      pen.stroke();
    }
  }
}

/**
 * A mover's track.
 * @param {Pen} pen
 * @param {Overlay} overlay
 * @param {number} line
 */
export function drawWaypoints(pen, { waypoints, track }, line) {
  pen.strokeStyle = "rgb(62 198 189 / 0.9)";
  pen.lineWidth = 2 * line;
  pen.setLineDash([6 * line, 5 * line]);
  pen.stroke(pieces(track));
  pen.setLineDash([]);
  pen.font = `600 ${11 * line}px system-ui, sans-serif`;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  for (const [number, u, v] of waypoints) {
    pen.beginPath();
    pen.arc(u, v, 9 * line, 0, 2 * Math.PI);
    pen.fillStyle = "#0e7c74";
    pen.fill();
    pen.strokeStyle = "white";
    pen.lineWidth = 1.5 * line;
    pen.stroke();
    pen.fillStyle = "white";
    pen.fillText(String(number), u, v);
  }
}

/**
 * The border of what the lens sees.
 * @param {Pen} pen
 * @param {Overlay} overlay
 * @param {number} line
 */
export function drawCircle(pen, { circle }, line) {
  if (!circle.length) return;
  pen.strokeStyle = "#3ec6bd";
  pen.lineWidth = 2 * line;
  pen.stroke(closedLines(circle));
}

/** @param {Overlay["track"]} segments */
function pieces(segments) {
  const path = new Path2D();
  let [u, v] = [NaN, NaN];
  for (const [u0, v0, u1, v1] of segments) {
    // One line where they meet, or dashes would begin anew.
    if (u0 !== u || v0 !== v) path.moveTo(u0, v0);
    path.lineTo(u1, v1);
    [u, v] = [u1, v1];
  }
  return path;
}

/** @param {readonly (readonly number[])[]} lines */
function closedLines(lines) {
  const path = new Path2D();
  for (const points of lines) {
    for (let at = 0; at < points.length; at += 2) {
      const [u = 0, v = 0] = points.slice(at, at + 2);
      if (at) path.lineTo(u, v);
      else path.moveTo(u, v);
    }
    path.closePath();
  }
  return path;
}

/** A colour of its own for each object: steps of the golden angle keep hues apart. @param {number} id */
function colourOf(id) {
  return `hsl(${(id * 137.508) % 360} 85% 62%)`;
}
