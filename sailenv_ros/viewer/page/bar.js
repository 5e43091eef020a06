// @ts-check
// The bar above the pictures: scene, time, history, whose pictures, files.

import { $, fixed, icon, options, own, put, toast } from "./dom.js";
import { mayChange } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {State, Store} from "./store.js" */

const GLYPHS = {
  play: "pause", step: "step", reset: "reset", undo: "undo", redo: "redo", layout: "one", screenshot: "camera", sheet: "sheet",
};
const RATE_OVER_MS = 2000;

export class Bar {
  #scene = own("scene", HTMLSelectElement);
  #agent = own("agent", HTMLSelectElement);
  #play = own("play", HTMLButtonElement);
  #step = own("step", HTMLButtonElement);
  /** @type {number[]} */
  #times = [];

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    for (const [id, name] of Object.entries(GLYPHS)) glyph($(id), name);
    /** @type {(id: string, act: () => void) => void} */
    const click = (id, act) => $(id).addEventListener("click", () => {
      act();
      $(id).blur();
    });
    click("play", () => actions.try(store.state.scene?.paused ? "resume" : "pause", {}));
    click("step", () => actions.try("step", { count: 8 }));
    click("reset", () => actions.try("reset", {}));
    click("undo", () => actions.goBack("undo"));
    click("redo", () => actions.goBack("redo"));
    click("layout", () => actions.toggleAll());
    click("screenshot", () => actions.save("screenshot"));
    click("sheet", () => actions.save("sheet"));
    this.#scene.addEventListener("change", () => {
      toast(`Loading ${this.#scene.value} …`);
      actions.try("change_scene", { scene: this.#scene.value });
      this.#scene.blur();
    });
    this.#agent.addEventListener("change", () => {
      store.set({ agent: this.#agent.value });
      this.#agent.blur();
    });
    store.on(["scene", "agent", "hello"], (state) => this.#showScene(state));
    store.on(["stats", "hello"], (state) => this.#showStats(state));
    store.on(["frame"], () => this.#countFrame());
    store.on(["views"], ({ views }) => glyph($("layout"), views.all ? "one" : "grid"));
    store.on(["hello"], (state) => {
      $("watching-only").hidden = mayChange(state);
    });
  }

  /** @param {Readonly<State>} state */
  #showScene({ scene, agent, hello }) {
    if (!scene || !hello) return;
    const scenes = scene.scenes.includes(scene.scene) ? scene.scenes : [scene.scene, ...scene.scenes];
    choose(this.#scene, scenes, scene.scene);
    choose(this.#agent, [...new Set([hello.debug_agent, ...scene.agents.map(({ name }) => name)])], agent);
    glyph(this.#play, scene.paused ? "play" : "pause");
    this.#play.title = scene.paused ? "Let time run" : "Pause time";
    this.#play.disabled = scene.mode === "lockstep";
    this.#step.disabled = !scene.paused && scene.mode !== "lockstep";
  }

  /** @param {Readonly<State>} state */
  #showStats(state) {
    const { stats } = state;
    if (!stats) return;
    $("clock").textContent = `${fixed(stats.time_s)} s`;
    $("pace").textContent = `× ${fixed(stats.real_time_factor)}`;
    $("building").textContent = $("building").title = stats.building;
    for (const { id, words, what, key } of [
      { id: "undo", words: "Undo", what: stats.undo, key: "Z" },
      { id: "redo", words: "Do again", what: stats.redo, key: "Shift+Z" },
    ]) {
      const made = own(id, HTMLButtonElement);
      made.disabled = !what || !mayChange(state);
      made.title = `${words}${what ? `: ${what}` : ""} (${key})`;
    }
  }

  #countFrame() {
    const now = performance.now();
    this.#times = [...this.#times.filter((time) => now - time < RATE_OVER_MS), now];
    const span = now - (this.#times[0] ?? now);
    if (span > 200) $("fps").textContent = `${fixed((1000 * (this.#times.length - 1)) / span, 1)} fps`;
  }
}

/** @param {HTMLElement} holder @param {string} name */
function glyph(holder, name) {
  if (holder.dataset.glyph === name) return;
  holder.dataset.glyph = name;
  holder.replaceChildren(icon(name));
}

/** @param {HTMLSelectElement} select @param {readonly string[]} names @param {string} chosen */
function choose(select, names, chosen) {
  options(select, names.map((name) => ({ value: name, words: name })));
  put(select, chosen);
}
