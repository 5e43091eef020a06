// What the selected object, wall or floor is made of: a material, a picture, a colour, a finish.

import { button, el, latest, put, section, slider, toast } from "./dom.js";

const LONGEST_PX = 1024; // renderers hold no finer picture
const PIECE = 45000; // characters of a message

export class MaterialEditor {
  constructor(app) {
    this.app = app;
    this.id = 0;
    this.part = el("select", { id: "material-part", on: { change: () => this.#fill() } });
    this.material = el("select", {
      id: "material", on: { change: () => this.#send({ material: this.material.value || null }) },
    });
    this.file = el("input", {
      type: "file", accept: "image/png,image/jpeg", id: "material-picture", title: "A picture of your own",
      on: { change: () => this.#picture() },
    });
    this.tile = el("input", {
      type: "number", min: 0.01, max: 100, step: 0.1, id: "material-tile",
      on: { change: () => this.#send({ tile: Number(this.tile.value) || null }) },
    });
    const send = latest((changes) => this.#ask(changes));
    this.colour = el("input", {
      type: "color", id: "material-colour", title: "Colour instead of its own",
      on: { input: () => send({ colour: this.colour.value }) },
    });
    this.roughness = slider("roughness", 0, 1, 0.01, (value) => send({ roughness: value }));
    this.metallic = slider("metallic", 0, 1, 0.01, (value) => send({ metallic: value }));
    const line = (label, ...inputs) => el("label", { class: "line" }, el("span", {}, label), ...inputs);
    this.root = section(
      "Made of",
      line("part", this.part),
      line("material", this.material),
      line("picture", this.file),
      line("tile [m]", this.tile),
      line("colour", this.colour),
      this.roughness.root,
      this.metallic.root,
      button("Its own again", () => this.#send({}), { kind: "quiet", title: "Take its own materials" }),
    );
  }

  show(id) {
    const other = id !== this.id;
    this.id = id;
    const names = ["", ...(this.#instance()?.materials ?? [])];
    const before = other ? "" : this.part.value;
    this.part.replaceChildren(...names.map((name) => el("option", { value: name }, name || "all of it")));
    this.part.value = names.includes(before) ? before : "";
    const materials = ["", ...this.app.hello.materials];
    if (this.material.options.length !== materials.length) {
      this.material.replaceChildren(...materials.map((name) => el("option", { value: name }, name || "its own")));
    }
    this.#fill();
  }

  #instance() {
    return this.app.instances.get(this.id);
  }

  #fill() {
    const painted = this.#instance()?.painted ?? [];
    const chosen = this.part.value || "all";
    const look = painted.find(({ part }) => (part ?? "all") === chosen) ?? {};
    put(this.material, look.material ?? "");
    const tile = Array.isArray(look.tile) ? look.tile[0] : look.tile;
    put(this.tile, tile ?? "");
    put(this.colour, typeof look.colour === "string" ? look.colour : "#808080");
    this.roughness.set(look.roughness ?? 0.5);
    this.metallic.set(look.metallic ?? 0);
  }

  #ask(changes) {
    return this.app.ask("set_material", { obj: this.id, part: this.part.value, changes });
  }

  async #send(changes) {
    await this.app.try("set_material", { obj: this.id, part: this.part.value, changes });
    document.activeElement?.blur();
  }

  /** Send a picture, no larger than it is drawn, in pieces. */
  async #picture() {
    const [file] = this.file.files;
    if (!file) return;
    try {
      const bitmap = await createImageBitmap(file);
      const share = Math.min(1, LONGEST_PX / Math.max(bitmap.width, bitmap.height));
      const canvas = el("canvas", {
        width: Math.max(1, Math.round(bitmap.width * share)),
        height: Math.max(1, Math.round(bitmap.height * share)),
      });
      canvas.getContext("2d").drawImage(bitmap, 0, 0, canvas.width, canvas.height);
      const whole = canvas.toDataURL("image/jpeg", 0.92).split(",")[1];
      let name = null;
      for (let at = 0; at < whole.length; at += PIECE) {
        name = await this.app.ask("send_picture", {
          data: whole.slice(at, at + PIECE), first: at === 0, last: at + PIECE >= whole.length,
        });
      }
      await this.#send({ picture: name });
    } catch (error) {
      toast(error.message, "error");
    }
    this.file.value = "";
  }
}
