// The socket: requests with answers, frames, news; connects again by itself.

export class Link extends EventTarget {
  #socket = null;
  #waiting = new Map();
  #next = 1;
  #pause = 500;

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
      this.#tell("offline");
      for (const { refuse } of this.#waiting.values()) refuse(new Error("the connection was lost"));
      this.#waiting.clear();
      setTimeout(() => this.connect(), this.#pause);
      this.#pause = Math.min(5000, this.#pause * 1.6);
    };
    this.#socket = socket;
  }

  get open() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  /** Ask; the promise gives what is answered or fails with the simulator's words. */
  ask(what, values = {}) {
    if (!this.open) return Promise.reject(new Error("there is no connection to the simulator"));
    const id = this.#next++;
    return new Promise((give, refuse) => {
      this.#waiting.set(id, { give, refuse });
      this.#socket.send(JSON.stringify({ ...values, do: what, id }));
    });
  }

  shown(number) {
    if (this.open) this.#socket.send(JSON.stringify({ do: "shown", number }));
  }

  #take(data) {
    if (typeof data === "string") {
      this.#handle(JSON.parse(data));
      return;
    }
    const size = new DataView(data).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
    this.#handle(head, data.slice(4 + size));
  }

  #handle(message, body) {
    const waits = this.#waiting.get(message.id);
    if (message.type === "reply" || message.type === "file" || message.type === "refused") {
      this.#waiting.delete(message.id);
      if (message.type === "refused") waits?.refuse(new Error(message.error));
      else if (message.type === "file") {
        waits?.give({ name: message.name, blob: new Blob([body], { type: message.mime }) });
      } else waits?.give(message.result);
      return;
    }
    this.#tell(message.type, { message, body });
  }

  #tell(type, detail = {}) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
