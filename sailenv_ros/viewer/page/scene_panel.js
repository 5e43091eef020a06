// The scene as a whole: save it, begin it with another seed, how fast time runs, who is there.

import { button, download, el, fixed, put, section, toast } from "./dom.js";
import { pairs } from "./view_panel.js";

const SIZES = [[320, 240], [640, 480], [800, 450], [1280, 720]];

export class ScenePanel {
  title = "Scene";

  constructor(app) {
    this.app = app;
    this.name = el("input", { type: "text", id: "save-name", placeholder: "my_room", spellcheck: false });
    this.sceneTitle = el("input", { type: "text", id: "save-title", placeholder: "as it was" });
    this.overwrite = el("input", { type: "checkbox", id: "save-overwrite" });
    this.saved = el("p", { class: "advice", id: "saved" });
    this.seed = el("input", { type: "number", min: 0, step: 1, id: "seed" });
    this.factor = el("input", {
      type: "number", min: 0.1, max: 10, step: 0.1, id: "factor",
      on: { change: () => app.try("set_real_time_factor", { factor: Number(this.factor.value) }) },
    });
    this.size = el("select", {
      id: "size",
      on: {
        change: () => {
          const [width, height] = this.size.value.split("x").map(Number);
          this.app.lens = { ...this.app.lens, width, height };
          app.try("lens", this.app.lens);
        },
      },
    }, ...SIZES.map(([w, h]) => el("option", { value: `${w}x${h}` }, `${w} × ${h}`)));
    this.kind = el("select", { id: "room-kind" });
    this.roomSeed = el("input", { type: "number", min: 0, max: 2147483647, step: 1, value: 1, id: "room-seed" });
    this.made = el("p", { class: "advice", id: "room-made" });
    this.kept = "";
    this.lesson = el("p", { class: "advice", id: "lesson" }, "The scene has none.");
    this.agents = el("dl", { class: "values" });
    this.about = el("dl", { class: "values" });
    this.root = el(
      "div",
      {},
      section(
        "New room",
        el("label", { class: "line" }, el("span", {}, "kind"), this.kind),
        el("label", { class: "line" }, el("span", {}, "seed"), this.roomSeed),
        el("div", { class: "buttons" },
          button("Make", () => this.#make(), { kind: "primary make-room" }),
          button("Again", () => this.#again(), { kind: "again-room", title: "the room of the next seed" }),
          button("Keep", () => this.#keep(), { glyph: "save", kind: "keep-room" })),
        this.made,
      ),
      section(
        "Save as a scene file",
        el("label", { class: "line" }, el("span", {}, "name"), this.name),
        el("label", { class: "line" }, el("span", {}, "title"), this.sceneTitle),
        el("label", { class: "line" }, el("span", {}, "replace it"), this.overwrite),
        el("div", { class: "buttons" },
          button("Save", () => this.#save(), { glyph: "save", kind: "primary save" }),
          button("Download", () => this.#download(), { kind: "download" })),
        this.saved,
      ),
      section(
        "Time and chance",
        el("label", { class: "line" }, el("span", {}, "real-time factor"), this.factor),
        el("label", { class: "line" }, el("span", {}, "seed"), this.seed,
          button("Begin anew", () => app.try("reset", { seed: Number(this.seed.value) }))),
        el("div", { class: "buttons" },
          button("Randomise", () => this.#randomise(), { title: "Begin the scene anew, drawn at random", kind: "randomise" }),
          button("Keep it", () => this.#keepDrawn(), { title: "Save what was drawn as a scene", kind: "keep-drawn" })),
        el("label", { class: "line" }, el("span", {}, "picture here"), this.size),
      ),
      section(
        "Lessons",
        this.lesson,
        el("div", { class: "buttons" },
          button("Begin", () => app.try("start_lessons", {}), { title: "Begin with the first lesson", kind: "start-lessons" }),
          button("Stop", () => app.try("stop_lessons", {}), { title: "What is there stays", kind: "stop-lessons" })),
      ),
      section("Agents", this.agents),
      section("Simulator", this.about),
    );
  }

  /** Say which lesson the frame on the screen is of. */
  frame({ lesson }) {
    const told = lesson || "The scene has none.";
    if (this.lesson.textContent !== told) this.lesson.textContent = told;
  }

  update(scene) {
    if (!this.kind.options.length) this.#kinds();
    put(this.seed, scene.seed);
    put(this.factor, scene.real_time_factor);
    const lens = this.app.lens;
    put(this.size, `${lens.width}x${lens.height}`);
    this.agents.replaceChildren(
      ...pairs(scene.agents.map((agent) => [
        agent.name,
        `${agent.width} × ${agent.height}, ${agent.rate_hz ? `${fixed(agent.rate_hz, 0)} Hz` : "on request"}` +
          (agent.following ? `, follows ${agent.mover}` : ""),
      ])),
    );
    this.about.replaceChildren(...pairs([
      ["renderer", scene.renderer],
      ["objects", String(scene.instances.filter(({ is_part }) => !is_part).length)],
      ["mode", scene.mode],
    ]));
  }

  async #randomise() {
    const index = await this.app.try("randomise", {});
    if (index !== undefined) this.drawn = index;
  }

  /** Save what was drawn, under a name of its own unless one is typed. */
  async #keepDrawn() {
    const { scene, seed } = this.app.scene;
    if (!this.name.value.trim()) this.name.value = `${scene.replace(/[^A-Za-z0-9 _-]/g, "_").slice(0, 40)}_${seed}_${this.drawn ?? 0}`;
    await this.#save();
  }

  async #kinds() {
    if (this.asked) return;
    this.asked = true;
    const kinds = await this.app.try("room_kinds", {});
    this.asked = kinds !== undefined;
    if (kinds === undefined) return;
    this.kind.replaceChildren(...kinds.map(({ kind, title }) => el("option", { value: kind }, title)));
  }

  async #make() {
    const kind = this.kind.value, seed = Number(this.roomSeed.value);
    this.made.textContent = "The room is being made …";
    const made = await this.app.try("generate_room", { kind, seed });
    this.kept = made === undefined ? "" : `${kind}_${seed}`;
    this.made.textContent = made === undefined ? "" : `${made.scene} is this room's name.`;
  }

  #again() {
    this.roomSeed.value = String((Number(this.roomSeed.value) + 1) % 2147483648);
    return this.#make();
  }

  async #keep() {
    if (!this.kept || this.app.scene.scene !== `generated_${this.kept}`) {
      toast("Make a room first.");
      return;
    }
    const path = await this.app.try("save_scene", { name: this.kept, keep_models: true });
    if (path === undefined) return;
    this.made.textContent = `Kept: ${path}`;
    toast("Kept. It is in the list of scenes now.");
  }

  async #save() {
    const path = await this.app.try("save_scene", {
      name: this.name.value.trim(), overwrite: this.overwrite.checked, keep_models: true,
      ...(this.sceneTitle.value.trim() ? { title: this.sceneTitle.value.trim() } : {}),
    });
    if (path === undefined) return;
    this.saved.textContent = `Saved: ${path}`;
    toast("Saved. It is in the list of scenes now.");
  }

  async #download() {
    const text = await this.app.try("scene_text", {});
    if (text === undefined) return;
    const name = this.name.value.trim() || `${this.app.scene.scene}_edited`;
    download(`${name}.yaml`, new Blob([text], { type: "application/yaml" }));
  }
}
