// Walking as in a game: keys, mouse, wheel, fingers; Tab gives the mover to the waypoints and back.

import { $, button, el, latest, toast } from "./dom.js";

const SPEED_M_S = 1.4;
const FAST = 2.5;
const REPEAT_MS = 66;
const DEG_PER_PX = 0.12;
const RAD = Math.PI / 180;

// Forward, left, up.
const KEYS = {
  KeyW: [1, 0, 0], ArrowUp: [1, 0, 0],
  KeyS: [-1, 0, 0], ArrowDown: [-1, 0, 0],
  KeyA: [0, 1, 0], ArrowLeft: [0, 1, 0],
  KeyD: [0, -1, 0], ArrowRight: [0, -1, 0],
  KeyE: [0, 0, 1], Space: [0, 0, 1],
  KeyQ: [0, 0, -1], KeyC: [0, 0, -1], ControlLeft: [0, 0, -1], ControlRight: [0, 0, -1],
};

export class Walker {
  constructor(app) {
    this.app = app;
    this.held = new Set();
    this.fast = false;
    this.timer = 0;
    this.turnBy = [0, 0];
    this.sendTurn = latest(async () => {
      const [yaw, pitch] = this.turnBy;
      this.turnBy = [0, 0];
      if (yaw || pitch) {
        await app.ask("turn_mover", {
          mover: this.mover, yaw_rad: within(yaw) * RAD, pitch_rad: within(pitch) * RAD,
        });
      }
    });
    this.sendLens = latest((lens) => app.ask("lens", lens));
    addEventListener("keydown", (event) => this.#keyDown(event));
    addEventListener("keyup", (event) => this.#keyUp(event));
    addEventListener("blur", () => this.#letGo());
    // Ctrl walks down and Ctrl+W closes the page: who does both is asked first.
    addEventListener("beforeunload", (event) => {
      if (this.held.has("ControlLeft") || this.held.has("ControlRight")) event.preventDefault();
    });
    document.addEventListener("pointerlockchange", () => this.#lockChanged());
    document.addEventListener("mousemove", (event) => {
      if (document.pointerLockElement) {
        this.turn(-event.movementX * DEG_PER_PX, event.movementY * DEG_PER_PX);
      }
    });
    $("stage").addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    $("walk").addEventListener("click", () => this.#lock());
    $("controller").addEventListener("click", () => this.toggle());
    this.#pads();
  }

  get mover() {
    return this.app.mover?.name ?? "";
  }

  get drives() {
    const { mover } = this.app;
    return this.app.control && mover?.controller === "rigidbody" && !mover.is_body;
  }

  async toggle() {
    const { mover } = this.app;
    if (!mover || !this.app.control) return;
    const before = mover.controller;
    // Known at once, so that another Tab before the scene's news gives it back.
    mover.controller = before === "waypoint" ? "rigidbody" : "waypoint";
    try {
      await this.app.ask("set_mover_controller", { mover: mover.name, controller: mover.controller });
    } catch (error) {
      mover.controller = before;
      toast(error.message, "error");
    }
    $("stage").focus();
  }

  /** Turn by angles [deg]: to the left, down. */
  turn(yaw, pitch) {
    if (!this.#mayDrive()) return;
    this.app.look.release();
    this.turnBy[0] += yaw;
    this.turnBy[1] += pitch;
    this.sendTurn(true);
  }

  #mayDrive() {
    if (this.drives) return true;
    const now = performance.now();
    if (this.app.control && now - (this.warned ?? -1e9) > 4000) {
      this.warned = now;
      toast(this.app.mover?.is_body
        ? "The mover is a body, which forces move: it cannot be driven."
        : "The waypoints drive the camera. Press Tab to drive it yourself.");
    }
    return false;
  }

  #keyDown(event) {
    if (isTyping(event.target) || event.altKey || event.metaKey) return;
    if (event.code === "Tab") {
      if (event.shiftKey || event.target.closest?.("aside, header")) return;
      event.preventDefault();
      if (!event.repeat) this.toggle();
      return;
    }
    this.fast = event.shiftKey;
    if (!(event.code in KEYS)) return;
    if (event.target.closest?.("aside") && event.code.startsWith("Arrow")) return;
    if (event.target.closest?.("button") && event.code === "Space") return;
    event.preventDefault();
    if (event.repeat || !this.#mayDrive()) return;
    this.held.add(event.code);
    this.#move();
  }

  #keyUp(event) {
    this.fast = event.shiftKey;
    if (this.held.delete(event.code)) this.#move();
  }

  #letGo() {
    if (!this.held.size) return;
    this.held.clear();
    this.#move();
  }

  /** Tell how the keys want it to move, again and again while any is held. */
  #move() {
    clearTimeout(this.timer);
    const sum = [0, 0, 0];
    for (const code of this.held) KEYS[code].forEach((part, at) => (sum[at] += part));
    const length = Math.hypot(...sum) || 1;
    const speed = (SPEED_M_S * (this.fast ? FAST : 1)) / length;
    if (this.drives) {
      this.app.try("drive_mover", { mover: this.mover, linear_m_s: sum.map((part) => part * speed) });
    }
    if (this.held.size) this.timer = setTimeout(() => this.#move(), REPEAT_MS);
  }

  async #lock() {
    if (!this.app.mover) return;
    if (!this.drives && !this.app.mover.is_body) await this.toggle();
    try {
      await $("stage").requestPointerLock();
    } catch {
      toast("This browser does not lend the mouse; drag the picture instead.");
    }
    $("stage").focus();
  }

  #lockChanged() {
    const locked = document.pointerLockElement !== null;
    document.body.classList.toggle("locked", locked);
    $("hint").textContent = locked ? "Esc gives the mouse back" : this.app.hint;
  }

  #wheel(event) {
    if (!this.app.control || !this.app.ownAgent) return;
    event.preventDefault();
    const lens = this.app.lens;
    const fov = Math.min(110, Math.max(15, lens.fov_deg * Math.exp(event.deltaY * 0.0008)));
    this.app.lens = { ...lens, fov_deg: Number(fov.toFixed(2)) };
    this.sendLens(this.app.lens);
  }

  /** Pads to walk by where there are only fingers. */
  #pads() {
    const pad = (words, code) => {
      const made = button(words, () => {}, { kind: "pad" });
      const press = (event) => {
        event.preventDefault();
        if (!this.#mayDrive()) return;
        this.held.add(code);
        this.#move();
      };
      const release = () => {
        if (this.held.delete(code)) this.#move();
      };
      made.addEventListener("pointerdown", press);
      for (const end of ["pointerup", "pointercancel", "pointerleave"]) made.addEventListener(end, release);
      return made;
    };
    $("pads").append(
      el("div", { class: "cross" }, pad("▲", "KeyW"), pad("◀", "KeyA"), pad("▼", "KeyS"), pad("▶", "KeyD")),
      el("div", { class: "lift" }, pad("+", "KeyE"), pad("–", "KeyQ")),
    );
    $("pads").hidden = !matchMedia("(pointer: coarse)").matches;
  }
}

export function isTyping(target) {
  const kind = target?.tagName;
  return kind === "TEXTAREA" || kind === "SELECT" || (kind === "INPUT" && target.type !== "checkbox");
}

const within = (degrees) => Math.max(-170, Math.min(170, degrees));
