// @ts-check
// Small helpers: elements, lists, icons, numbers, notes to the reader.

/** The element of an id, which the page has. @param {string} id @returns {HTMLElement} */
export function $(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found;
}

/** The same for an element of a kind. @template {HTMLElement} T @param {string} id @param {new () => T} kind @returns {T} */
export function own(id, kind) {
  const found = $(id);
  if (!(found instanceof kind)) throw new Error(`#${id} is no ${kind.name}`);
  return found;
}

/**
 * Make an element: properties, then children (texts or elements). `on` holds listeners.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any>} properties
 * @param {...(Node | string | null | undefined)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function el(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "on") {
      for (const [event, listener] of Object.entries(value)) element.addEventListener(event, listener);
    } else if (name === "class") element.className = value;
    else if (name === "data") Object.assign(element.dataset, value);
    else if (name in element) Reflect.set(element, name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

// ---- lists

/** @template T @typedef {{ root: Element, set?: (item: T) => void }} Row */

/** @type {WeakMap<Element, Map<string, Row<any>>>} */
const rowsOf = new WeakMap();

/**
 * Bring the elements of a list in line with its items. Elements of items that stay are kept, so a
 * press on one of them becomes a click whatever comes and goes meanwhile.
 * @template T
 * @param {Element} holder
 * @param {readonly T[]} items
 * @param {(item: T, at: number) => string} keyOf
 * @param {(item: T, at: number) => Row<T>} make
 */
export function keyed(holder, items, keyOf, make) {
  const before = rowsOf.get(holder) ?? new Map();
  /** @type {Map<string, Row<T>>} */
  const rows = new Map();
  items.forEach((item, at) => {
    const key = keyOf(item, at);
    const row = before.get(key) ?? make(item, at);
    row.set?.(item);
    rows.set(key, row);
  });
  rowsOf.set(holder, rows);
  const wanted = new Set([...rows.values()].map(({ root }) => root));
  for (const child of [...holder.children]) if (!wanted.has(child)) child.remove();
  let next = holder.firstElementChild;
  for (const root of wanted) {
    if (root === next) next = next.nextElementSibling;
    else holder.insertBefore(root, next);
  }
}

/**
 * Offer values in a list to choose from: each with its words, and whether it cannot be chosen.
 * @param {HTMLSelectElement} select
 * @param {readonly { value: string, words: string, disabled?: boolean }[]} offers
 */
export function options(select, offers) {
  keyed(select, offers, ({ value, words }) => `${value}\n${words}`, ({ value, words, disabled = false }) => ({
    root: el("option", { value, disabled }, words),
  }));
}

/** Set an element's text unless it is the same. @param {Element} element @param {string} words */
export function say(element, words) {
  if (element.textContent !== words) element.textContent = words;
}

/** @type {Record<string, string>} */
const PATHS = {
  play: "M8 5l11 7-11 7z",
  pause: "M8 5v14M16 5v14",
  step: "M6 5l8 7-8 7zM18 5v14",
  reset: "M5 12a7 7 0 1 0 2.2-5.1M5 4v4h4",
  camera: "M4 8h3l2-3h6l2 3h3v11H4zM12 10a3.5 3.5 0 1 0 0 7a3.5 3.5 0 0 0 0-7",
  grid: "M4 4h9v16H4zM16 4h4v4h-4zM16 10h4v4h-4zM16 16h4v4h-4z",
  one: "M4 5h16v14H4z",
  sheet: "M4 4h7v7H4zM13 4h7v7h-7zM4 13h7v7H4zM13 13h7v7h-7z",
  eye: "M2 12s4-7 10-7 10 7 10 7-4 7-10 7-10-7-10-7M12 9a3 3 0 1 0 0 6a3 3 0 0 0 0-6",
  route: "M6 19a2 2 0 1 0 0-4a2 2 0 0 0 0 4M18 9a2 2 0 1 0 0-4a2 2 0 0 0 0 4M8 17h6a4 4 0 0 0 0-8h-3a3 3 0 0 1 0-2h5",
  keys: "M4 7h16v11H4zM7 11h.1M11 11h.1M15 11h.1M8 15h8",
  trash: "M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13",
  target: "M12 4v4M12 16v4M4 12h4M16 12h4M12 9a3 3 0 1 0 0 6a3 3 0 0 0 0-6",
  plus: "M12 5v14M5 12h14",
  up: "M12 19V5M6 11l6-6 6 6",
  down: "M12 5v14M6 13l6 6 6-6",
  undo: "M9 5L4 10l5 5M4 10h10a5 5 0 0 1 0 10h-4",
  redo: "M15 5l5 5-5 5M20 10H10a5 5 0 0 0 0 10h4",
  save: "M12 4v11M7 10l5 5 5-5M5 20h14",
};

/** @param {string} name */
export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("class", "glyph");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", PATHS[name] ?? "");
  svg.append(path);
  return svg;
}

/**
 * A button with an icon and, if any, words.
 * @param {string} words
 * @param {(event: MouseEvent) => void} listener
 * @param {{ glyph?: string, title?: string, kind?: string }} looks
 */
export function button(words, listener, { glyph = "", title = "", kind = "" } = {}) {
  const made = el("button", { type: "button", title, class: kind, on: { click: listener } });
  if (glyph) made.append(icon(glyph));
  if (words) made.append(words);
  return made;
}

/** @param {string} title @param {...(Node | string)} children */
export function section(title, ...children) {
  return el("section", { class: "block" }, el("h2", {}, title), ...children);
}

/** A control with its label before it. @param {string} label @param {...Node} controls */
export function line(label, ...controls) {
  return el("label", { class: "line" }, el("span", {}, label), ...controls);
}

/** Names and values, for a `dl`. @param {readonly (readonly [string, string])[]} rows */
export function pairs(rows) {
  return rows.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]);
}

/** A number with so many digits after the point; never minus zero. @param {number | string} value */
export const fixed = (value, digits = 2) => Number(value).toFixed(digits).replace(/^-(?=[0.]*$)/, "");

/** The words of whatever was thrown. @param {unknown} error */
export const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

/** @param {string} words @param {"note" | "error"} kind */
export function toast(words, kind = "note") {
  const note = el("div", { class: `toast ${kind}` }, words);
  const holder = $("toasts");
  holder.append(note);
  while (holder.children.length > 4) holder.firstElementChild?.remove();
  setTimeout(() => note.remove(), kind === "error" ? 8000 : 4000);
}

/**
 * Call `send(value)` for the newest value only, one at a time: for sliders and mice.
 * @template T
 * @param {(value: T) => Promise<unknown>} send
 * @returns {(value: T) => void}
 */
export function latest(send) {
  /** @type {[T] | null} */
  let waiting = null;
  let busy = false;
  const next = async () => {
    busy = true;
    while (waiting) {
      const [value] = /** @type {[T]} */ (waiting);
      waiting = null;
      try {
        await send(value);
      } catch (error) {
        toast(wordsOf(error), "error");
      }
    }
    busy = false;
  };
  return (value) => {
    waiting = [value];
    if (!busy) next();
  };
}

/** Have a file that was made here saved. @param {string} name @param {Blob} blob */
export function download(name, blob) {
  const address = URL.createObjectURL(blob);
  el("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/**
 * Set a control's value unless it is being used.
 * @param {HTMLInputElement | HTMLSelectElement} control
 * @param {string | number} value
 */
export function put(control, value) {
  if (document.activeElement !== control && control.value !== String(value)) control.value = String(value);
}

/** Take the keyboard from the control that has it. */
export function blur() {
  if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
}

/** @typedef {{ input: HTMLInputElement, root: HTMLElement, set: (value: number) => void }} Slider */

/**
 * A labelled slider: `changed(value)` at every move; `set(value)` unless it is being used.
 * @param {string} label
 * @param {number} least
 * @param {number} most
 * @param {number} step
 * @param {(value: number) => void} changed
 * @returns {Slider}
 */
export function slider(label, least, most, step, changed) {
  const shown = el("output", {});
  const input = el("input", {
    type: "range", min: least, max: most, step, title: label, "aria-label": label,
    on: {
      input: () => {
        shown.textContent = fixed(input.value);
        changed(Number(input.value));
      },
      change: () => input.blur(),
    },
  });
  return {
    input,
    root: el("label", { class: "slider" }, el("span", {}, label), input, shown),
    set: (value) => {
      if (document.activeElement === input) return;
      // What was set elsewhere may lie beyond what is usual here.
      if (value > Number(input.max)) input.max = String(value);
      if (value < Number(input.min)) input.min = String(value);
      input.value = String(value);
      shown.textContent = fixed(value);
    },
  };
}

// Colours of lights are linear, those of the page are sRGB.
/** @param {number} x */
const toByte = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
/** @param {number} b */
const fromByte = (b) => (b / 255 <= 0.04045 ? b / 255 / 12.92 : ((b / 255 + 0.055) / 1.055) ** 2.4);

/** @param {readonly number[]} colour */
export function hexOfLinear(colour) {
  const most = Math.max(1, ...colour);
  return "#" + colour.map((x) => toByte(x / most).toString(16).padStart(2, "0")).join("");
}

/** @param {string} hex */
export function linearOfHex(hex) {
  return [1, 3, 5].map((at) => Number(fromByte(parseInt(hex.slice(at, at + 2), 16)).toFixed(5)));
}

/** Whether keys are for the element that has them. @param {EventTarget | null} target */
export function isTyping(target) {
  if (target instanceof HTMLInputElement) return target.type !== "checkbox";
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement;
}

/** The element that an event is on, or the next around it, that fits. @param {Event} event @param {string} selector */
export function around(event, selector) {
  return event.target instanceof Element ? event.target.closest(selector) : null;
}
