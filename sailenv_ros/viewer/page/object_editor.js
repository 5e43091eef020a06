// @ts-check
// The selected object: where it is, how large, what it is, what moves it.

import { BehaviourEditor } from "./behaviour_editor.js";
import { blur, button, el, fixed, latest, line, options, pairs, put, section, slider } from "./dom.js";
import { MaterialEditor } from "./material_editor.js";

/** @import {Actions} from "./actions.js" */
/** @import {JointValues, ObjectChanges, ObjectValues} from "./messages.js" */
/** @import {Slider} from "./dom.js" */
/** @import {State, Store} from "./store.js" */

/** @typedef {readonly [number, number, number]} Vector3 */

const AXES = /** @type {const} */ (["x", "y", "z"]);

export class ObjectEditor {
  root = el("div", { id: "editor" });
  #actions;
  /** @type {ObjectValues | null} */
  #object = null;
  #none = el("p", { class: "advice" }, "Click an object in a picture, or choose one below.");
  #position = this.#numbers("position", 0.05, (at, value) => this.#moved("position", at, value));
  #rpy = this.#numbers("rpy_deg", 5, (at, value) => this.#moved("rpy_deg", at, value));
  #scale = this.#numbers("scale", 0.1, (at, value) => this.#scaled(at, value));
  #name = el("input", {
    type: "text", id: "object-name",
    on: { change: () => this.#change({ name: this.#name.value.trim() }) },
  });
  #category = el("select", {
    id: "object-category", on: { change: () => this.#change({ category: this.#category.value }) },
  });
  #joint = el("div", { id: "joint" });
  #facts = el("dl", { class: "values" });
  #behaviours;
  /** @type {{ id: number, slider: Slider } | null} */
  #opening = null;
  #parts;

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#actions = actions;
    this.#behaviours = new BehaviourEditor(store, {
      attach: (behaviour) => this.#do((obj) => actions.try("add_behaviour", { obj, behaviour })),
      stop: () => this.#do((obj) => actions.try("remove_behaviours", { obj })),
    });
    this.#parts = [this.#selected(), new MaterialEditor(store, actions).root, this.#behaviours.root];
    this.root.append(this.#none);
    store.on(["scene"], ({ scene }) => {
      options(this.#category, (scene?.categories ?? []).map(({ name }) => ({ value: name, words: name })));
      if (this.#object) put(this.#category, this.#object.category);
    });
    store.on(["object", "selected"], (state) => this.#show(state));
  }

  #selected() {
    /** @type {(label: string, inputs: HTMLElement[]) => HTMLElement} */
    const row = (label, inputs) => el("div", { class: "triple" }, el("span", {}, label), ...inputs);
    /** @type {(glyph: string, title: string, by: number) => HTMLElement} */
    const nudge = (glyph, title, by) => button("", () => this.#nudge(by), { glyph, title, kind: "icon" });
    /** @type {(words: string, by: number) => HTMLElement} */
    const turn = (words, by) => button(words, () => this.#turn(by), { title: `turn by ${by}°` });
    return section(
      "Selected",
      line("name", this.#name),
      line("category", this.#category),
      row("position [m]", this.#position),
      row("turn [°]", this.#rpy),
      row("scale", this.#scale),
      el(
        "div",
        { class: "buttons" },
        button("Place by a click", () => this.#actions.placeNext(), {
          glyph: "target", title: "The next click on a picture says where it stands", kind: "place",
        }),
        turn("⟲ 15°", 15),
        turn("⟳ 15°", -15),
        nudge("up", "raise by 5 cm", 0.05),
        nudge("down", "lower by 5 cm", -0.05),
        button("Delete", () => this.#actions.deleteSelected(), { glyph: "trash", kind: "danger", title: "Del" }),
      ),
      this.#joint,
      this.#facts,
    );
  }

  /** @param {string} key @param {number} step @param {(at: number, value: number) => void} changed */
  #numbers(key, step, changed) {
    return AXES.map((axis, at) => {
      const input = el("input", {
        type: "number", step, title: `${key} ${axis}`, id: `${key}-${axis}`,
        on: {
          change: () => {
            const value = Number(input.value);
            if (Number.isFinite(value) && input.value !== "") changed(at, value);
          },
        },
      });
      return input;
    });
  }

  /** @param {Readonly<State>} state */
  #show({ selected, object }) {
    const told = object?.object ?? null;
    if (!told || object?.id !== selected) {
      // Of another one nothing is known yet: what was told of the last stays until then.
      if (!selected || object) {
        this.#object = null;
        this.root.replaceChildren(this.#none);
      }
      return;
    }
    if (!this.#object) this.root.replaceChildren(...this.#parts);
    this.#fill(told);
    this.#showJoint(told.id, object.joint);
  }

  /** @param {ObjectValues} object */
  #fill(object) {
    if (this.#object?.id !== object.id) this.#behaviours.reset();
    this.#object = object;
    for (const [at] of AXES.entries()) {
      put(/** @type {HTMLInputElement} */ (this.#position[at]), fixed(object.position[at] ?? 0, 3));
      put(/** @type {HTMLInputElement} */ (this.#rpy[at]), fixed(object.rpy_deg[at] ?? 0, 1));
      put(/** @type {HTMLInputElement} */ (this.#scale[at]), Number((object.scale[at] ?? 0).toFixed(3)));
    }
    put(this.#name, object.name);
    put(this.#category, object.category);
    this.#facts.replaceChildren(
      ...pairs([
        ["asset", object.asset],
        ["size", `${object.size.map((x) => fixed(x)).join(" × ")} m`],
        ["mass", object.static ? "never moved by physics" : `${fixed(object.mass_kg)} kg`],
      ]),
    );
    this.#behaviours.show(object);
  }

  /** Show the joint that the object moves on as a slider, if it is on one. @param {number} id @param {JointValues | null} joint */
  #showJoint(id, joint) {
    if (!joint) {
      this.#opening = null;
      this.#joint.replaceChildren();
      return;
    }
    if (this.#opening?.id !== id) {
      const words = joint.type === "hinge" ? "open [rad]" : "open [m]";
      /** @type {(position: number) => void} */
      const send = latest((position) => this.#actions.ask("set_joint_position", { obj: id, position }));
      this.#opening = { id, slider: slider(words, joint.low, joint.high, (joint.high - joint.low) / 200, send) };
      this.#joint.replaceChildren(this.#opening.slider.root);
    }
    this.#opening.slider.set(joint.position);
  }

  // ---- changes

  /** @param {"position" | "rpy_deg"} key @param {number} at @param {number} value */
  #moved(key, at, value) {
    if (!this.#object) return;
    const pose = { position: this.#object.position, rpy_deg: this.#object.rpy_deg };
    pose[key] = replaced(pose[key], at, value);
    this.#move(pose.position, pose.rpy_deg);
  }

  /** @param {number} at @param {number} value */
  #scaled(at, value) {
    if (this.#object) this.#change({ scale: replaced(this.#object.scale, at, value) });
  }

  /** @param {number} by */
  #nudge(by) {
    if (!this.#object) return;
    const [x, y, z] = this.#object.position;
    this.#move([x, y, z + by], this.#object.rpy_deg);
  }

  /** @param {number} by */
  #turn(by) {
    if (!this.#object) return;
    const [roll, pitch, yaw] = this.#object.rpy_deg;
    this.#move(this.#object.position, [roll, pitch, yaw + by]);
  }

  /** @param {Vector3} position @param {Vector3} rotation */
  #move(position, rotation) {
    this.#do((obj) => this.#actions.try("move_object", { obj, position, rotation, teleport: true }));
  }

  /** @param {ObjectChanges} changes */
  #change(changes) {
    this.#do((obj) => this.#actions.try("change_object", { obj, changes }));
  }

  /** Change the object and show it as it is then; as it was where that is refused. @param {(obj: number) => Promise<ObjectValues | undefined>} act */
  async #do(act) {
    const before = this.#object;
    if (!before) return;
    const told = await act(before.id);
    blur();
    if (this.#object?.id === before.id) this.#fill(told ?? this.#object);
  }
}

/** @param {Vector3} values @param {number} at @param {number} value @returns {[number, number, number]} */
function replaced([x, y, z], at, value) {
  return [at === 0 ? value : x, at === 1 ? value : y, at === 2 ? value : z];
}
