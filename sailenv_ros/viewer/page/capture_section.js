// @ts-check
// A data set of what the shown agent sees from now on: captured while somebody walks, then saved.

import { button, el, line, options, say, section, wordsOf } from "./dom.js";
import { mayChange } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {State, Store} from "./store.js" */

export class CaptureSection {
  #store;
  #actions;
  #format;
  #frames;
  #rate;
  #begin;
  #stop;
  #told;
  #mine = false;

  /**
   * @param {Store} store
   * @param {Actions} actions
   */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
    this.#format = el("select", { id: "capture-format" });
    this.#frames = el("input", { type: "number", min: 1, max: 300, step: 1, value: 30, id: "capture-frames" });
    this.#rate = el("input", { type: "number", min: 0.1, max: 30, step: 0.1, value: 2, id: "capture-rate" });
    this.#begin = button("Capture", () => this.#capture(), { kind: "capture", title: "What the shown agent sees from now on, in a ZIP file" });
    this.#stop = button("Stop", () => actions.try("stop_capture", {}), { kind: "stop-capture", title: "Keep what was seen until now" });
    this.#told = el("p", { class: "advice", id: "captured" });
    this.root = section(
      "Data set for training",
      line("format", this.#format),
      line("frames", this.#frames),
      line("frames a second", this.#rate),
      el("div", { class: "buttons" }, this.#begin, this.#stop),
      this.#told,
    );
    this.#stop.disabled = true;
    store.on(["hello"], (state) => this.#offer(state));
    store.on(["stats"], (state) => this.#follow(state));
  }

  /** @param {Readonly<State>} state */
  #offer(state) {
    const formats = state.hello?.data_sets ?? [];
    this.root.hidden = !formats.length || !mayChange(state);
    options(this.#format, formats.map((name) => ({ value: name, words: name })));
  }

  /** Tell how far a capture is, whoever began it. @param {Readonly<State>} state */
  #follow({ stats }) {
    const capturing = stats?.capturing ?? "";
    this.#stop.disabled = !capturing;
    if (capturing) say(this.#told, this.#mine ? capturing : `another page: ${capturing}`);
  }

  async #capture() {
    this.#mine = this.#begin.disabled = true;
    say(this.#told, "beginning …");
    try {
      const made = await this.#actions.ask("capture_data_set", {
        format_name: this.#format.value,
        agent: this.#store.state.agent,
        frames: Number(this.#frames.value),
        rate_hz: Number(this.#rate.value),
      });
      el("a", { href: `captured/${made.key}${location.search}`, download: made.name }).click();
      say(this.#told, `${made.name}: ${made.frames} frames, ${(made.bytes / 1e6).toFixed(1)} MB`);
    } catch (problem) {
      say(this.#told, wordsOf(problem));
    } finally {
      this.#mine = this.#begin.disabled = false;
    }
  }
}
