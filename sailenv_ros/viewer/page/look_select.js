// @ts-check
// What the agent that is shown keeps looking at: a list of nothing and all objects.

import { options, own, put } from "./dom.js";
import { agentOf, mayChange } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {LookAtNews} from "./messages.js" */
/** @import {State, Store} from "./store.js" */

const NOTHING = "";
const ELSEWHERE = "elsewhere";

export class LookSelect {
  #select = own("look-at", HTMLSelectElement);

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#select.addEventListener("change", async () => {
      const obj = Number(this.#select.value) || null;
      this.#select.blur();
      await actions.try("set_look_at", { agent: store.state.agent, obj });
      this.#show(store.state); // a refused choice is taken back
    });
    store.on(["scene", "agent", "hello"], (state) => this.#show(state));
  }

  /** @param {Readonly<State>} state */
  #show(state) {
    if (!state.scene) return;
    const agent = agentOf(state);
    this.#select.disabled = !agent || !mayChange(state);
    const objects = state.scene.instances.filter((instance) => !instance.is_part);
    objects.sort((one, other) => one.name.localeCompare(other.name));
    const faced = agent?.look_at;
    const found = objects.find(({ name }) => name === faced?.object);
    const offers = [
      { value: NOTHING, words: "nothing", disabled: false },
      ...objects.map(({ id, name }) => ({ value: String(id), words: name, disabled: false })),
    ];
    // What a program has set and this list cannot: a point of the world or of an object, an object that waits.
    const elsewhere = faced && (!found || faced.point.some((value) => value !== 0));
    if (elsewhere) offers.push({ value: ELSEWHERE, words: words(faced), disabled: true });
    options(this.#select, offers);
    put(this.#select, elsewhere ? ELSEWHERE : found ? String(found.id) : NOTHING);
  }
}

/** @param {LookAtNews} faced */
const words = ({ object, point }) => {
  const place = `(${point.map((value) => Number(value.toFixed(2))).join(", ")})`;
  return object ? `${object} at ${place}` : place;
};
