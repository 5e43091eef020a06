// @ts-check
// Walking as in a game: keys, mouse, wheel, fingers; Tab gives the mover to the waypoints and back.

import { $, around, button, el, icon, isTyping, latest, toast } from "./dom.js";
import { drives, mayChange, moverOf, showsOwnAgent } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {Stage} from "./stage.js" */
/** @import {Lens, State, Store} from "./store.js" */

const HINT = "W A S D walk · drag to look · wheel zooms · Tab hands over";

const SPEED_M_S = 1.4;
const FAST = 2.5;
const REPEAT_MS = 66;
const DEG_PER_PX = 0.12;
const RAD = Math.PI / 180;

/** Forward, left, up. @type {Record<string, readonly [number, number, number]>} */
const KEYS = {
  KeyW: [1, 0, 0], ArrowUp: [1, 0, 0],
  KeyS: [-1, 0, 0], ArrowDown: [-1, 0, 0],
  KeyA: [0, 1, 0], ArrowLeft: [0, 1, 0],
  KeyD: [0, -1, 0], ArrowRight: [0, -1, 0],
  KeyE: [0, 0, 1], Space: [0, 0, 1],
  KeyQ: [0, 0, -1], KeyC: [0, 0, -1], ControlLeft: [0, 0, -1], ControlRight: [0, 0, -1],
};

export class Walker {
  #store;
  #actions;
  #stage;
  #controller = $("controller");
  #hint = $("hint");
  /** @type {Set<string>} */
  #held = new Set();
  #fast = false;
  #timer = 0;
  #warned = -Infinity;
  #turnBy = { yaw: 0, pitch: 0 };
  #sendTurn;
  /** @type {(lens: Lens) => void} */
  #sendLens;

  /**
   * @param {Store} store
   * @param {Actions} actions
   * @param {Stage} stage
   */
  constructor(store, actions, stage) {
    this.#store = store;
    this.#actions = actions;
    this.#stage = stage;
    this.#sendTurn = latest(async () => {
      const { yaw, pitch } = this.#turnBy;
      this.#turnBy = { yaw: 0, pitch: 0 };
      if (yaw || pitch) {
        await actions.ask("turn_mover", {
          mover: this.#mover, yaw_rad: within(yaw) * RAD, pitch_rad: within(pitch) * RAD,
        });
      }
    });
    this.#sendLens = latest((lens) => actions.ask("lens", lens));
    addEventListener("keydown", (event) => this.#keyDown(event));
    addEventListener("keyup", (event) => this.#keyUp(event));
    addEventListener("blur", () => this.#letGo());
    // Ctrl walks down and Ctrl+W closes the page: who does both is asked first.
    addEventListener("beforeunload", (event) => {
      if (this.#held.has("ControlLeft") || this.#held.has("ControlRight")) event.preventDefault();
    });
    document.addEventListener("pointerlockchange", () => this.#lockChanged());
    document.addEventListener("mousemove", (event) => {
      if (document.pointerLockElement) {
        this.turn(-event.movementX * DEG_PER_PX, event.movementY * DEG_PER_PX);
      }
    });
    stage.root.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    $("walk").append(icon("eye"), "Walk");
    $("walk").addEventListener("click", () => this.#lock());
    this.#controller.addEventListener("click", () => this.#toggle());
    this.#hint.textContent = HINT;
    this.#pads();
    store.on(["scene", "agent"], (state) => this.#showDriver(state));
  }

  get #mover() {
    return moverOf(this.#store.state)?.name ?? "";
  }

  get #drives() {
    return drives(this.#store.state);
  }

  /** @param {Readonly<State>} state */
  #showDriver(state) {
    const mover = moverOf(state);
    const walks = mover?.controller === "rigidbody";
    const driver = mover?.is_body ? "Forces drive" : walks ? "You drive" : "Waypoints drive";
    if (this.#controller.textContent !== driver) {
      this.#controller.replaceChildren(icon(walks ? "keys" : "route"), driver);
    }
    this.#controller.classList.toggle("on", walks);
  }

  async #toggle() {
    await this.#actions.toggleDriver();
    this.#stage.root.focus();
  }

  /** Turn by angles [deg]: to the left, down. @param {number} yaw @param {number} pitch */
  turn(yaw, pitch) {
    if (!this.#mayDrive()) return;
    this.#actions.releaseLook();
    this.#turnBy.yaw += yaw;
    this.#turnBy.pitch += pitch;
    this.#sendTurn(true);
  }

  #mayDrive() {
    if (this.#drives) return true;
    const now = performance.now();
    if (mayChange(this.#store.state) && now - this.#warned > 4000) {
      this.#warned = now;
      toast(moverOf(this.#store.state)?.is_body
        ? "The mover is a body, which forces move: it cannot be driven."
        : "The waypoints drive the camera. Press Tab to drive it yourself.");
    }
    return false;
  }

  /** @param {KeyboardEvent} event */
  #keyDown(event) {
    if (isTyping(event.target) || event.altKey || event.metaKey) return;
    if (event.code === "Tab") {
      if (event.shiftKey || around(event, "aside, header")) return;
      event.preventDefault();
      if (!event.repeat) this.#toggle();
      return;
    }
    this.#fast = event.shiftKey;
    if (!(event.code in KEYS)) return;
    if (around(event, "aside") && event.code.startsWith("Arrow")) return;
    if (around(event, "button") && event.code === "Space") return;
    event.preventDefault();
    if (event.repeat || !this.#mayDrive()) return;
    this.#held.add(event.code);
    this.#move();
  }

  /** @param {KeyboardEvent} event */
  #keyUp(event) {
    this.#fast = event.shiftKey;
    if (this.#held.delete(event.code)) this.#move();
  }

  #letGo() {
    if (!this.#held.size) return;
    this.#held.clear();
    this.#move();
  }

  /** Tell how the keys want it to move, again and again while any is held: else it stops by itself. */
  #move() {
    clearTimeout(this.#timer);
    const sum = [0, 0, 0];
    for (const code of this.#held) KEYS[code]?.forEach((part, at) => (sum[at] = (sum[at] ?? 0) + part));
    const length = Math.hypot(...sum) || 1;
    const speed = (SPEED_M_S * (this.#fast ? FAST : 1)) / length;
    if (this.#drives) {
      this.#actions.try("drive_mover", { mover: this.#mover, linear_m_s: sum.map((part) => part * speed) });
    }
    if (this.#held.size) this.#timer = setTimeout(() => this.#move(), REPEAT_MS);
  }

  async #lock() {
    const mover = moverOf(this.#store.state);
    if (!mover) return;
    if (!this.#drives && !mover.is_body) await this.#toggle();
    try {
      await this.#stage.root.requestPointerLock();
    } catch {
      toast("This browser does not lend the mouse; drag the picture instead.");
    }
    this.#stage.root.focus();
  }

  #lockChanged() {
    const locked = document.pointerLockElement !== null;
    document.body.classList.toggle("locked", locked);
    this.#hint.textContent = locked ? "Esc gives the mouse back" : HINT;
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    const { state } = this.#store;
    if (!mayChange(state) || !showsOwnAgent(state)) return;
    event.preventDefault();
    const fov = Math.min(110, Math.max(15, state.lens.fov_deg * Math.exp(event.deltaY * 0.0008)));
    const lens = { ...state.lens, fov_deg: Number(fov.toFixed(2)) };
    this.#store.set({ lens });
    this.#sendLens(lens);
  }

  /** Pads to walk by where there are only fingers. */
  #pads() {
    /** @type {(words: string, code: string) => HTMLElement} */
    const pad = (words, code) => {
      const made = button(words, () => {}, { kind: "pad" });
      /** @param {Event} event */
      const press = (event) => {
        event.preventDefault();
        if (!this.#mayDrive()) return;
        this.#held.add(code);
        this.#move();
      };
      const release = () => {
        if (this.#held.delete(code)) this.#move();
      };
      made.addEventListener("pointerdown", press);
      for (const end of ["pointerup", "pointercancel", "pointerleave"]) made.addEventListener(end, release);
      return made;
    };
    const pads = $("pads");
    pads.append(
      el("div", { class: "cross" }, pad("▲", "KeyW"), pad("◀", "KeyA"), pad("▼", "KeyS"), pad("▶", "KeyD")),
      el("div", { class: "lift" }, pad("+", "KeyE"), pad("–", "KeyQ")),
    );
    pads.hidden = !matchMedia("(pointer: coarse)").matches;
  }
}

/** @param {number} degrees */
const within = (degrees) => Math.max(-170, Math.min(170, degrees));
