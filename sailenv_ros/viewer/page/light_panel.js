// Lights and sky: sliders whose newest value is sent.

import { el, fixed, hexOfLinear, latest, linearOfHex, put, section } from "./dom.js";

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
      section("Lights", this.lights),
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

  #light({ name, type, intensity }) {
    const send = latest((changes) => this.app.ask("set_light", { light: name, changes }));
    const most = Math.max(1, 4 * intensity);
    const strength = slider("intensity", 0, most, most / 200, (value) => send({ intensity: value }));
    const colour = el("input", {
      type: "color", title: `Colour of ${name}`,
      on: { input: () => send({ colour: linearOfHex(colour.value) }) },
    });
    const root = el("div", { class: "light", data: { light: name } },
      el("div", { class: "line" }, el("strong", {}, name), el("span", { class: "kind" }, type), colour),
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

function slider(label, least, most, step, changed) {
  const shown = el("output", {});
  const input = el("input", {
    type: "range", min: least, max: most, step, title: label, "aria-label": label,
    on: {
      input: () => {
        shown.textContent = fixed(input.value);
        changed(Number(input.value));
      },
      change: () => input.blur(),
    },
  });
  return {
    input,
    root: el("label", { class: "slider" }, el("span", {}, label), input, shown),
    set: (value) => {
      if (document.activeElement === input) return;
      if (value > Number(input.max)) input.max = value;
      input.value = value;
      shown.textContent = fixed(value);
    },
  };
}
