// @ts-check
// What is seen now: the values under the pointer, the categories, how long a frame took.

import { el, fixed, keyed, line, pairs, say, section } from "./dom.js";
import { told } from "./values.js";

/** @import {Actions} from "./actions.js" */
/** @import {FrameHead} from "./messages.js" */
/** @import {State, Store} from "./store.js" */

/** @typedef {{ number: number, pixels: number, ids: number[] }} Seen */

const REFRESHED_MS = 250;
const UNLABELLED = 255;

/** @type {{ key: keyof State["draws"], label: string, title: string }[]} */
const OVERLAYS = [
  { key: "boxes", label: "boxes", title: "The box around what is visible of each object" },
  { key: "space", label: "boxes in space", title: "The oriented box of each object" },
  { key: "whole", label: "whole object", title: "The outline of the object under the pointer, also of what is hidden" },
  { key: "people", label: "people's joints", title: "The keypoints of people; hollow where something hides them" },
  { key: "circle", label: "image circle", title: "The border of what the lens sees" },
];

export class ViewPanel {
  title = "View";
  #store;
  #actions;
  #probe = el("dl", { class: "values", id: "probe" });
  #legend = el("div", { class: "legend", id: "legend" });
  #shown = el("div", { id: "shown-views" });
  #stages = el("div", { class: "stages", id: "stages" });
  #camera = el("dl", { class: "values", id: "camera" });
  #lens = el("dl", { class: "values", id: "lens" });
  #refreshed = 0;

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    const objects = el("div", { id: "object-overlay" }, ...OVERLAYS.map((overlay) => this.#overlayBox(overlay)));
    this.root = el(
      "div",
      {},
      section("Pixel", this.#probe),
      section("Views", this.#shown),
      section("Over the picture", objects),
      section("Seen now", this.#legend),
      section("Camera", this.#camera),
      section("Lens", this.#lens),
      section("Time of a frame", this.#stages),
    );
    this.#showPixel(store.state);
    store.on(["pixel", "hello"], (state) => this.#showPixel(state));
    store.on(["hello", "views"], (state) => this.#showViews(state));
    store.on(["frame"], (state) => this.#showFrame(state));
  }

  /** @param {OVERLAYS[number]} overlay */
  #overlayBox({ key, label, title }) {
    const box = el("input", {
      type: "checkbox", data: { draws: key },
      on: { change: () => this.#store.set({ draws: { ...this.#store.state.draws, [key]: box.checked } }) },
    });
    return el("label", { class: "line", title }, el("span", {}, label), box);
  }

  /** Offer a box for each view that the simulator can render, to show it or not. @param {Readonly<State>} state */
  #showViews({ hello }) {
    keyed(this.#shown, hello?.views ?? [], ({ name }) => name, ({ name, meaning }) => {
      const box = el("input", {
        type: "checkbox", data: { shows: name },
        on: {
          change: () => {
            this.#actions.chooseView(name, box.checked);
            box.checked = this.#store.state.views.chosen.includes(name); // the last one stays
          },
        },
      });
      const root = line(name, box);
      root.title = meaning;
      return { root, set: () => (box.checked = this.#store.state.views.chosen.includes(name)) };
    });
  }

  /** @param {Readonly<State>} state */
  #showPixel({ pixel, hello }) {
    this.#probe.replaceChildren(
      ...(pixel ? pairs(told(pixel, hello?.views ?? [])) : [el("dd", { class: "whole" }, "Point at a picture.")]),
    );
  }

  /** @param {Readonly<State>} state */
  #showFrame({ frame, tab }) {
    const now = performance.now();
    if (!frame || tab !== this.title || now - this.#refreshed < REFRESHED_MS) return;
    this.#refreshed = now;
    this.#showLegend(frame);
    this.#showCamera(frame);
    this.#showLens(frame);
    this.#showStages(frame.timings_ms);
  }

  /** @param {FrameHead} head */
  #showLegend(head) {
    // Rows change places: not while one is pressed, or the click would be lost.
    if (!head.visible || this.#legend.matches(":active")) return;
    /** @type {Map<number, Seen>} */
    const byCategory = new Map();
    for (const [id, pixels] of head.visible) {
      const number = this.#store.state.instances.get(id)?.category_id ?? UNLABELLED;
      const entry = byCategory.get(number) ?? { number, pixels: 0, ids: [] };
      entry.pixels += pixels;
      entry.ids.push(id);
      byCategory.set(number, entry);
    }
    const rows = [...byCategory.values()].sort((one, other) => other.pixels - one.pixels);
    keyed(this.#legend, rows, ({ number }) => String(number), () => this.#legendRow());
  }

  #legendRow() {
    const chip = el("span", { class: "chip" });
    const name = el("span", { class: "name" });
    const count = el("span", { class: "count" });
    const share = el("span", { class: "share" });
    let first = 0;
    const root = el("button", { class: "row", on: { click: () => this.#actions.select(first) } }, chip, name, count, share);
    /** @param {Seen} seen */
    const set = ({ number, pixels, ids }) => {
      const { scene, instances, frame } = this.#store.state;
      const category = scene?.categories.find(({ id }) => id === number);
      const total = frame ? frame.width * frame.height : 1;
      first = ids[0] ?? 0;
      root.title = ids.map((id) => instances.get(id)?.name ?? `#${id}`).join(", ");
      chip.style.background = category ? `rgb(${category.colour.join(" ")})` : "rgb(128 128 128)";
      say(name, category?.name ?? "unlabelled");
      say(count, ids.length > 1 ? `× ${ids.length}` : "");
      say(share, `${fixed((100 * pixels) / total, 1)} %`);
    };
    return { root, set };
  }

  /** @param {FrameHead} head */
  #showCamera(head) {
    this.#camera.replaceChildren(
      ...pairs([
        ["position", `${head.position.map((x) => fixed(x)).join(", ")} m`],
        ["pitch, yaw", `${fixed(head.rpy_deg[1], 1)}°, ${fixed(head.rpy_deg[2], 1)}°`],
        ["picture", `${head.width} × ${head.height}${head.fov_deg ? `, ${fixed(head.fov_deg, 1)}° high` : ""}`],
        ["frame", `${head.sequence} of ${head.agent}`],
      ]),
    );
  }

  /** @param {FrameHead} head */
  #showLens({ lens }) {
    const unit = lens.max_angle_deg === null ? "px/m" : "px"; // of parallel rays
    /** @type {[string, string][]} */
    const rows = [
      ["model", lens.model],
      ["fx, fy", `${fixed(lens.fx, 3)}, ${fixed(lens.fy, 3)} ${unit}`],
      ["cx, cy", `${fixed(lens.cx, 3)}, ${fixed(lens.cy, 3)} px`],
      ...lens.coefficients.map(([name, value]) => /** @type {[string, string]} */ ([name, String(value)])),
    ];
    if (lens.max_angle_deg !== null) rows.push(["sees up to", `${fixed(lens.max_angle_deg, 2)}° off the axis`]);
    this.#lens.replaceChildren(...pairs(rows));
  }

  /** @param {Record<string, number>} timings */
  #showStages(timings) {
    const whole = timings.render || 1;
    const parts = Object.entries(timings).filter(([name]) => name !== "render");
    const stages = [{ name: "whole", ms: whole, whole }, ...parts.map(([name, ms]) => ({ name, ms, whole }))];
    keyed(this.#stages, stages, ({ name }) => name, ({ name }) => {
      const bar = el("span", { class: "bar" });
      const share = el("span", { class: "share" });
      return {
        root: el("div", { class: "stage" },
          el("span", {}, name.replaceAll("_", " ")), el("span", { class: "track" }, bar), share),
        /** @param {{ ms: number, whole: number }} stage */
        set: ({ ms, whole }) => {
          bar.style.width = `${Math.min(100, (100 * ms) / whole)}%`;
          say(share, `${fixed(ms, 1)} ms`);
        },
      };
    });
  }
}
