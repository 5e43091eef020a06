// @ts-check
// Lights and sky: sliders whose newest value is sent; lights come where the camera is, and go.

import { button, el, hexOfLinear, keyed, latest, line, linearOfHex, options, put, say, section, slider } from "./dom.js";

/** @import {Actions} from "./actions.js" */
/** @import {EnvironmentChanges, LightNews} from "./messages.js" */
/** @import {State, Store} from "./store.js" */

/** What a light of a type begins with: bright enough to be seen in a furnished room. @type {Record<LightNews["type"], number>} */
const INTENSITIES = { point: 1, spot: 2, area: 2, directional: 1 };
const TYPES = /** @type {LightNews["type"][]} */ (Object.keys(INTENSITIES));

export class LightPanel {
  title = "Light";
  #actions;
  #sky;
  #exposure;
  #share;
  #ambient;
  #lights = el("div", { id: "lights" });
  /** @type {readonly number[]} */
  #colour = [1, 1, 1];

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#actions = actions;
    /** @type {(changes: EnvironmentChanges) => void} */
    const sky = latest((changes) => actions.ask("set_environment", { changes }));
    this.#sky = el("select", {
      id: "sky", on: { change: () => sky(this.#sky.value ? { sky_map: this.#sky.value, background: "sky" } : { sky_map: "" }) },
    });
    this.#exposure = slider("exposure", -3, 3, 0.05, (value) => sky({ exposure: value }));
    this.#share = slider("sky's light", 0, 1, 0.01, (value) => sky({ sky_share: value }));
    this.#ambient = slider("ambient", 0, 1, 0.005, (value) => sky({ ambient: this.#tinted(value) }));
    this.root = el(
      "div",
      {},
      section("Picture and sky", line("sky", this.#sky), this.#exposure.root, this.#share.root, this.#ambient.root),
      // The adder first: a list that grows does not push it away from the pointer.
      section("Lights", this.#adder(), this.#lights),
    );
    store.on(["scene", "hello"], (state) => this.#show(state));
  }

  /** @param {Readonly<State>} state */
  #show({ scene, hello }) {
    if (!scene || !hello) return;
    const { environment, lights } = scene;
    options(this.#sky, ["", ...hello.skies].map((name) => ({ value: name, words: name || "plain colours" })));
    put(this.#sky, environment.sky_map);
    this.#exposure.set(environment.exposure);
    this.#share.set(environment.sky_share);
    this.#colour = environment.ambient;
    this.#ambient.set(Math.max(...environment.ambient));
    if (lights.length) keyed(this.#lights, lights, ({ name }) => name, (light) => this.#light(light));
    else keyed(this.#lights, [""], String, () => ({ root: el("p", { class: "advice" }, "This scene has none.") }));
  }

  /** The ambient light, as bright as the slider says and of the colour that it has. @param {number} value */
  #tinted(value) {
    const most = Math.max(...this.#colour);
    return this.#colour.map((part) => (most > 0 ? (part / most) * value : value));
  }

  #adder() {
    const type = el("select", { id: "light-type" });
    options(type, TYPES.map((value) => ({ value, words: value })));
    const name = el("input", { type: "text", id: "light-name", placeholder: "made of the type", spellcheck: false });
    const add = async () => {
      const typed = name.value;
      const chosen = TYPES[type.selectedIndex] ?? "point";
      const added = await this.#actions.try("add_light", {
        light_type: chosen, light_name: typed.trim() || null, attributes: { intensity: INTENSITIES[chosen] },
      });
      // The next name may have been typed meanwhile.
      if (added !== undefined && name.value === typed) name.value = "";
    };
    return el("details", {}, el("summary", {}, "Add a light"),
      el("p", { class: "advice" }, "It hangs where the camera is now and shines where it looks."),
      line("type", type),
      line("name", name),
      button("Add", add, { glyph: "plus", kind: "primary add-light" }));
  }

  /** @param {LightNews} light */
  #light({ name, intensity }) {
    /** @type {(changes: import("./messages.js").LightChanges) => void} */
    const send = latest((changes) => this.#actions.ask("set_light", { light_name: name, changes }));
    const most = Math.max(1, 4 * intensity);
    const strength = slider("intensity", 0, most, most / 200, (value) => send({ intensity: value }));
    const colour = el("input", {
      type: "color", title: `Colour of ${name}`,
      on: { input: () => send({ colour: linearOfHex(colour.value) }) },
    });
    const kind = el("span", { class: "kind" });
    const remove = () => this.#actions.try("remove_light", { light_name: name });
    const root = el("div", { class: "light", data: { light: name } },
      el("div", { class: "line" }, el("strong", {}, name), kind, colour,
        button("", remove, { glyph: "trash", title: `Remove ${name}`, kind: "icon quiet danger" })),
      strength.root);
    return {
      root,
      /** @param {LightNews} light */
      set: (light) => {
        say(kind, light.type);
        strength.set(light.intensity);
        put(colour, hexOfLinear(light.colour));
      },
    };
  }
}
