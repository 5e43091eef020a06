// @ts-check
// The catalogue: what can be put into the scene, by a click or by dragging it into a picture; robots.

import { el, keyed, section } from "./dom.js";

/** @import {Actions} from "./actions.js" */
/** @import {Store} from "./store.js" */

export class AddPanel {
  title = "Add";
  #actions;
  #search = el("input", {
    type: "search", placeholder: "Search the catalogue", id: "catalogue-search",
    on: { input: () => this.#filter() },
  });
  #robot = el("input", {
    type: "text", placeholder: "PACKAGE:path of a URDF or MJCF file", id: "robot-file",
    on: { change: () => this.#actions.addRobot(this.#robot.value.trim()) },
  });
  #cards = el("div", { class: "cards", id: "catalogue" });

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#actions = actions;
    this.root = el("div", {}, section(
      "Catalogue",
      this.#search,
      el("p", { class: "advice" }, "Click to put one where you look; or drag it into the picture."),
      this.#cards,
    ), section("Robot", this.#robot));
    store.on(["scene"], ({ scene }) => {
      keyed(this.#cards, scene?.spawnables ?? [], (asset) => asset, (asset) => ({ root: this.#card(asset) }));
      this.#filter();
    });
  }

  /** @param {string} asset */
  #card(asset) {
    const picture = el("img", {
      loading: "lazy", decoding: "async", alt: "", width: 128, height: 96, draggable: false,
      src: `thumbnail/${encodeURIComponent(asset)}${location.search}`,
      on: { error: () => picture.classList.add("missing") },
    });
    return el(
      "button",
      {
        class: "card", title: asset, draggable: true, data: { asset },
        on: {
          click: () => this.#actions.spawn(asset),
          dragstart: (/** @type {DragEvent} */ event) => {
            if (!event.dataTransfer) return;
            event.dataTransfer.setData("text/plain", asset);
            event.dataTransfer.effectAllowed = "copy";
          },
        },
      },
      picture,
      el("span", {}, asset.replaceAll("_", " ")),
    );
  }

  #filter() {
    const words = this.#search.value.trim().toLowerCase();
    for (const card of this.#cards.children) {
      if (!(card instanceof HTMLElement)) continue;
      const asset = card.title;
      card.hidden = words !== "" && !asset.replaceAll("_", " ").includes(words) && !asset.includes(words);
    }
  }
}
