// @ts-check
// The scene as a whole: save it, begin it with another seed, how fast time runs, who is there.

import { CaptureSection } from "./capture_section.js";
import { button, download, el, fixed, line, options, pairs, put, say, section, toast } from "./dom.js";

/** @import {Actions} from "./actions.js" */
/** @import {State, Store} from "./store.js" */

const SIZES = [
  { width: 320, height: 240 }, { width: 640, height: 480 }, { width: 800, height: 450 }, { width: 1280, height: 720 },
];

/** Formats by their names, and programs that open them. */
const FORMATS = [
  ["glb", "Blender, glTF"], ["usdz", "OpenUSD in one file"], ["usda", "OpenUSD as text"],
  ["xml", "MuJoCo"], ["sdf", "Gazebo"],
];

export class ScenePanel {
  title = "Scene";

  #store;
  #actions;
  #name;
  #sceneTitle;
  #overwrite;
  #saved;
  #format;
  #lit;
  #exported;
  #seed;
  #factor;
  #size;
  #kind;
  #roomSeed;
  #made;
  #lesson;
  #agents;
  #about;
  #kept = "";
  #drawn = 0;
  #askedForKinds = false;

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    this.#name = el("input", { type: "text", id: "save-name", placeholder: "my_room", spellcheck: false });
    this.#sceneTitle = el("input", { type: "text", id: "save-title", placeholder: "as it was" });
    this.#overwrite = el("input", { type: "checkbox", id: "save-overwrite" });
    this.#saved = el("p", { class: "advice", id: "saved" });
    this.#format = el("select", { id: "export-format" },
      ...FORMATS.map(([name, programs]) => el("option", { value: name }, `${name}: ${programs}`)));
    this.#lit = el("input", { type: "checkbox", id: "export-lit", title: "glb and OpenUSD, of a room whose light is baked" });
    this.#exported = el("p", { class: "advice", id: "exported" });
    this.#seed = el("input", { type: "number", min: 0, step: 1, id: "seed" });
    this.#factor = el("input", {
      type: "number", min: 0.1, max: 10, step: 0.1, id: "factor",
      on: { change: () => actions.try("set_real_time_factor", { factor: Number(this.#factor.value) }) },
    });
    this.#size = el("select", {
      id: "size",
      on: {
        change: () => {
          const size = SIZES.find((one) => nameOf(one) === this.#size.value);
          if (!size) return;
          const lens = { ...store.state.lens, ...size };
          store.set({ lens });
          actions.try("lens", lens);
        },
      },
    }, ...SIZES.map((size) => el("option", { value: nameOf(size) }, `${size.width} × ${size.height}`)));
    this.#kind = el("select", { id: "room-kind" });
    this.#roomSeed = el("input", { type: "number", min: 0, max: 2147483647, step: 1, value: 1, id: "room-seed" });
    this.#made = el("p", { class: "advice", id: "room-made" });
    this.#lesson = el("p", { class: "advice", id: "lesson" }, "The scene has none.");
    this.#agents = el("dl", { class: "values" });
    this.#about = el("dl", { class: "values" });
    this.root = el(
      "div",
      {},
      section(
        "New room",
        line("kind", this.#kind),
        line("seed", this.#roomSeed),
        el("div", { class: "buttons" },
          button("Make", () => this.#make(), { kind: "primary make-room" }),
          button("Again", () => this.#again(), { kind: "again-room", title: "the room of the next seed" }),
          button("Keep", () => this.#keep(), { glyph: "save", kind: "keep-room" })),
        this.#made,
      ),
      section(
        "Save as a scene file",
        line("name", this.#name),
        line("title", this.#sceneTitle),
        line("replace it", this.#overwrite),
        el("div", { class: "buttons" },
          button("Save", () => this.#save(), { glyph: "save", kind: "primary save" }),
          button("Download", () => this.#download(), { kind: "download" })),
        this.#saved,
      ),
      section(
        "Export for other programs",
        line("format", this.#format),
        line("baked light", this.#lit),
        el("div", { class: "buttons" },
          button("Download", () => this.#export(), { kind: "export", title: "The scene as it is now" })),
        this.#exported,
      ),
      new CaptureSection(store, actions).root,
      section(
        "Time and chance",
        line("real-time factor", this.#factor),
        line("seed", this.#seed,
          button("Begin anew", () => actions.try("reset", { seed: Number(this.#seed.value) }))),
        el("div", { class: "buttons" },
          button("Randomise", () => this.#randomise(), { title: "Begin the scene anew, drawn at random", kind: "randomise" }),
          button("Keep it", () => this.#keepDrawn(), { title: "Save what was drawn as a scene", kind: "keep-drawn" })),
        line("picture here", this.#size),
      ),
      section(
        "Lessons",
        this.#lesson,
        el("div", { class: "buttons" },
          button("Begin", () => actions.try("start_lessons", {}), { title: "Begin with the first lesson", kind: "start-lessons" }),
          button("Stop", () => actions.try("stop_lessons", {}), { title: "What is there stays", kind: "stop-lessons" })),
      ),
      section("Agents", this.#agents),
      section("Simulator", this.#about),
    );
    store.on(["scene", "lens"], (state) => this.#show(state));
    // Which lesson the frame on the screen is of.
    store.on(["frame"], ({ frame }) => say(this.#lesson, frame?.lesson || "The scene has none."));
  }

  /** @param {Readonly<State>} state */
  #show({ scene, lens }) {
    if (!scene) return;
    this.#kinds();
    put(this.#seed, scene.seed);
    put(this.#factor, scene.real_time_factor);
    put(this.#size, nameOf(lens));
    this.#agents.replaceChildren(
      ...pairs(scene.agents.map((agent) => [
        agent.name,
        `${agent.width} × ${agent.height}, ${agent.rate_hz ? `${fixed(agent.rate_hz, 0)} Hz` : "on request"}` +
          (agent.following ? `, follows ${agent.mover}` : ""),
      ])),
    );
    this.#about.replaceChildren(...pairs([
      ["renderer", scene.renderer],
      ["objects", String(scene.instances.filter(({ is_part }) => !is_part).length)],
      ["mode", scene.mode],
    ]));
  }

  async #randomise() {
    const index = await this.#actions.try("randomise", {});
    if (index !== undefined) this.#drawn = index;
  }

  /** Save what was drawn, under a name of its own unless one is typed. */
  async #keepDrawn() {
    const { scene } = this.#store.state;
    if (!scene) return;
    if (!this.#name.value.trim()) this.#name.value = `${scene.scene.replace(/[^A-Za-z0-9 _-]/g, "_").slice(0, 40)}_${scene.seed}_${this.#drawn}`;
    await this.#save();
  }

  async #kinds() {
    if (this.#askedForKinds) return;
    this.#askedForKinds = true;
    const kinds = await this.#actions.try("room_kinds", {});
    this.#askedForKinds = kinds !== undefined;
    if (kinds === undefined) return;
    options(this.#kind, kinds.map(({ kind, title }) => ({ value: kind, words: title })));
  }

  async #make() {
    const kind = this.#kind.value, seed = Number(this.#roomSeed.value);
    this.#made.textContent = "The room is being made …";
    const made = await this.#actions.try("generate_room", { kind, seed });
    this.#kept = made === undefined ? "" : `${kind}_${seed}`;
    this.#made.textContent = made === undefined ? "" : `${made.scene} is this room's name.`;
  }

  #again() {
    this.#roomSeed.value = String((Number(this.#roomSeed.value) + 1) % 2147483648);
    return this.#make();
  }

  async #keep() {
    if (!this.#kept || this.#store.state.scene?.scene !== `generated_${this.#kept}`) {
      toast("Make a room first.");
      return;
    }
    const path = await this.#actions.try("save_scene", { name: this.#kept, keep_models: true });
    if (path === undefined) return;
    this.#made.textContent = `Kept: ${path}`;
    toast("Kept. It is in the list of scenes now.");
  }

  async #save() {
    const path = await this.#actions.try("save_scene", {
      name: this.#name.value.trim(), overwrite: this.#overwrite.checked, keep_models: true,
      ...(this.#sceneTitle.value.trim() ? { title: this.#sceneTitle.value.trim() } : {}),
    });
    if (path === undefined) return;
    this.#saved.textContent = `Saved: ${path}`;
    toast("Saved. It is in the list of scenes now.");
  }

  async #export() {
    const format = this.#format.value;
    say(this.#exported, "being written …");
    try {
      const asked = new URLSearchParams(location.search);
      if (this.#lit.checked) asked.set("light", "baked");
      const answer = await fetch(`export/${format}?${asked}`);
      if (!answer.ok) throw new Error(await answer.text());
      const told = answer.headers.get("Content-Disposition") ?? "";
      const name = /filename="([^"]+)"/.exec(told)?.[1] ?? `scene.${format}`;
      const data = await answer.blob();
      download(name, data);
      say(this.#exported, `${name}, ${(data.size / 1e6).toFixed(1)} MB`);
    } catch (problem) {
      say(this.#exported, String(problem instanceof Error ? problem.message : problem));
    }
  }

  async #download() {
    const text = await this.#actions.try("scene_text", {});
    if (text === undefined) return;
    const name = this.#name.value.trim() || `${this.#store.state.scene?.scene}_edited`;
    download(`${name}.yaml`, new Blob([text], { type: "application/yaml" }));
  }
}

/** The value of a size in the list. @param {{ width: number, height: number }} size */
const nameOf = ({ width, height }) => `${width}x${height}`;
