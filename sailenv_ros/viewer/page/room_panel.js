// @ts-check
// The floor plan: a room is drawn by dragging where there is none, and resized by its walls.

import { el, fixed, latest, line, put, section, toast } from "./dom.js";
import { drawPlan } from "./plan_drawing.js";
import { mayChange } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {FloorPlanValues} from "./messages.js" */
/** @import {Store} from "./store.js" */

/** @typedef {{ x: boolean, y: boolean }} Grip Whether a drag changes the size along x, along y. */
/** @typedef {[number, number, number]} Size */

const GRAB_PX = 9;
const SNAP_M = 0.1;
const HEIGHT_M = 2.5;
const LEAST_M = 1;
const MOST_M = 100;
const EMPTY_M = 10; // across the plan where there is no room

export class RoomPanel {
  title = "Room";
  #store;
  #actions;
  /** @type {FloorPlanValues} */
  #plan = { size: null, openings: [], objects: [] };
  /** @type {(Grip & { size: Size | null }) | null} */
  #drag = null; // with the size as it would be
  #refresh = latest(async () => {
    this.#plan = await this.#actions.ask("floor_plan", {});
    this.#show();
  });
  #canvas = el("canvas", {
    id: "plan", role: "img", "aria-label": "Floor plan, north is up",
    on: {
      pointerdown: (/** @type {PointerEvent} */ event) => this.#begin(event),
      pointermove: (/** @type {PointerEvent} */ event) => this.#move(event),
      pointerup: () => this.#end(),
      pointercancel: () => this.#cancel(),
    },
  });
  #advice = el("p", { class: "advice" });
  #x = this.#input("x", "along x [m]");
  #y = this.#input("y", "along y [m]");
  #z = this.#input("z", "height [m]");

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    this.root = el("div", {}, section(
      "Floor plan",
      this.#canvas,
      this.#advice,
      line("along x [m]", this.#x),
      line("along y [m]", this.#y),
      line("height [m]", this.#z),
    ));
    new ResizeObserver(() => this.#draw()).observe(this.#canvas);
    addEventListener("keydown", (event) => event.code === "Escape" && this.#cancel());
    store.on(["scene", "tab"], ({ tab }) => {
      if (tab === this.title) this.#refresh(null);
    });
    store.on(["selected", "hello"], ({ tab }) => tab === this.title && this.#draw());
  }

  /** @param {string} axis @param {string} label */
  #input(axis, label) {
    return el("input", {
      type: "number", min: LEAST_M, max: MOST_M, step: SNAP_M, id: `room-${axis}`, "aria-label": label,
      on: { change: () => this.#typed() },
    });
  }

  #show() {
    const { size } = this.#plan;
    put(this.#x, size ? fixed(size[0]) : "");
    put(this.#y, size ? fixed(size[1]) : "");
    put(this.#z, size ? fixed(size[2]) : "");
    this.#advice.textContent = size
      ? "Drag a wall or a corner. The room stays around the origin, so the opposite wall moves too; objects stay."
      : "There is no room. Drag in the plan to draw one around the origin.";
    this.#draw();
  }

  // ---- dragging

  /** How many pixels of the page a metre has; it stays while a wall is dragged. */
  get #scale() {
    const { size } = this.#plan;
    const across = size ? 1.35 * Math.max(size[0], size[1]) + 1 : EMPTY_M;
    return this.#canvas.clientWidth / across;
  }

  /** Where an event is, in metres from the origin. @param {MouseEvent} event @returns {[number, number]} */
  #place(event) {
    const box = this.#canvas.getBoundingClientRect();
    const scale = this.#scale;
    return [
      (event.clientX - box.left - box.width / 2) / scale,
      (box.top + box.height / 2 - event.clientY) / scale,
    ];
  }

  /** Which walls an event is on. @param {MouseEvent} event @returns {Grip} */
  #grip(event) {
    const { size } = this.#plan;
    if (!size) return { x: true, y: true };
    const [x, y] = absolute(this.#place(event));
    const reach = GRAB_PX / this.#scale;
    const [halfX, halfY] = [size[0] / 2, size[1] / 2];
    return {
      x: Math.abs(x - halfX) < reach && y < halfY + reach,
      y: Math.abs(y - halfY) < reach && x < halfX + reach,
    };
  }

  /** @param {PointerEvent} event */
  #begin(event) {
    if (event.button !== 0 || !mayChange(this.#store.state)) return;
    const grip = this.#grip(event);
    if (!grip.x && !grip.y) return;
    this.#canvas.setPointerCapture(event.pointerId);
    this.#drag = { ...grip, size: this.#plan.size };
  }

  /** @param {PointerEvent} event */
  #move(event) {
    if (!this.#drag) {
      const grip = this.#grip(event);
      const [x, y] = this.#place(event);
      const corner = x * y > 0 ? "nesw-resize" : "nwse-resize";
      const beside = grip.x ? "ew-resize" : grip.y ? "ns-resize" : "default";
      this.#canvas.style.cursor = this.#plan.size ? (grip.x && grip.y ? corner : beside) : "crosshair";
      return;
    }
    const [halfX, halfY] = absolute(this.#place(event));
    const [x, y] = [snapped(2 * halfX), snapped(2 * halfY)];
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
    /** @type {Size} */
    const size = [Number(this.#x.value), Number(this.#y.value), Number(this.#z.value)];
    if (!this.#plan.size && !this.#z.value) size[2] = HEIGHT_M;
    if (size.every((value) => value > 0)) this.#send(size);
  }

  /** @param {Size} size */
  async #send(size) {
    if (size.join() === this.#plan.size?.join()) return;
    const done = await this.#actions.try("set_room", { size });
    if (done?.replaced.length) toast(`The room takes the place of: ${done.replaced.join(", ")}`);
    this.#refresh(null);
  }

  #draw() {
    const { selected } = this.#store.state;
    const size = this.#drag?.size ?? this.#plan.size;
    const drawn = drawPlan(this.#canvas, { ...this.#plan, size }, {
      scale: this.#scale, selected, dragged: this.#drag !== null, grips: mayChange(this.#store.state),
    });
    if (!drawn) return;
    this.#canvas.dataset.scale = String(this.#scale);
    this.#canvas.dataset.size = this.#plan.size?.join(" ") ?? "";
  }
}

/** @param {[number, number]} place @returns {[number, number]} */
const absolute = ([x, y]) => [Math.abs(x), Math.abs(y)];

/** @param {number} value */
function snapped(value) {
  const steps = Math.round(value / SNAP_M);
  return Number(Math.min(MOST_M, Math.max(LEAST_M, steps * SNAP_M)).toFixed(2));
}
