// @ts-check
// The socket: requests with answers, frames, news; connects again by itself.

/** @import {Answer, Commands, FrameHead, Head, News, Shown} from "./messages.js" */

/** @typedef {{ give: (result: any) => void, refuse: (error: Error) => void }} Waiting */

/**
 * What is called when something comes by itself.
 *
 * @typedef {object} Listener
 * @property {(news: News) => void} news
 * @property {(head: FrameHead, pictures: ArrayBuffer) => void} frame
 * @property {() => void} offline
 */

export class Link {
  /** @type {WebSocket | null} */
  #socket = null;
  /** @type {Map<number | null, Waiting>} */
  #waiting = new Map();
  #next = 1;
  #pause = 500;
  #listener;

  /** @param {Listener} listener */
  constructor(listener) {
    this.#listener = listener;
  }

  connect() {
    const address = new URL("socket" + location.search, location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.#pause = 500;
    };
    socket.onmessage = (event) => this.#take(event.data);
    socket.onclose = () => {
      this.#listener.offline();
      for (const { refuse } of this.#waiting.values()) refuse(new Error("the connection was lost"));
      this.#waiting.clear();
      setTimeout(() => this.connect(), this.#pause);
      this.#pause = Math.min(5000, this.#pause * 1.6);
    };
    this.#socket = socket;
  }

  /**
   * Ask; the promise gives what is answered or fails with the simulator's words.
   * @template {keyof Commands} K
   * @param {K} what
   * @param {Commands[K]["values"]} values
   * @returns {Promise<Commands[K]["result"]>}
   */
  ask(what, values) {
    if (this.#socket?.readyState !== WebSocket.OPEN) {
      return Promise.reject(new Error("there is no connection to the simulator"));
    }
    const id = this.#next++;
    const text = JSON.stringify({ ...values, do: what, id });
    return new Promise((give, refuse) => {
      this.#waiting.set(id, { give, refuse });
      this.#socket?.send(text);
    });
  }

  /** @param {number} number */
  shown(number) {
    /** @type {Shown} */
    const message = { do: "shown", number };
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  /** @param {string | ArrayBuffer} data */
  #take(data) {
    if (typeof data === "string") {
      this.#takeText(JSON.parse(data));
      return;
    }
    const size = new DataView(data).getUint32(0, true);
    /** @type {Head} */
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
    const body = data.slice(4 + size);
    if (head.type === "frame") {
      this.#listener.frame(head, body);
    } else {
      this.#answered(head.id)?.give({ name: head.name, blob: new Blob([body], { type: head.mime }) });
    }
  }

  /** @param {Answer | News} message */
  #takeText(message) {
    if (message.type === "reply") this.#answered(message.id)?.give(message.result);
    else if (message.type === "refused") this.#answered(message.id)?.refuse(new Error(message.error));
    else this.#listener.news(message);
  }

  /** @param {number | null} id */
  #answered(id) {
    const waiting = this.#waiting.get(id);
    this.#waiting.delete(id);
    return waiting;
  }
}
