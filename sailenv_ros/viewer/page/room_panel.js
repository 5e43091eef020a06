// The floor plan: a room is drawn by dragging where there is none, and resized by its walls.

import { el, fixed, latest, put, section, toast } from "./dom.js";

const GRAB_PX = 9;
const SNAP_M = 0.1;
const HEIGHT_M = 2.5;
const LEAST_M = 1;
const MOST_M = 100;
const EMPTY_M = 10; // across the plan where there is no room
// Faces of a box by its corners' numbers: together they cover what is seen of it from above.
const FACES = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];

export class RoomPanel {
  title = "Room";
  #plan = { size: null, openings: [], objects: [] };
  #drag = null; // { x, y: whether this axis is dragged, size: as it would be }
  #refresh = latest(async () => {
    this.#plan = await this.app.ask("floor_plan", {});
    this.#show();
  });

  constructor(app) {
    this.app = app;
    this.canvas = el("canvas", {
      id: "plan", role: "img", "aria-label": "Floor plan, north is up",
      on: {
        pointerdown: (event) => this.#begin(event),
        pointermove: (event) => this.#move(event),
        pointerup: () => this.#end(),
        pointercancel: () => this.#cancel(),
      },
    });
    this.advice = el("p", { class: "advice" });
    this.inputs = ["along x [m]", "along y [m]", "height [m]"].map((label, axis) =>
      el("input", {
        type: "number", min: LEAST_M, max: MOST_M, step: SNAP_M, id: `room-${["x", "y", "z"][axis]}`, "aria-label": label,
        on: { change: () => this.#typed() },
      }));
    this.root = el(
      "div",
      {},
      section(
        "Floor plan",
        this.canvas,
        this.advice,
        ...["along x [m]", "along y [m]", "height [m]"].map((label, axis) =>
          el("label", { class: "line" }, el("span", {}, label), this.inputs[axis])),
      ),
    );
    addEventListener("keydown", (event) => event.code === "Escape" && this.#cancel());
  }

  frame() {}

  update() {
    if (this.root.isConnected) this.#refresh(null);
  }

  opened() {
    this.#draw();
    this.#refresh(null);
  }

  #show() {
    const { size } = this.#plan;
    for (const [axis, input] of this.inputs.entries()) put(input, size ? fixed(size[axis], 2) : "");
    this.advice.textContent = size
      ? "Drag a wall or a corner. The room stays around the origin, so the opposite wall moves too; objects stay."
      : "There is no room. Drag in the plan to draw one around the origin.";
    this.#draw();
  }

  // ---- dragging

  /** How many pixels of the page a metre has; it stays while a wall is dragged. */
  get #scale() {
    const { size } = this.#plan;
    const across = size ? 1.35 * Math.max(size[0], size[1]) + 1 : EMPTY_M;
    return this.canvas.clientWidth / across;
  }

  /** Where an event is, in metres from the origin. */
  #place(event) {
    const box = this.canvas.getBoundingClientRect();
    const scale = this.#scale;
    return [
      (event.clientX - box.left - box.width / 2) / scale,
      (box.top + box.height / 2 - event.clientY) / scale,
    ];
  }

  /** Which walls an event is on: whether it would change the size along x, along y. */
  #grip(event) {
    const { size } = this.#plan;
    if (!size) return { x: true, y: true };
    const [x, y] = this.#place(event).map(Math.abs);
    const reach = GRAB_PX / this.#scale;
    const [halfX, halfY] = [size[0] / 2, size[1] / 2];
    return {
      x: Math.abs(x - halfX) < reach && y < halfY + reach,
      y: Math.abs(y - halfY) < reach && x < halfX + reach,
    };
  }

  #begin(event) {
    if (event.button !== 0 || !this.app.control) return;
    const grip = this.#grip(event);
    if (!grip.x && !grip.y) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.#drag = { ...grip, size: this.#plan.size };
  }

  #move(event) {
    if (!this.#drag) {
      const grip = this.#grip(event);
      const [x, y] = this.#place(event);
      const corner = x * y > 0 ? "nesw-resize" : "nwse-resize";
      const beside = grip.x ? "ew-resize" : grip.y ? "ns-resize" : "default";
      this.canvas.style.cursor = this.#plan.size ? (grip.x && grip.y ? corner : beside) : "crosshair";
      return;
    }
    const [x, y] = this.#place(event).map((value) => snapped(2 * Math.abs(value)));
    const [oldX, oldY, height] = this.#plan.size ?? [x, y, HEIGHT_M];
    this.#drag.size = [this.#drag.x ? x : oldX, this.#drag.y ? y : oldY, height];
    this.#draw();
  }

  #end() {
    const wanted = this.#drag?.size;
    this.#cancel();
    if (wanted) this.#send(wanted);
  }

  #cancel() {
    if (!this.#drag) return;
    this.#drag = null;
    this.#draw();
  }

  #typed() {
    const values = this.inputs.map((input) => Number(input.value));
    if (!this.#plan.size && !this.inputs[2].value) values[2] = HEIGHT_M;
    if (values.every((value) => value > 0)) this.#send(values);
  }

  async #send(size) {
    if (size.join() === this.#plan.size?.join()) return;
    const done = await this.app.try("set_room", { size });
    if (done?.replaced.length) toast(`The room takes the place of: ${done.replaced.join(", ")}`);
    this.#refresh(null);
  }

  // ---- drawing

  #draw() {
    const side = this.canvas.clientWidth;
    if (!side) return;
    const [scale, ratio] = [this.#scale, devicePixelRatio];
    const pixels = Math.round(side * ratio);
    if (this.canvas.width !== pixels) this.canvas.width = this.canvas.height = pixels;
    const styles = getComputedStyle(document.body);
    const colour = (name) => styles.getPropertyValue(name).trim();
    const pen = this.canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, side, side);
    pen.translate(side / 2, side / 2);
    const at = ([x, y]) => [x * scale, -y * scale];
    this.#grid(pen, side, scale, colour);
    this.#objects(pen, at, colour);
    const size = this.#drag?.size ?? this.#plan.size;
    if (size) this.#walls(pen, at, size, colour);
    this.canvas.dataset.scale = scale;
    this.canvas.dataset.size = this.#plan.size?.join(" ") ?? "";
  }

  #grid(pen, side, scale, colour) {
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

  #objects(pen, at, colour) {
    for (const { id, corners } of this.#plan.objects) {
      const path = new Path2D();
      for (const face of FACES) {
        const points = face.map((number) => at(corners[number]));
        // All the same way round, so that faces which overlap stay filled.
        if (area(points) < 0) points.reverse();
        points.forEach((point, nth) => (nth ? path.lineTo(...point) : path.moveTo(...point)));
        path.closePath();
      }
      const chosen = id === this.app.selected;
      pen.globalAlpha = chosen ? 0.7 : 0.28;
      pen.fillStyle = colour(chosen ? "--accent" : "--soft");
      pen.fill(path);
      pen.globalAlpha = 1;
    }
  }

  #walls(pen, at, size, colour) {
    const [halfX, halfY] = [size[0] / 2, size[1] / 2];
    const [left, top] = at([-halfX, halfY]);
    const [right, bottom] = at([halfX, -halfY]);
    pen.lineWidth = 4;
    pen.strokeStyle = colour(this.#drag ? "--accent" : "--ink");
    pen.strokeRect(left, top, right - left, bottom - top);
    for (const { type, wall, at: middle, width } of this.#plan.openings) {
      const along = wall === "north" || wall === "south";
      const side = wall === "north" || wall === "east" ? 1 : -1;
      const ends = [middle - width / 2, middle + width / 2];
      pen.strokeStyle = colour(type === "door" ? "--card" : "--accent");
      pen.beginPath();
      pen.moveTo(...at(along ? [ends[0], side * halfY] : [side * halfX, ends[0]]));
      pen.lineTo(...at(along ? [ends[1], side * halfY] : [side * halfX, ends[1]]));
      pen.stroke();
    }
    if (this.app.control) {
      pen.fillStyle = colour("--accent");
      for (const [x, y] of [[0, 1], [1, 0], [0, -1], [-1, 0], [1, 1], [1, -1], [-1, 1], [-1, -1]]) {
        const [u, v] = at([x * halfX, y * halfY]);
        pen.fillRect(u - 4, v - 4, 8, 8);
      }
    }
    pen.fillStyle = colour("--ink");
    pen.font = "600 12px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillText(`${fixed(size[0])} × ${fixed(size[1])} m`, 0, bottom + 18);
  }
}

function snapped(value) {
  const steps = Math.round(value / SNAP_M);
  return Number(Math.min(MOST_M, Math.max(LEAST_M, steps * SNAP_M)).toFixed(2));
}

function area(points) {
  return points.reduce((sum, [x, y], nth) => {
    const [nextX, nextY] = points[(nth + 1) % points.length];
    return sum + x * nextY - nextX * y;
  }, 0);
}
