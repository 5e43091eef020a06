// @ts-check
// What the selected object, wall or floor is made of: a material, a picture, a colour, a finish.

import { blur, button, el, latest, line, options, put, section, slider, toast, wordsOf } from "./dom.js";

/** @import {Actions} from "./actions.js" */
/** @import {MaterialChanges} from "./messages.js" */
/** @import {State, Store} from "./store.js" */

const LONGEST_PX = 1024; // renderers hold no finer picture
const PIECE = 45000; // characters of a message

export class MaterialEditor {
  #store;
  #actions;
  #id = 0;
  #part = el("select", { id: "material-part", on: { change: () => this.#fill() } });
  #material = el("select", {
    id: "material", on: { change: () => this.#send({ material: this.#material.value || null }) },
  });
  #file = el("input", {
    type: "file", accept: "image/png,image/jpeg", id: "material-picture", title: "A picture of your own",
    on: { change: () => this.#picture() },
  });
  #tile = el("input", {
    type: "number", min: 0.01, max: 100, step: 0.1, id: "material-tile",
    on: { change: () => this.#send({ tile: Number(this.#tile.value) || null }) },
  });
  #colour;
  #roughness;
  #metallic;

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    /** @type {(changes: MaterialChanges) => void} */
    const send = latest((changes) => actions.ask("set_material", { obj: this.#id, part: this.#part.value, changes }));
    this.#colour = el("input", {
      type: "color", id: "material-colour", title: "Colour instead of its own",
      on: { input: () => send({ colour: this.#colour.value }) },
    });
    this.#roughness = slider("roughness", 0, 1, 0.01, (value) => send({ roughness: value }));
    this.#metallic = slider("metallic", 0, 1, 0.01, (value) => send({ metallic: value }));
    this.root = section(
      "Made of",
      line("part", this.#part),
      line("material", this.#material),
      line("picture", this.#file),
      line("tile [m]", this.#tile),
      line("colour", this.#colour),
      this.#roughness.root,
      this.#metallic.root,
      button("Its own again", () => this.#send({}), { kind: "quiet", title: "Take its own materials" }),
    );
    store.on(["scene", "selected", "hello"], (state) => this.#show(state));
  }

  get #instance() {
    return this.#store.state.instances.get(this.#id);
  }

  /** @param {Readonly<State>} state */
  #show({ selected, hello }) {
    const before = selected === this.#id ? this.#part.value : "";
    this.#id = selected;
    const parts = ["", ...(this.#instance?.materials ?? [])];
    options(this.#part, parts.map((name) => ({ value: name, words: name || "all of it" })));
    this.#part.value = parts.includes(before) ? before : "";
    const materials = ["", ...(hello?.materials ?? [])];
    options(this.#material, materials.map((name) => ({ value: name, words: name || "its own" })));
    this.#fill();
  }

  #fill() {
    const chosen = this.#part.value || "all";
    const look = this.#instance?.painted.find(({ part }) => (part ?? "all") === chosen) ?? {};
    put(this.#material, look.material ?? "");
    const tile = Array.isArray(look.tile) ? look.tile[0] : look.tile;
    put(this.#tile, tile ?? "");
    put(this.#colour, typeof look.colour === "string" ? look.colour : "#808080");
    this.#roughness.set(look.roughness ?? 0.5);
    this.#metallic.set(look.metallic ?? 0);
  }

  /** @param {MaterialChanges} changes */
  async #send(changes) {
    await this.#actions.try("set_material", { obj: this.#id, part: this.#part.value, changes });
    blur();
  }

  /** Send a picture, no larger than it is drawn, in pieces. */
  async #picture() {
    const file = this.#file.files?.[0];
    if (!file) return;
    try {
      const bitmap = await createImageBitmap(file);
      const share = Math.min(1, LONGEST_PX / Math.max(bitmap.width, bitmap.height));
      const canvas = el("canvas", {
        width: Math.max(1, Math.round(bitmap.width * share)),
        height: Math.max(1, Math.round(bitmap.height * share)),
      });
      canvas.getContext("2d")?.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
      const whole = canvas.toDataURL("image/jpeg", 0.92).split(",")[1] ?? "";
      let name = null;
      for (let at = 0; at < whole.length; at += PIECE) {
        name = await this.#actions.ask("send_picture", {
          data: whole.slice(at, at + PIECE), first: at === 0, last: at + PIECE >= whole.length,
        });
      }
      await this.#send({ picture: name });
    } catch (error) {
      toast(wordsOf(error), "error");
    }
    this.#file.value = "";
  }
}
