// @ts-check
// What is done to the watched agent's picture: a control for each setting that the simulator tells.

import { button, el, keyed, latest, line, options, put, say, section, slider } from "./dom.js";
import { agentOf } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {PictureChanges, PictureSetting} from "./messages.js" */
/** @import {State, Store} from "./store.js" */

/** @typedef {{ least?: number, most?: number, step?: number, label?: string }} Look */
/** @typedef {PictureSetting["default"]} Value */
/** @typedef {{ root: HTMLElement, set: (value: any) => void }} Control */

const WIDEST_SLIDER = 100;

/** How settings are shown; of one that is not here, its own name and limits. @type {Record<string, Look>} */
const SHOWN = {
  exposure: { least: -3, most: 3, step: 0.05 },
  occlusion_strength: { label: "occlusion", step: 0.01 },
  occlusion_radius_m: { label: "from within", most: 1, step: 0.01 },
  bloom: { step: 0.01 },
  full_well: { label: "full well", step: 100 },
};

export class PicturePanel {
  title = "Picture";
  #store;
  #actions;
  /** @type {Map<string, Control>} */
  #controls = new Map();
  #about = el("p", { class: "advice" });
  #holder = el("div", { id: "picture-settings" });

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    this.root = el("div", {}, section(
      "Picture",
      this.#about,
      this.#holder,
      el("div", { class: "buttons" },
        button("Defaults", () => this.#defaults(), { glyph: "reset", kind: "primary defaults" })),
    ));
    store.on(["hello"], ({ hello }) => {
      keyed(this.#holder, hello?.picture_settings ?? [], ({ name }) => name, (setting) => {
        const control = this.#control(setting);
        this.#controls.set(setting.name, control);
        return { root: control.root };
      });
    });
    store.on(["scene", "agent", "hello"], (state) => this.#show(state));
  }

  /** @param {Readonly<State>} state */
  #show(state) {
    const agent = agentOf(state);
    if (!agent) return;
    say(this.#about, `Of ${agent.name}, for all who look through it. Of labels, depth and flow it changes the instants alone.`);
    for (const [name, control] of this.#controls) control.set(agent.picture[name]);
  }

  /** @param {PictureSetting} setting @returns {Control} */
  #control(setting) {
    const { name, choices } = setting;
    const label = SHOWN[name]?.label ?? name.replaceAll("_", " ");
    // Whose picture it is, is settled when the control is moved, not when it is sent.
    /** @type {(sent: { agent: string, value: Value }) => void} */
    const newest = latest(async ({ agent, value }) => {
      try {
        await this.#actions.ask("set_picture", { agent, changes: { [name]: value } });
      } catch (error) {
        this.#show(this.#store.state); // what was refused is not shown as if it were so
        throw error;
      }
    });
    /** @param {Value} value */
    const send = (value) => newest({ agent: this.#store.state.agent, value });
    if (typeof setting.default === "boolean") {
      const input = el("input", { type: "checkbox", on: { change: () => send(input.checked) } });
      return of(name, line(label, input), (value) => (input.checked = value));
    }
    if (choices.length) {
      const input = el("select", {
        on: {
          change: () => {
            send(input.value);
            input.blur();
          },
        },
      });
      options(input, choices.map((choice) => ({ value: choice, words: choice })));
      return of(name, line(label, input), (value) => put(input, value));
    }
    return number(setting, label, send);
  }

  #defaults() {
    const { hello, agent } = this.#store.state;
    const told = (hello?.picture_settings ?? []).map((setting) => [setting.name, setting.default]);
    /** @type {PictureChanges} */
    const changes = Object.fromEntries(told);
    this.#actions.try("set_picture", { agent, changes });
  }
}

/** @param {string} name @param {HTMLElement} root @param {(value: any) => void} set @returns {Control} */
function of(name, root, set) {
  root.dataset.setting = name;
  return { root, set };
}

/** @param {PictureSetting} setting @param {string} label @param {(value: number) => void} send @returns {Control} */
function number({ name, whole, least, most, unit }, label, send) {
  const look = SHOWN[name] ?? {};
  const from = look.least ?? least;
  const to = look.most ?? most;
  if (from === null || to === null || to - from > WIDEST_SLIDER) {
    const input = el("input", {
      type: "number", min: from ?? "", max: to ?? "", step: look.step ?? 1, title: unit,
      on: {
        change: () => {
          if (input.value !== "") send(Number(input.value));
          input.blur();
        },
      },
    });
    return of(name, line(label, input), (value) => put(input, value));
  }
  const made = slider(label, from, to, look.step ?? (whole ? 1 : (to - from) / 200), send);
  made.root.title = unit;
  return of(name, made.root, made.set);
}
