// The page as a whole: what the simulator tells, to the parts; what people do, to the simulator.

import { AddPanel } from "./add_panel.js";
import { $, download, el, fixed, icon, put, toast } from "./dom.js";
import { LightPanel } from "./light_panel.js";
import { Link } from "./link.js";
import { LookSelect } from "./look_select.js";
import { ObjectPanel } from "./object_panel.js";
import { PathPanel } from "./path_panel.js";
import { PicturePanel } from "./picture_panel.js";
import { RoomPanel } from "./room_panel.js";
import { ScenePanel } from "./scene_panel.js";
import { Stage } from "./stage.js";
import { ViewPanel, depthWords, flowWords } from "./view_panel.js";
import { Walker, isTyping } from "./walk.js";

const CLICK_PX = 5;

class App {
  hello = null;
  scene = null;
  control = false;
  instances = new Map();
  categories = new Map();
  agent = "";
  selected = 0;
  lens = { width: 640, height: 480, fov_deg: 60 };
  hint = "W A S D walk · drag to look · wheel zooms · Tab hands over";
  #panels = [];
  #times = [];
  #begun = performance.now();
  #placing = false;
  #pointer = null;
  #pointed = 0;

  constructor() {
    this.link = new Link();
    this.stage = new Stage({
      onViews: () => this.#watch(),
      onShown: (head) => this.#shown(head),
    });
    this.view = new ViewPanel(this);
    this.object = new ObjectPanel(this);
    this.path = new PathPanel(this);
    this.picture = new PicturePanel(this);
    this.#panels = [
      this.view, this.object, new AddPanel(this), new RoomPanel(this), new LightPanel(this), this.picture, this.path,
      new ScenePanel(this),
    ];
    this.#tabs();
    this.#bar();
    this.walker = new Walker(this);
    this.look = new LookSelect(this, $("look-at"));
    this.#pointing();
    const on = (type, listener) => this.link.addEventListener(type, ({ detail }) => listener(detail));
    on("hello", ({ message }) => this.#greeted(message));
    on("scene", ({ message }) => this.#told(message));
    on("stats", ({ message }) => this.#counted(message));
    on("frame", ({ message, body }) => this.stage.show(message, body));
    on("watch_ended", ({ message }) => this.#lost(message.why));
    on("offline", () => ($("offline").hidden = false));
    this.link.connect();
  }

  get mover() {
    const agent = this.scene?.agents.find(({ name }) => name === this.agent);
    return this.scene?.movers.find(({ name }) => name === agent?.mover) ?? this.scene?.movers[0];
  }

  get ownAgent() {
    return this.agent === this.hello?.debug_agent;
  }

  ask(what, values) {
    return this.link.ask(what, values);
  }

  /** Ask; a refusal is shown, and gives undefined. */
  async try(what, values = {}) {
    try {
      return await this.ask(what, values);
    } catch (error) {
      toast(error.message, "error");
      return undefined;
    }
  }

  // ---- what the simulator tells

  #greeted(hello) {
    this.hello = hello;
    this.control = hello.control;
    $("offline").hidden = true;
    $("watching-only").hidden = hello.control;
    document.body.classList.toggle("watching", !hello.control);
    this.agent = this.agent || hello.debug_agent;
    this.stage.offer(hello.views);
    this.view.offer(hello.views);
    this.#watch();
    if (this.selected) this.select(this.selected);
  }

  #told(scene) {
    const other = this.scene?.epoch !== scene.epoch;
    this.scene = scene;
    this.instances = new Map(scene.instances.map((instance) => [instance.id, instance]));
    this.categories = new Map(scene.categories.map((category) => [category.id, category]));
    document.title = `${scene.scene} – SAILenv`;
    document.body.dataset.scene = scene.scene;
    document.body.dataset.epoch = scene.epoch;
    options($("scene"), scene.scenes.includes(scene.scene) ? scene.scenes : [scene.scene, ...scene.scenes], scene.scene);
    const agents = scene.agents.map(({ name }) => name);
    options($("agent"), [...new Set([this.hello.debug_agent, ...agents])], this.agent);
    const own = scene.agents.find(({ name }) => name === this.hello.debug_agent);
    if (own) this.lens = { width: own.width, height: own.height, fov_deg: own.fov_deg };
    const stands = scene.paused || scene.mode === "lockstep";
    glyph($("play"), scene.paused ? "play" : "pause");
    $("play").title = scene.paused ? "Let time run" : "Pause time";
    $("play").disabled = scene.mode === "lockstep";
    $("step").disabled = !stands;
    this.look.update();
    const walks = this.mover?.controller === "rigidbody";
    const driver = this.mover?.is_body ? "Forces drive" : walks ? "You drive" : "Waypoints drive";
    $("controller").replaceChildren(icon(walks ? "keys" : "route"), driver);
    $("controller").classList.toggle("on", walks);
    document.body.dataset.controller = this.mover?.controller ?? "";
    if (other && this.selected) this.select(0);
    for (const panel of this.#panels) panel.update(scene);
    this.showPath();
  }

  #counted(stats) {
    $("clock").textContent = `${fixed(stats.time_s)} s`;
    $("pace").textContent = `× ${fixed(stats.real_time_factor)}`;
    $("building").textContent = $("building").title = stats.building;
    this.#waiting(stats.building);
    this.#history(stats.undo, stats.redo);
  }

  /** Say instead of the first picture what is waited for, and how long by now. */
  #waiting(building) {
    if (this.stage.head) return;
    const seconds = Math.round((performance.now() - this.#begun) / 1000);
    const what = building || "waiting for the first picture …";
    document.body.style.setProperty("--waiting", JSON.stringify(`${what} (${seconds} s)`));
  }

  #history(undo, redo) {
    for (const [id, words, what, key] of [["undo", "Undo", undo, "Z"], ["redo", "Do again", redo, "Shift+Z"]]) {
      $(id).disabled = !what || !this.control;
      $(id).title = `${words}${what ? `: ${what}` : ""} (${key})`;
    }
  }

  #lost(why) {
    toast(`No more pictures of ${this.agent}: ${why}`, "error");
    if (!this.ownAgent) {
      this.agent = this.hello.debug_agent;
      this.#watch();
    }
  }

  #watch() {
    if (!this.link.open) return;
    put($("agent"), this.agent);
    if (this.scene) {
      this.picture.update(this.scene);
      this.look.update();
    }
    this.try("watch", { agent: this.agent, views: this.stage.views });
  }

  #shown(head) {
    this.link.shown(head.number);
    document.body.dataset.frame = head.number;
    const now = performance.now();
    this.#times = this.#times.filter((time) => now - time < 2000);
    this.#times.push(now);
    const span = now - this.#times[0];
    if (span > 200) $("fps").textContent = `${fixed((1000 * (this.#times.length - 1)) / span, 1)} fps`;
    for (const panel of this.#panels) if (panel.root.isConnected) panel.frame(head);
    this.#probe();
    this.drawObjects();
  }

  /** Ask what is known of the objects of the frame that is shown, and draw it; one question at a time. */
  async drawObjects() {
    const { boxes, space, whole } = this.view.over;
    if (!boxes && !space && !whole) {
      if (this.stage.overlay) {
        this.stage.overlay = null;
        this.stage.drawOver();
      }
      return;
    }
    if (this.drawing || !this.stage.head) return;
    this.drawing = true;
    try {
      const pointed = whole && this.#pointer ? this.#pointed : 0;
      this.stage.overlay = await this.ask("objects", { frame: this.stage.head.number, boxes, space, whole: pointed });
      this.stage.drawOver();
    } catch {
      // The frame is no longer kept; the next one is asked for.
    }
    this.drawing = false;
  }

  // ---- panels, buttons

  #tabs() {
    const tabs = this.#panels.map((panel) =>
      el("button", { role: "tab", data: { tab: panel.title }, on: { click: () => this.open(panel) } }, panel.title),
    );
    $("tabs").append(...tabs);
    this.open(this.view);
  }

  open(panel) {
    $("panel").replaceChildren(panel.root);
    $("panel").scrollTop = 0;
    panel.opened?.();
    for (const tab of $("tabs").children) {
      tab.setAttribute("aria-selected", String(tab.dataset.tab === panel.title));
    }
    this.showPath();
  }

  #bar() {
    for (const [id, name] of [["play", "pause"], ["step", "step"], ["reset", "reset"], ["undo", "undo"], ["redo", "redo"], ["layout", "one"], ["screenshot", "camera"], ["sheet", "sheet"]]) {
      glyph($(id), name);
    }
    $("walk").append(icon("eye"), "Walk");
    $("hint").textContent = this.hint;
    const click = (id, act) => $(id).addEventListener("click", () => {
      act();
      $(id).blur();
    });
    click("play", () => this.try(this.scene.paused ? "resume" : "pause"));
    click("step", () => this.try("step", { count: 8 }));
    click("reset", () => this.try("reset"));
    click("undo", () => this.goBack("undo"));
    click("redo", () => this.goBack("redo"));
    click("layout", () => {
      this.stage.toggleAll();
      glyph($("layout"), this.stage.all ? "one" : "grid");
    });
    click("screenshot", () => this.#file("screenshot", { view: this.stage.main }));
    click("sheet", () => this.#file("sheet", {}));
    $("scene").addEventListener("change", () => {
      toast(`Loading ${$("scene").value} …`);
      this.try("change_scene", { scene: $("scene").value });
      $("scene").blur();
    });
    $("agent").addEventListener("change", () => {
      this.agent = $("agent").value;
      this.#watch();
      $("agent").blur();
    });
  }

  async #file(what, values) {
    const file = await this.try(what, values);
    if (file) download(file.name, file.blob);
  }

  showPath() {
    const shown = this.path?.root.isConnected || this.path?.show.checked;
    this.stage.waypoints = shown ? (this.mover?.waypoints ?? []) : [];
    this.stage.loop = this.mover?.loop ?? false;
    this.stage.drawOver();
  }

  // ---- objects

  select(chosen) {
    const instance = this.instances.get(chosen);
    const id = instance?.is_part ? instance.parent : chosen;  // a part is edited with its body
    this.selected = id;
    document.body.dataset.selected = id;
    this.try("select", { obj: id });
    this.object.show(id);
    if (id) this.open(this.object);
  }

  async spawn(asset, at = null) {
    const head = this.stage.head;
    if (!head) return;
    const middle = { frame: head.number, u: Math.floor(head.width / 2), v: Math.floor(0.62 * head.height) };
    const made = await this.try("spawn", { asset, ...(at ?? middle) });
    if (!made) return;
    this.#tellHeld(made);
    this.select(made.id);
  }

  async deleteSelected() {
    const id = this.selected;
    if (!id) return;
    this.select(0);
    await this.try("despawn_object", { obj: id });
  }

  /** Undo the last change, or do it again; what has come back is selected. */
  async goBack(which) {
    const step = await this.try(which);
    if (!step) return;
    toast(`${which === "undo" ? "Undone" : "Done again"}: ${step.what}`);
    if (step.id) this.select(step.id);
    else if (this.selected && !this.instances.has(this.selected)) this.select(0);
  }

  #tellHeld({ name, held }) {
    if (held) toast(`${name} is held where it stands: physics knows only the hull of what is around it.`);
  }

  placeNext() {
    this.#placing = true;
    document.body.classList.add("placing");
    toast("Click where it shall stand.");
  }

  #endPlacing() {
    this.#placing = false;
    document.body.classList.remove("placing");
  }

  // ---- pointer

  #pointing() {
    const tiles = $("tiles");
    let from = null;
    let last = null;
    tiles.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || document.pointerLockElement) return;
      $("stage").focus({ preventScroll: true });
      from = last = { x: event.clientX, y: event.clientY, pixel: this.stage.pixel(event), dragged: false };
      tiles.setPointerCapture(event.pointerId);
    });
    tiles.addEventListener("pointermove", (event) => {
      this.#pointer = { pixel: this.stage.pixel(event), x: event.clientX, y: event.clientY };
      if (!from) {
        this.#probe();
        return;
      }
      const far = Math.hypot(event.clientX - from.x, event.clientY - from.y) > CLICK_PX;
      from.dragged = from.dragged || far;
      if (from.dragged && from.pixel?.view === this.stage.main) this.#drag(event.clientX - last.x, event.clientY - last.y);
      last = { x: event.clientX, y: event.clientY };
    });
    tiles.addEventListener("pointerup", () => {
      if (from && !from.dragged && from.pixel) this.#click(from.pixel);
      from = null;
    });
    tiles.addEventListener("pointercancel", () => (from = null));
    tiles.addEventListener("pointerleave", () => {
      this.#pointer = null;
      $("probe-tip").hidden = true;
      this.view.showValues(null);
    });
    tiles.addEventListener("dragover", (event) => event.preventDefault());
    tiles.addEventListener("drop", (event) => {
      event.preventDefault();
      const asset = event.dataTransfer.getData("text/plain");
      const pixel = this.stage.pixel(event);
      if (asset && pixel) this.spawn(asset, { frame: pixel.frame, u: pixel.u, v: pixel.v });
    });
    addEventListener("keydown", (event) => {
      if (isTyping(event.target)) {
        if (event.code === "Escape") event.target.blur();
        return;
      }
      if (event.key.toLowerCase() === "z" && this.control) {
        event.preventDefault();
        this.goBack(event.shiftKey ? "redo" : "undo");
      }
      if (event.code === "Delete" || event.code === "Backspace") this.deleteSelected();
      if (event.code === "Escape") {
        if (this.#placing) this.#endPlacing();
        else if (this.selected) this.select(0);
      }
    });
  }

  /** Turn so that what was under the pointer stays there. */
  #drag(across, down) {
    const box = this.stage.tiles.get(this.stage.main).tile.getBoundingClientRect();
    const degrees = this.lens.fov_deg / box.height;
    this.walker.turn(across * degrees, -down * degrees);
  }

  async #click({ view, frame, u, v }) {
    if (this.#placing && this.selected) {
      this.#endPlacing();
      const placed = await this.try("place", { obj: this.selected, frame, u, v });
      if (placed) this.#tellHeld(placed);
      this.object.show(this.selected);
      return;
    }
    if (view !== this.stage.main) {
      this.stage.enlarge(view);
      return;
    }
    const values = await this.try("probe", { frame, u, v });
    if (values) this.select(values.instance_id ?? 0);
  }

  /** Show the values under the pointer, of the frame that is shown; one question at a time. */
  async #probe() {
    const pointer = this.#pointer;
    if (!pointer?.pixel || this.probing || document.pointerLockElement) return;
    this.probing = true;
    try {
      const { u, v } = pointer.pixel;
      const values = await this.ask("probe", { frame: this.stage.head.number, u, v });
      if (this.#pointer) this.#showProbe(values);
    } catch {
      // The frame is no longer kept; the next one is asked for.
    }
    this.probing = false;
  }

  #showProbe(values) {
    const pointed = values.instance_id ?? 0;
    if (pointed !== this.#pointed) {
      this.#pointed = pointed;
      this.drawObjects();
    }
    const tip = $("probe-tip");
    const place = this.#pointer;
    const box = $("stage").getBoundingClientRect();
    tip.replaceChildren(
      el("strong", {}, values.instance_id ? values.instance : values.category || "nothing"),
      el("span", {}, values.instance_id ? values.category : ""),
      el("span", {}, depthWords(values.depth)),
      el("span", {}, `flow ${flowWords(values.flow)}`),
    );
    tip.hidden = false;
    const left = place.x - box.left;
    tip.style.left = `${left + 16 + tip.offsetWidth > box.width ? left - tip.offsetWidth - 12 : left + 16}px`;
    tip.style.top = `${Math.min(place.y - box.top + 16, box.height - tip.offsetHeight - 4)}px`;
    this.view.showValues(values);
  }
}

function glyph(holder, name) {
  holder.replaceChildren(icon(name));
}

function options(select, names, chosen) {
  const known = [...select.options].map(({ value }) => value).join("\n");
  if (known !== names.join("\n")) select.replaceChildren(...names.map((name) => el("option", { value: name }, name)));
  put(select, chosen);
}

window.app = new App();
