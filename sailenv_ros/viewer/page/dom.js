// Small helpers: elements, icons, numbers, notes to the reader.

export const $ = (id) => document.getElementById(id);

/** Make an element: properties, then children (texts or elements). `on` holds listeners. */
export function el(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "on") {
      for (const [event, listener] of Object.entries(value)) element.addEventListener(event, listener);
    } else if (name === "class") element.className = value;
    else if (name === "data") Object.assign(element.dataset, value);
    else if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

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

export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("class", "glyph");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", PATHS[name]);
  svg.append(path);
  return svg;
}

/** A button with an icon and, if any, words. */
export function button(words, listener, { glyph = "", title = "", kind = "" } = {}) {
  const made = el("button", { type: "button", title, class: kind, on: { click: listener } });
  if (glyph) made.append(icon(glyph));
  if (words) made.append(words);
  return made;
}

export function section(title, ...children) {
  return el("section", { class: "block" }, el("h2", {}, title), ...children);
}

/** A number with so many digits after the point; never minus zero. */
export const fixed = (value, digits = 2) => Number(value).toFixed(digits).replace(/^-(?=[0.]*$)/, "");

export function toast(words, kind = "note") {
  const note = el("div", { class: `toast ${kind}` }, words);
  const holder = $("toasts");
  holder.append(note);
  while (holder.children.length > 4) holder.firstChild.remove();
  setTimeout(() => note.remove(), kind === "error" ? 8000 : 4000);
}

/** Call `send(value)` for the newest value only, one at a time: for sliders and mice. */
export function latest(send) {
  let waiting = null;
  let busy = false;
  const next = async () => {
    busy = true;
    while (waiting) {
      const [value] = waiting;
      waiting = null;
      try {
        await send(value);
      } catch (error) {
        toast(error.message, "error");
      }
    }
    busy = false;
  };
  return (value) => {
    waiting = [value];
    if (!busy) next();
  };
}

/** Have a file that was made here saved. */
export function download(name, blob) {
  const address = URL.createObjectURL(blob);
  el("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** Set a control's value unless it is being used. */
export function put(control, value) {
  if (document.activeElement !== control && control.value !== String(value)) control.value = value;
}

/** A labelled slider: `changed(value)` at every move; `set(value)` unless it is being used. */
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
      if (value > Number(input.max)) input.max = value;
      if (value < Number(input.min)) input.min = value;
      input.value = value;
      shown.textContent = fixed(value);
    },
  };
}

// Colours of lights are linear, those of the page are sRGB.
const toByte = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
const fromByte = (b) => (b / 255 <= 0.04045 ? b / 255 / 12.92 : ((b / 255 + 0.055) / 1.055) ** 2.4);

export function hexOfLinear(colour) {
  const most = Math.max(1, ...colour);
  return "#" + colour.map((x) => toByte(x / most).toString(16).padStart(2, "0")).join("");
}

export function linearOfHex(hex) {
  return [1, 3, 5].map((at) => Number(fromByte(parseInt(hex.slice(at, at + 2), 16)).toFixed(5)));
}
