// Lights and sky: sliders whose newest value is sent; lights come where the camera is, and go.

import { button, el, hexOfLinear, latest, linearOfHex, put, section, slider } from "./dom.js";

// What a light of a type begins with: bright enough to be seen in a furnished room.
const INTENSITIES = { point: 1, spot: 2, area: 2, directional: 1 };

export class LightPanel {
  title = "Light";

  constructor(app) {
    this.app = app;
    this.lights = el("div", { id: "lights" });
    this.controls = new Map();
    const sky = latest((changes) => app.ask("set_environment", { changes }));
    this.sky = el("select", {
      id: "sky", on: { change: () => sky(this.sky.value ? { sky_map: this.sky.value, background: "sky" } : { sky_map: null }) },
    });
    this.exposure = slider("exposure", -3, 3, 0.05, (value) => sky({ exposure: value }));
    this.share = slider("sky's light", 0, 1, 0.01, (value) => sky({ sky_share: value }));
    this.ambient = slider("ambient", 0, 1, 0.005, (value) => sky({ ambient: this.#tinted(value) }));
    this.root = el(
      "div",
      {},
      section(
        "Picture and sky",
        el("label", { class: "line" }, el("span", {}, "sky"), this.sky),
        this.exposure.root,
        this.share.root,
        this.ambient.root,
      ),
      section("Lights", this.lights, this.#adder()),
    );
  }

  frame() {}

  update(scene) {
    const { environment, lights } = scene;
    const skies = ["", ...this.app.hello.skies];
    if (this.sky.options.length !== skies.length) {
      this.sky.replaceChildren(...skies.map((name) => el("option", { value: name }, name || "plain colours")));
    }
    put(this.sky, environment.sky_map);
    this.exposure.set(environment.exposure);
    this.share.set(environment.sky_share);
    this.colour = environment.ambient;
    this.ambient.set(Math.max(...environment.ambient));
    const names = lights.map(({ name }) => name).join("\n");
    if (names !== this.names) {
      this.names = names;
      this.controls = new Map(lights.map((light) => [light.name, this.#light(light)]));
      this.lights.replaceChildren(
        ...(lights.length ? [...this.controls.values()].map(({ root }) => root)
          : [el("p", { class: "advice" }, "This scene has none.")]),
      );
    }
    for (const light of lights) this.controls.get(light.name).set(light);
  }

  /** The ambient light, as bright as the slider says and of the colour that it has. */
  #tinted(value) {
    const most = Math.max(...this.colour);
    return this.colour.map((part) => (most > 0 ? (part / most) * value : value));
  }

  #adder() {
    const types = Object.keys(INTENSITIES).map((type) => el("option", { value: type }, type));
    const type = el("select", { id: "light-type" }, ...types);
    const name = el("input", { type: "text", id: "light-name", placeholder: "made of the type", spellcheck: false });
    const add = async () => {
      const typed = name.value;
      const values = { light_name: typed.trim() || this.#freeName(type.value), light_type: type.value };
      const attributes = { intensity: INTENSITIES[type.value] };
      const added = (await this.app.try("add_light", { ...values, attributes })) !== undefined;
      // The next name may have been typed meanwhile.
      if (added && name.value === typed) name.value = "";
    };
    return el("details", {}, el("summary", {}, "Add a light"),
      el("p", { class: "advice" }, "It hangs where the camera is now and shines where it looks."),
      el("label", { class: "line" }, el("span", {}, "type"), type),
      el("label", { class: "line" }, el("span", {}, "name"), name),
      button("Add", add, { glyph: "plus", kind: "primary add-light" }));
  }

  #freeName(type) {
    const taken = new Set(this.app.scene.lights.map(({ name }) => name));
    let number = 1;
    while (taken.has(`${type} ${number}`)) number += 1;
    return `${type} ${number}`;
  }

  #light({ name, type, intensity }) {
    const send = latest((changes) => this.app.ask("set_light", { light_name: name, changes }));
    const most = Math.max(1, 4 * intensity);
    const strength = slider("intensity", 0, most, most / 200, (value) => send({ intensity: value }));
    const colour = el("input", {
      type: "color", title: `Colour of ${name}`,
      on: { input: () => send({ colour: linearOfHex(colour.value) }) },
    });
    const root = el("div", { class: "light", data: { light: name } },
      el("div", { class: "line" }, el("strong", {}, name), el("span", { class: "kind" }, type), colour,
        button("", () => this.app.try("remove_light", { light_name: name }), {
          glyph: "trash", title: `Remove ${name}`, kind: "icon quiet danger",
        })),
      strength.root);
    return {
      root,
      set: (light) => {
        strength.set(light.intensity);
        put(colour, hexOfLinear(light.colour));
      },
    };
  }
}
