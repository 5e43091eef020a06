// @ts-check
// What people do, as requests to the simulator and changes of the page's state.

import { download, toast, wordsOf } from "./dom.js";
import { agentOf, mayChange, moverOf, shownViews } from "./store.js";

/** @import {Commands, MoverNews, PlacedObject} from "./messages.js" */
/** @import {Link} from "./link.js" */
/** @import {Store} from "./store.js" */

/** @typedef {{ frame: number, u: number, v: number }} Pixel */

export class Actions {
  #store;
  #link;

  /**
   * @param {Store} store
   * @param {Link} link
   */
  constructor(store, link) {
    this.#store = store;
    this.#link = link;
  }

  /**
   * Ask; the promise fails with the simulator's words.
   * @template {keyof Commands} K
   * @param {K} what
   * @param {Commands[K]["values"]} values
   */
  ask(what, values) {
    return this.#link.ask(what, values);
  }

  /**
   * Ask; a refusal is shown, and gives undefined.
   * @template {keyof Commands} K
   * @param {K} what
   * @param {Commands[K]["values"]} values
   * @returns {Promise<Commands[K]["result"] | undefined>}
   */
  async try(what, values) {
    try {
      return await this.ask(what, values);
    } catch (error) {
      toast(wordsOf(error), "error");
      return undefined;
    }
  }

  // ---- what is shown

  /** Have the agent's frames sent, of the views that are shown. */
  watch() {
    const { agent, online } = this.#store.state;
    const views = shownViews(this.#store.state);
    if (online && agent && views[0]) this.try("watch", { agent, views });
  }

  /**
   * Show a view among the others, or no longer; the last one stays.
   * @param {string} view
   * @param {boolean} shown
   */
  chooseView(view, shown) {
    const { views, hello } = this.#store.state;
    const names = (hello?.views ?? []).map(({ name }) => name);
    const chosen = names.filter((name) => (name === view ? shown : views.chosen.includes(name)));
    const [first] = chosen;
    if (!first) return;
    this.#store.set({ views: { ...views, chosen, main: chosen.includes(views.main) ? views.main : first } });
  }

  /** @param {string} view */
  enlarge(view) {
    this.#store.set({ views: { ...this.#store.state.views, main: view } });
  }

  toggleAll() {
    const { views } = this.#store.state;
    this.#store.set({ views: { ...views, all: !views.all } });
  }

  /**
   * Have a picture saved as a file.
   * @param {"screenshot" | "sheet"} what
   */
  async save(what) {
    const view = this.#store.state.views.main;
    const file = await (what === "screenshot" ? this.try(what, { view }) : this.try(what, {}));
    if (file) download(file.name, file.blob);
  }

  // ---- objects

  /** @param {number} chosen */
  select(chosen) {
    const { instances, tab } = this.#store.state;
    const instance = instances.get(chosen);
    const id = instance?.is_part ? instance.parent : chosen; // a part is edited with its body
    this.#store.set({ selected: id, object: null, tab: id ? "Object" : tab });
    this.try("select", { obj: id });
  }

  /**
   * Put an object where a pixel is seen, or ahead.
   * @param {string} asset
   * @param {Pixel | null} at
   */
  async spawn(asset, at = null) {
    const { frame } = this.#store.state;
    if (!frame) return;
    const middle = { frame: frame.number, u: Math.floor(frame.width / 2), v: Math.floor(0.62 * frame.height) };
    const made = await this.try("spawn", { asset, ...(at ?? middle) });
    if (!made) return;
    tellHeld(made);
    this.select(made.id);
  }

  /**
   * Put a robot ahead.
   * @param {string} file
   */
  async addRobot(file) {
    const { frame } = this.#store.state;
    if (!frame) return;
    const middle = { frame: frame.number, u: Math.floor(frame.width / 2), v: Math.floor(0.62 * frame.height) };
    const made = await this.try("add_robot", { file, ...middle });
    if (made) this.select(made);
  }

  /** @param {Pixel} at */
  async place(at) {
    this.endPlacing();
    const placed = await this.try("place", { obj: this.#store.state.selected, ...at });
    if (placed) tellHeld(placed);
  }

  placeNext() {
    this.#store.set({ placing: true });
    toast("Click where it shall stand.");
  }

  endPlacing() {
    this.#store.set({ placing: false });
  }

  async deleteSelected() {
    const id = this.#store.state.selected;
    if (!id) return;
    this.select(0);
    await this.try("despawn_object", { obj: id });
  }

  /**
   * Undo the last change, or do it again; what has come back is selected.
   * @param {"undo" | "redo"} which
   */
  async goBack(which) {
    const step = await this.try(which, {});
    if (!step) return;
    toast(`${which === "undo" ? "Undone" : "Done again"}: ${step.what}`);
    const { selected, instances } = this.#store.state;
    if (step.id) this.select(step.id);
    else if (selected && !instances.has(selected)) this.select(0);
  }

  // ---- movers and agents

  /** Give the mover to the waypoints, or to the keys. */
  async toggleDriver() {
    const mover = moverOf(this.#store.state);
    if (!mover || !mayChange(this.#store.state)) return;
    const before = mover.controller;
    const controller = before === "waypoint" ? "rigidbody" : "waypoint";
    // Known at once, so that another Tab before the scene's news gives it back.
    this.#setMover(mover.name, { controller });
    try {
      await this.ask("set_mover_controller", { mover: mover.name, controller });
    } catch (error) {
      this.#setMover(mover.name, { controller: before });
      toast(wordsOf(error), "error");
    }
  }

  /**
   * @param {string} name
   * @param {Partial<MoverNews>} changes
   */
  #setMover(name, changes) {
    const { scene } = this.#store.state;
    if (!scene) return;
    const movers = scene.movers.map((mover) => (mover.name === name ? { ...mover, ...changes } : mover));
    this.#store.set({ scene: { ...scene, movers } });
  }

  /** Turning by hand ends what an agent looks at, as turning a mover ends what the mover faces. */
  releaseLook() {
    const { scene, agent } = this.#store.state;
    const own = agentOf(this.#store.state);
    if (!scene || !own?.look_at || !own.following) return;
    const agents = scene.agents.map((one) => (one === own ? { ...one, look_at: null } : one));
    this.#store.set({ scene: { ...scene, agents } });
    this.try("set_look_at", { agent, obj: null });
  }
}

/** @param {PlacedObject} placed */
function tellHeld({ name, held }) {
  if (held) toast(`${name} is held where it stands: physics knows only the hull of what is around it.`);
}
