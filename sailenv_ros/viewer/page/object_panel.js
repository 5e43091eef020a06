// The selected object: where it is, how large, what it is, what moves it; and all objects to choose.

import { button, el, fixed, latest, put, section, slider } from "./dom.js";
import { MaterialEditor } from "./material_editor.js";
import { pairs } from "./view_panel.js";

const AXES = ["x", "y", "z"];

export class ObjectPanel {
  title = "Object";

  constructor(app) {
    this.app = app;
    this.state = null;
    this.editor = el("div", { id: "editor" });
    this.materials = new MaterialEditor(app);
    this.search = el("input", {
      type: "search", placeholder: "Search objects", id: "object-search",
      on: { input: () => this.#list() },
    });
    this.list = el("div", { class: "list", id: "objects" });
    this.root = el("div", {}, this.editor, section("All objects", this.search, this.list));
    this.#edit(null);
    setInterval(() => this.#refresh(), 1000);
  }

  frame() {}

  update() {
    this.#list();
    if (this.state && !this.app.instances.has(this.state.id)) this.app.select(0);
    else if (this.state) this.materials.show(this.state.id);
  }

  /** Show another object; null for none. */
  async show(id) {
    try {
      this.#edit(id ? await this.app.ask("get_object", { obj: id }) : null);
    } catch {
      this.#edit(null);
    }
    this.#list();
  }

  async #refresh() {
    if (!this.state || !this.root.isConnected || document.hidden) return;
    const { id } = this.state;
    try {
      const state = await this.app.ask("get_object", { obj: id });
      if (this.state?.id === id) this.#fill(state);
      if (this.opening) await this.#askJoint(id);
    } catch {
      // It has gone; the scene's news say so.
    }
  }

  #list() {
    if (!this.app.scene) return;
    const words = this.search.value.trim().toLowerCase();
    const found = this.app.scene.instances.filter(
      ({ name, category }) => !words || `${name} ${category}`.toLowerCase().includes(words),
    );
    this.list.replaceChildren(
      ...found.map((instance) => {
        const chip = el("span", { class: "chip" });
        const colour = this.app.categories.get(instance.category_id)?.colour ?? [128, 128, 128];
        chip.style.background = `rgb(${colour.join(" ")})`;
        return el(
          "button",
          {
            class: instance.id === this.app.selected ? "row on" : "row",
            data: { id: instance.id },
            on: { click: () => this.app.select(instance.id) },
          },
          chip,
          el("span", { class: "name" }, instance.name),
          el("span", { class: "count" }, instance.is_part ? "part" : instance.moves ? "moves" : ""),
          el("span", { class: "share" }, instance.category),
        );
      }),
    );
  }

  #edit(state) {
    this.state = state;
    if (!state) {
      this.editor.replaceChildren(
        el("p", { class: "advice" }, "Click an object in a picture, or choose one below."),
      );
      return;
    }
    const row = (label, inputs) => el("div", { class: "triple" }, el("span", {}, label), ...inputs);
    const numbers = (key, step) =>
      AXES.map((axis, at) =>
        el("input", {
          type: "number", step, title: `${key} ${axis}`, id: `${key}-${axis}`,
          on: { change: (event) => this.#changed(key, at, event.target) },
        }),
      );
    this.position = numbers("position", 0.05);
    this.rpy = numbers("rpy_deg", 5);
    this.scale = numbers("scale", 0.1);
    this.name = el("input", {
      type: "text", id: "object-name",
      on: { change: () => this.#change({ name: this.name.value.trim() }) },
    });
    this.category = el(
      "select",
      { id: "object-category", on: { change: () => this.#change({ category: this.category.value }) } },
      ...this.app.scene.categories.map(({ name }) => el("option", { value: name }, name)),
    );
    this.facts = el("dl", { class: "values" });
    this.behaviours = el("div", { class: "list" });
    this.joint = el("div", { id: "joint" });
    this.opening = null;
    const nudge = (glyph, title, by) => button("", () => this.#nudge(by), { glyph, title, kind: "icon" });
    const turn = (words, by) => button(words, () => this.#turn(by), { title: `turn by ${by}°` });
    this.editor.replaceChildren(
      section(
        "Selected",
        el("label", { class: "line" }, el("span", {}, "name"), this.name),
        el("label", { class: "line" }, el("span", {}, "category"), this.category),
        row("position [m]", this.position),
        row("turn [°]", this.rpy),
        row("scale", this.scale),
        el(
          "div",
          { class: "buttons" },
          button("Place by a click", () => this.app.placeNext(), {
            glyph: "target", title: "The next click on a picture says where it stands", kind: "place",
          }),
          turn("⟲ 15°", 15),
          turn("⟳ 15°", -15),
          nudge("up", "raise by 5 cm", [0, 0, 0.05]),
          nudge("down", "lower by 5 cm", [0, 0, -0.05]),
          button("Delete", () => this.app.deleteSelected(), { glyph: "trash", kind: "danger", title: "Del" }),
        ),
        this.joint,
        this.facts,
      ),
      this.materials.root,
      section("Moves by", this.behaviours, this.#adder()),
    );
    this.materials.show(state.id);
    this.#fill(state);
    this.#askJoint(state.id);
  }

  /** Show the joint that the object moves on as a slider, if it is on one. */
  async #askJoint(id) {
    const joint = await this.app.ask("get_joint", { obj: id });
    if (this.state?.id !== id || !joint) return;
    if (!this.opening) {
      const words = joint.type === "hinge" ? "open [rad]" : "open [m]";
      const send = latest((position) => this.app.ask("set_joint_position", { obj: id, position }));
      this.opening = slider(words, joint.low, joint.high, (joint.high - joint.low) / 200, send);
      this.joint.replaceChildren(this.opening.root);
    }
    this.opening.set(joint.position);
  }

  #fill(state) {
    this.state = state;
    AXES.forEach((_, at) => {
      put(this.position[at], fixed(state.position[at], 3));
      put(this.rpy[at], fixed(state.rpy_deg[at], 1));
      put(this.scale[at], Number(state.scale[at].toFixed(3)));
    });
    put(this.name, state.name);
    put(this.category, state.category);
    this.facts.replaceChildren(
      ...pairs([
        ["asset", state.asset],
        ["size", `${state.size.map((x) => fixed(x)).join(" × ")} m`],
        ["mass", state.static ? "never moved by physics" : `${fixed(state.mass_kg)} kg`],
      ]),
    );
    this.behaviours.replaceChildren(
      ...state.behaviours.map((behaviour) => el("div", { class: "row flat", title: JSON.stringify(behaviour) },
        el("span", { class: "name" }, behaviour.type))),
      state.behaviours.length
        ? button("Stop all", () => this.#do("remove_behaviours", {}), { kind: "quiet" })
        : el("p", { class: "advice" }, state.static ? "Nothing: it is static." : "Nothing but physics."),
    );
  }

  #adder() {
    const kinds = this.app.hello.behaviours;
    const fields = el("div", { class: "fields" });
    const about = el("p", { class: "advice" });
    const choose = el(
      "select",
      { id: "behaviour", title: "Behaviour", on: { change: () => show() } },
      ...kinds.map(({ type }) => el("option", { value: type }, type)),
    );
    const show = () => {
      const kind = kinds.find(({ type }) => type === choose.value);
      about.textContent = kind.summary;
      fields.replaceChildren(
        ...kind.parameters.map((parameter) =>
          el("label", { class: "line", title: parameter.about },
            el("span", {}, parameter.name),
            el("input", {
              type: "text", data: { name: parameter.name },
              placeholder: parameter.needed ? "needed" : parameter.default === null ? "" : JSON.stringify(parameter.default),
            })),
        ),
      );
    };
    show();
    const attach = () => {
      const behaviour = { type: choose.value };
      for (const input of fields.querySelectorAll("input")) {
        if (input.value.trim()) behaviour[input.dataset.name] = valueOf(input.value.trim());
      }
      this.#do("add_behaviour", { behaviour });
    };
    return el("details", {}, el("summary", {}, "Add a behaviour"), choose, about, fields,
      button("Attach", attach, { glyph: "plus", kind: "primary" }));
  }

  #changed(key, at, input) {
    const value = Number(input.value);
    if (!Number.isFinite(value) || input.value === "") return;
    if (key === "scale") {
      const scale = [...this.state.scale];
      scale[at] = value;
      this.#change({ scale });
      return;
    }
    const pose = { position: [...this.state.position], rpy_deg: [...this.state.rpy_deg] };
    pose[key][at] = value;
    this.#move(pose.position, pose.rpy_deg);
  }

  #nudge(by) {
    const position = this.state.position.map((x, at) => x + by[at]);
    this.#move(position, this.state.rpy_deg);
  }

  #turn(by) {
    const [roll, pitch, yaw] = this.state.rpy_deg;
    this.#move(this.state.position, [roll, pitch, yaw + by]);
  }

  #move(position, rotation) {
    this.#do("move_object", { position, rotation, teleport: true });
  }

  #change(changes) {
    this.#do("change_object", { changes });
  }

  async #do(what, values) {
    const state = await this.app.try(what, { obj: this.state.id, ...values });
    document.activeElement?.blur();
    if (state) this.#fill(state);
    else this.#refresh();
  }
}

/** What was typed as JSON, or as a text where it is none. */
function valueOf(typed) {
  try {
    return JSON.parse(typed);
  } catch {
    return typed;
  }
}
