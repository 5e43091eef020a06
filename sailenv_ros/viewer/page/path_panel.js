// The track that the mover follows: its waypoints in order, placed where the camera is.

import { button, el, fixed, put, section } from "./dom.js";

export class PathPanel {
  title = "Path";

  constructor(app) {
    this.app = app;
    this.list = el("ol", { class: "waypoints", id: "waypoints" });
    this.time = el("input", {
      type: "number", min: 0.5, step: 1, id: "total-time",
      on: { change: () => this.#send({ total_time_s: Number(this.time.value) }) },
    });
    this.loop = el("input", {
      type: "checkbox", id: "loop", on: { change: () => this.#send({ loop: this.loop.checked }) },
    });
    this.show = el("input", {
      type: "checkbox", id: "show-path", on: { change: () => this.app.showPath() },
    });
    this.root = el(
      "div",
      {},
      section(
        "Waypoints",
        el("p", { class: "advice" }, "The camera runs through them at equal times. Walk somewhere and add what you see."),
        el("div", { class: "buttons" },
          button("Add here", () => this.#add(), { glyph: "plus", kind: "primary" }),
          button("Clear", () => this.#send({ waypoints: [] }), { glyph: "trash", kind: "danger" })),
        this.list,
        el("label", { class: "line" }, el("span", {}, "one round [s]"), this.time),
        el("label", { class: "line" }, el("span", {}, "loop"), this.loop),
        el("label", { class: "line" }, el("span", {}, "show always"), this.show),
      ),
    );
  }

  frame() {}

  update() {
    const mover = this.app.mover;
    if (!mover) return;
    put(this.time, mover.total_time_s);
    this.loop.checked = mover.loop;
    this.list.replaceChildren(
      ...mover.waypoints.map(({ position, rpy_deg }, at) =>
        el("li", {},
          el("span", { class: "name" }, position.map((x) => fixed(x)).join(", ")),
          el("span", { class: "share" }, `${fixed(rpy_deg[2], 0)}°`),
          button("", () => this.#remove(at), { glyph: "trash", title: `Remove waypoint ${at + 1}`, kind: "icon quiet" })),
      ),
    );
  }

  async #add() {
    await this.app.try("add_waypoint", { mover: this.app.mover.name });
  }

  #remove(at) {
    this.#send({ waypoints: this.app.mover.waypoints.filter((_, other) => other !== at) });
  }

  #send(changes) {
    const { name, waypoints, total_time_s, loop } = this.app.mover;
    const wanted = { waypoints, total_time_s, loop, ...changes };
    const pairs = wanted.waypoints.map(({ position, rpy_deg }) => [position, rpy_deg]);
    this.app.try("set_waypoints", { mover: name, ...wanted, waypoints: pairs });
  }
}
