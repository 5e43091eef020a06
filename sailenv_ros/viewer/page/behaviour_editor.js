// @ts-check
// What moves the selected object: its behaviours, and one more with its parameters.

import { button, el, keyed, options, say, section } from "./dom.js";

/** @import {BehaviourInfo, ObjectValues} from "./messages.js" */
/** @import {Store} from "./store.js" */

/** @typedef {Record<string, unknown>} Behaviour */

export class BehaviourEditor {
  #kinds = el("select", { id: "behaviour", title: "Behaviour", on: { change: () => this.#showKind() } });
  #about = el("p", { class: "advice" });
  #fields = el("div", { class: "fields" });
  #list = el("div", { class: "list" });
  #nothing = el("p", { class: "advice" });
  #stop;
  #adder;
  /** @type {readonly BehaviourInfo[]} */
  #known = [];

  /**
   * @param {Store} store
   * @param {{ attach: (behaviour: Behaviour) => void, stop: () => void }} acts
   */
  constructor(store, { attach, stop }) {
    this.#stop = button("Stop all", stop, { kind: "quiet" });
    this.#adder = el("details", {}, el("summary", {}, "Add a behaviour"), this.#kinds, this.#about, this.#fields,
      button("Attach", () => attach(this.#typed()), { glyph: "plus", kind: "primary" }));
    this.root = section("Moves by", el("div", {}, this.#list, this.#stop, this.#nothing), this.#adder);
    store.on(["hello"], ({ hello }) => {
      this.#known = hello?.behaviours ?? [];
      options(this.#kinds, this.#known.map(({ type }) => ({ value: type, words: type })));
      this.#showKind();
    });
  }

  /** Forget what was typed for another object. */
  reset() {
    this.#adder.open = false;
    this.#showKind();
  }

  /** @param {ObjectValues} object */
  show({ behaviours, static: fast }) {
    keyed(this.#list, behaviours, (_, at) => String(at), () => {
      const name = el("span", { class: "name" });
      const root = el("div", { class: "row flat" }, name);
      /** @param {Behaviour} behaviour */
      const set = (behaviour) => {
        say(name, String(behaviour.type));
        root.title = JSON.stringify(behaviour);
      };
      return { root, set };
    });
    this.#stop.hidden = !behaviours.length;
    this.#nothing.hidden = behaviours.length > 0;
    say(this.#nothing, fast ? "Nothing: it is static." : "Nothing but physics.");
  }

  #showKind() {
    const kind = this.#known.find(({ type }) => type === this.#kinds.value);
    this.#about.textContent = kind?.summary ?? "";
    this.#fields.replaceChildren(
      ...(kind?.parameters ?? []).map((parameter) =>
        el("label", { class: "line", title: parameter.about },
          el("span", {}, parameter.name),
          el("input", {
            type: "text", data: { name: parameter.name },
            placeholder: parameter.needed ? "needed" : parameter.default === null ? "" : JSON.stringify(parameter.default),
          })),
      ),
    );
  }

  #typed() {
    /** @type {Behaviour} */
    const behaviour = { type: this.#kinds.value };
    for (const input of this.#fields.querySelectorAll("input")) {
      const typed = input.value.trim();
      if (typed && input.dataset.name) behaviour[input.dataset.name] = valueOf(typed);
    }
    return behaviour;
  }
}

/** What was typed as JSON, or as a text where it is none. @param {string} typed */
function valueOf(typed) {
  try {
    return JSON.parse(typed);
  } catch {
    return typed;
  }
}
