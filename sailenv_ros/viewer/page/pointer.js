// @ts-check
// The pointer over the pictures: values under it, clicks, drags, and what is dropped there; its keys.

import { $, around, el, isTyping } from "./dom.js";
import { mayChange } from "./store.js";
import { depthWords, flowWords } from "./values.js";

/** @import {Actions} from "./actions.js" */
/** @import {PixelValues} from "./messages.js" */
/** @import {PlaceInView, Stage} from "./stage.js" */
/** @import {Store} from "./store.js" */
/** @import {Walker} from "./walk.js" */

const CLICK_PX = 5;

/** @typedef {{ x: number, y: number, pixel: PlaceInView | null }} Pointed */

export class Pointer {
  #store;
  #actions;
  #stage;
  #walker;
  #tip = $("probe-tip");
  /** @type {Pointed | null} */
  #at = null;
  #asking = false;

  /**
   * @param {Store} store
   * @param {Actions} actions
   * @param {Stage} stage
   * @param {Walker} walker
   */
  constructor(store, actions, stage, walker) {
    this.#store = store;
    this.#actions = actions;
    this.#stage = stage;
    this.#walker = walker;
    this.#press(stage.tiles);
    this.#drop(stage.tiles);
    addEventListener("keydown", (event) => this.#key(event));
    store.on(["frame"], () => this.#probe());
  }

  /** @param {HTMLElement} tiles */
  #press(tiles) {
    /** @type {(Pointed & { dragged: boolean }) | null} */
    let from = null;
    let last = { x: 0, y: 0 };
    tiles.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || document.pointerLockElement) return;
      this.#stage.focus();
      from = { ...this.#placeOf(event), dragged: false };
      last = from;
      tiles.setPointerCapture(event.pointerId);
    });
    tiles.addEventListener("pointermove", (event) => {
      this.#at = this.#placeOf(event);
      if (!from) {
        this.#probe();
        return;
      }
      const far = Math.hypot(event.clientX - from.x, event.clientY - from.y) > CLICK_PX;
      from.dragged = from.dragged || far;
      const { main } = this.#store.state.views;
      if (from.dragged && from.pixel?.view === main) this.#drag(event.clientX - last.x, event.clientY - last.y);
      last = this.#at;
    });
    tiles.addEventListener("pointerup", () => {
      if (from && !from.dragged && from.pixel) this.#click(from.pixel);
      from = null;
    });
    tiles.addEventListener("pointercancel", () => {
      from = null;
    });
    tiles.addEventListener("pointerleave", () => {
      this.#at = null;
      this.#tip.hidden = true;
      this.#store.set({ pixel: null });
    });
  }

  /** @param {HTMLElement} tiles */
  #drop(tiles) {
    tiles.addEventListener("dragover", (event) => event.preventDefault());
    tiles.addEventListener("drop", (event) => {
      event.preventDefault();
      const asset = event.dataTransfer?.getData("text/plain");
      const pixel = this.#stage.pixel(event);
      if (asset && pixel) this.#actions.spawn(asset, { frame: pixel.frame, u: pixel.u, v: pixel.v });
    });
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (isTyping(event.target)) {
      if (event.code === "Escape" && event.target instanceof HTMLElement) event.target.blur();
      return;
    }
    const { placing, selected } = this.#store.state;
    if (event.key.toLowerCase() === "z" && mayChange(this.#store.state)) {
      event.preventDefault();
      this.#actions.goBack(event.shiftKey ? "redo" : "undo");
    }
    if (event.code === "Delete" || event.code === "Backspace") this.#actions.deleteSelected();
    if (event.code === "Escape") {
      if (placing) this.#actions.endPlacing();
      else if (selected) this.#actions.select(0);
    }
  }

  /** @param {MouseEvent} event @returns {Pointed} */
  #placeOf(event) {
    return { x: event.clientX, y: event.clientY, pixel: around(event, ".tile") && this.#stage.pixel(event) };
  }

  /** Turn so that what was under the pointer stays there. @param {number} across @param {number} down */
  #drag(across, down) {
    const degrees = this.#store.state.lens.fov_deg / this.#stage.mainHeight;
    this.#walker.turn(across * degrees, -down * degrees);
  }

  /** @param {PlaceInView} place */
  async #click({ view, frame, u, v }) {
    const { placing, selected, views } = this.#store.state;
    if (placing && selected) {
      await this.#actions.place({ frame, u, v });
      return;
    }
    if (view !== views.main) {
      this.#actions.enlarge(view);
      return;
    }
    const values = await this.#actions.try("probe", { frame, u, v });
    if (values) this.#actions.select(values.instance_id ?? 0);
  }

  /**
   * Show the values under the pointer, of the frame that is shown. One question at a time: what
   * came while one was on its way is asked next, as nothing else may happen where time stands.
   */
  async #probe() {
    if (this.#asking) return;
    this.#asking = true;
    for (let question = this.#question(), asked = ""; question && JSON.stringify(question) !== asked; ) {
      asked = JSON.stringify(question);
      try {
        const values = await this.#actions.ask("probe", question);
        if (this.#at) this.#show(values, this.#at);
      } catch {
        // The frame is no longer kept, and a newer one is there; or the connection was lost.
      }
      question = this.#question();
    }
    this.#asking = false;
  }

  /** @returns {{ frame: number, u: number, v: number } | null} */
  #question() {
    const { frame } = this.#store.state;
    if (!this.#at?.pixel || !frame || document.pointerLockElement) return null;
    return { frame: frame.number, u: this.#at.pixel.u, v: this.#at.pixel.v };
  }

  /** @param {PixelValues} values @param {Pointed} at */
  #show(values, at) {
    const box = this.#stage.root.getBoundingClientRect();
    this.#tip.replaceChildren(
      el("strong", {}, values.instance_id ? values.instance : values.category || "nothing"),
      el("span", {}, values.instance_id ? values.category : ""),
      el("span", {}, depthWords(values.depth ?? null)),
      el("span", {}, `flow ${flowWords(values.flow ?? null)}`),
    );
    this.#tip.hidden = false;
    const { offsetWidth: width, offsetHeight: height } = this.#tip;
    const left = at.x - box.left;
    this.#tip.style.left = `${left + 16 + width > box.width ? left - width - 12 : left + 16}px`;
    this.#tip.style.top = `${Math.min(at.y - box.top + 16, box.height - height - 4)}px`;
    this.#store.set({ pixel: values });
  }
}
