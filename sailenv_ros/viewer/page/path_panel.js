// @ts-check
// The track that the mover follows: its waypoints in order, placed where the camera is.

import { button, el, fixed, keyed, line, put, say, section } from "./dom.js";
import { moverOf } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {MoverNews, PoseValues} from "./messages.js" */
/** @import {State, Store} from "./store.js" */

export class PathPanel {
  title = "Path";
  #store;
  #actions;
  #list = el("ol", { class: "waypoints", id: "waypoints" });
  #time = el("input", {
    type: "number", min: 0.5, step: 1, id: "total-time",
    on: { change: () => this.#send({ total_time_s: Number(this.#time.value) }) },
  });
  #loop = el("input", {
    type: "checkbox", id: "loop", on: { change: () => this.#send({ loop: this.#loop.checked }) },
  });

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    const always = el("input", {
      type: "checkbox", id: "show-path", on: { change: () => store.set({ pathAlways: always.checked }) },
    });
    this.root = el("div", {}, section(
      "Waypoints",
      el("p", { class: "advice" }, "The camera runs through them at equal times. Walk somewhere and add what you see."),
      el("div", { class: "buttons" },
        button("Add here", () => this.#add(), { glyph: "plus", kind: "primary" }),
        button("Clear", () => this.#send({ waypoints: [] }), { glyph: "trash", kind: "danger" })),
      this.#list,
      line("one round [s]", this.#time),
      line("loop", this.#loop),
      line("show always", always),
    ));
    store.on(["scene", "agent"], (state) => this.#show(state));
  }

  /** @param {Readonly<State>} state */
  #show(state) {
    const mover = moverOf(state);
    if (!mover) return;
    put(this.#time, mover.total_time_s);
    this.#loop.checked = mover.loop;
    keyed(this.#list, mover.waypoints, (_, at) => String(at), (_, at) => this.#row(at));
  }

  /** @param {number} at */
  #row(at) {
    const name = el("span", { class: "name" });
    const share = el("span", { class: "share" });
    const remove = button("", () => this.#remove(at), { glyph: "trash", title: `Remove waypoint ${at + 1}`, kind: "icon quiet" });
    return {
      root: el("li", {}, name, share, remove),
      /** @param {PoseValues} pose */
      set: ({ position, rpy_deg }) => {
        say(name, position.map((x) => fixed(x)).join(", "));
        say(share, `${fixed(rpy_deg[2], 0)}°`);
      },
    };
  }

  #add() {
    const mover = moverOf(this.#store.state);
    if (mover) this.#actions.try("add_waypoint", { mover: mover.name });
  }

  /** @param {number} at */
  #remove(at) {
    const mover = moverOf(this.#store.state);
    if (mover) this.#send({ waypoints: mover.waypoints.filter((_, other) => other !== at) });
  }

  /** @param {Partial<MoverNews>} changes */
  #send(changes) {
    const mover = moverOf(this.#store.state);
    if (!mover) return;
    const { name, waypoints, total_time_s, loop } = { ...mover, ...changes };
    const poses = waypoints.map(({ position, rpy_deg }) => /** @type {const} */ ([position, rpy_deg]));
    this.#actions.try("set_waypoints", { mover: name, total_time_s, loop, waypoints: poses });
  }
}
