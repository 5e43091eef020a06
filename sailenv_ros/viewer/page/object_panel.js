// @ts-check
// The selected object and all objects to choose from.

import { el, keyed, say, section } from "./dom.js";
import { ObjectEditor } from "./object_editor.js";

/** @import {Actions} from "./actions.js" */
/** @import {InstanceNews} from "./messages.js" */
/** @import {Store} from "./store.js" */

export class ObjectPanel {
  title = "Object";
  #store;
  #actions;
  #search = el("input", {
    type: "search", placeholder: "Search objects", id: "object-search",
    on: { input: () => this.#list() },
  });
  #objects = el("div", { class: "list", id: "objects" });

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    const editor = new ObjectEditor(store, actions);
    this.root = el("div", {}, editor.root, section("All objects", this.#search, this.#objects));
    store.on(["scene", "selected"], () => this.#list());
  }

  #list() {
    const words = this.#search.value.trim().toLowerCase();
    const found = (this.#store.state.scene?.instances ?? []).filter(
      ({ name, category }) => !words || `${name} ${category}`.toLowerCase().includes(words),
    );
    keyed(this.#objects, found, ({ id }) => String(id), ({ id }) => this.#row(id));
  }

  /** @param {number} id */
  #row(id) {
    const chip = el("span", { class: "chip" });
    const name = el("span", { class: "name" });
    const count = el("span", { class: "count" });
    const share = el("span", { class: "share" });
    const root = el("button", { class: "row", data: { id }, on: { click: () => this.#actions.select(id) } },
      chip, name, count, share);
    /** @param {InstanceNews} instance */
    const set = (instance) => {
      const { scene, selected } = this.#store.state;
      const colour = scene?.categories.find((category) => category.id === instance.category_id)?.colour;
      chip.style.background = `rgb(${(colour ?? [128, 128, 128]).join(" ")})`;
      say(name, instance.name);
      say(count, instance.is_part ? "part" : instance.moves ? "moves" : "");
      say(share, instance.category);
      root.classList.toggle("on", id === selected);
    };
    return { root, set };
  }
}
