// What is done to the watched agent's picture: a control for each setting that the simulator tells.

import { button, el, latest, put, section, slider } from "./dom.js";

const WIDEST_SLIDER = 100;

// How settings are shown; of one that is not here, its own name and limits.
const SHOWN = {
  exposure: { least: -3, most: 3, step: 0.05 },
  occlusion_strength: { label: "occlusion", step: 0.01 },
  occlusion_radius_m: { label: "from within", most: 1, step: 0.01 },
  bloom: { step: 0.01 },
  full_well: { label: "full well", step: 100 },
};

export class PicturePanel {
  title = "Picture";

  constructor(app) {
    this.app = app;
    this.controls = new Map();
    this.about = el("p", { class: "advice" });
    this.holder = el("div", { id: "picture-settings" });
    this.root = el(
      "div",
      {},
      section(
        "Picture",
        this.about,
        this.holder,
        el("div", { class: "buttons" },
          button("Defaults", () => this.#defaults(), { glyph: "reset", kind: "primary defaults" })),
      ),
    );
  }

  frame() {}

  update(scene) {
    const told = this.app.hello.picture_settings;
    if (this.controls.size !== told.length) {
      this.controls = new Map(told.map((setting) => [setting.name, this.#control(setting)]));
      this.holder.replaceChildren(...[...this.controls.values()].map(({ root }) => root));
    }
    const agent = scene.agents.find(({ name }) => name === this.app.agent);
    if (!agent) return;
    this.about.textContent = `Of ${agent.name}, for all who look through it. Labels, depth and flow do not depend on it.`;
    for (const [name, control] of this.controls) control.set(agent.picture[name]);
  }

  #control(setting) {
    const { name, choices } = setting;
    const label = SHOWN[name]?.label ?? name.replaceAll("_", " ");
    // Whose picture it is, is settled when the control is moved, not when it is sent.
    const newest = latest(async ([agent, value]) => {
      try {
        await this.app.ask("set_picture", { agent, changes: { [name]: value } });
      } catch (error) {
        this.update(this.app.scene); // what was refused is not shown as if it were so
        throw error;
      }
    });
    const send = (value) => newest([this.app.agent, value]);
    const line = (input, set) => ({ root: el("label", { class: "line", data: { setting: name } }, el("span", {}, label), input), set });
    if (typeof setting.default === "boolean") {
      const input = el("input", { type: "checkbox", on: { change: () => send(input.checked) } });
      return line(input, (value) => (input.checked = value));
    }
    if (choices.length) {
      const options = choices.map((choice) => el("option", { value: choice }, String(choice)));
      const input = el("select", { on: { change: () => {
        send(choices[input.selectedIndex]);
        input.blur();
      } } }, ...options);
      return line(input, (value) => put(input, value));
    }
    return this.#number(setting, label, send, line);
  }

  #number({ name, whole, least, most, unit }, label, send, line) {
    const from = SHOWN[name]?.least ?? least;
    const to = SHOWN[name]?.most ?? most;
    if (from === null || to === null || to - from > WIDEST_SLIDER) {
      const input = el("input", {
        type: "number", min: from ?? "", max: to ?? "", step: SHOWN[name]?.step ?? 1, title: unit,
        on: {
          change: () => {
            if (input.value !== "") send(Number(input.value));
            input.blur();
          },
        },
      });
      return line(input, (value) => put(input, value));
    }
    const step = SHOWN[name]?.step ?? (whole ? 1 : (to - from) / 200);
    const made = slider(label, from, to, step, send);
    made.root.dataset.setting = name;
    made.root.title = unit;
    return made;
  }

  #defaults() {
    const changes = Object.fromEntries(this.app.hello.picture_settings.map((setting) => [setting.name, setting.default]));
    this.app.try("set_picture", { agent: this.app.agent, changes });
  }
}
