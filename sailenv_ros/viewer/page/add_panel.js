// The catalogue: what can be put into the scene, by a click or by dragging it into a picture.

import { el, section } from "./dom.js";

export class AddPanel {
  title = "Add";

  constructor(app) {
    this.app = app;
    this.names = "";
    this.search = el("input", {
      type: "search", placeholder: "Search the catalogue", id: "catalogue-search",
      on: { input: () => this.#filter() },
    });
    this.cards = el("div", { class: "cards", id: "catalogue" });
    this.root = el(
      "div",
      {},
      section(
        "Catalogue",
        this.search,
        el("p", { class: "advice" }, "Click to put one where you look; or drag it into the picture."),
        this.cards,
      ),
    );
  }

  frame() {}

  update(scene) {
    const names = scene.spawnables.join();
    if (names === this.names) return;
    this.names = names;
    this.cards.replaceChildren(...scene.spawnables.map((asset) => this.#card(asset)));
    this.#filter();
  }

  #card(asset) {
    const picture = el("img", {
      loading: "lazy", decoding: "async", alt: "", width: 128, height: 96, draggable: false,
      src: `thumbnail/${encodeURIComponent(asset)}${location.search}`,
      on: { error: (event) => event.target.classList.add("missing") },
    });
    return el(
      "button",
      {
        class: "card", title: asset, draggable: true, data: { asset },
        on: {
          click: () => this.app.spawn(asset),
          dragstart: (event) => {
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
    const words = this.search.value.trim().toLowerCase();
    for (const card of this.cards.children) {
      card.hidden = words !== "" && !card.title.replaceAll("_", " ").includes(words) && !card.title.includes(words);
    }
  }
}
