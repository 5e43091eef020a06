"use strict";

// Frames of a data set as tiles, with what is known of their objects drawn over them; no server.
// Texts of the data set are only ever set as text, never as markup.

const told = JSON.parse(document.getElementById("told").textContent);
const SVG = "http://www.w3.org/2000/svg";
const wanted = { split: "", category: "", scene: "", view: told.views[0] };
const page = document.body;
let shown = [];
let open = -1;

function element(name, properties = {}, ...inside) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...inside);
  return made;
}

function drawn(name, attributes, ...inside) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...inside);
  return made;
}

function overlay(frame, large) {
  const { width, height } = frame;
  const all = drawn("svg", { viewBox: `-0.5 -0.5 ${width} ${height}`, preserveAspectRatio: "none" });
  const size = width / (large ? 62 : 32);
  const tags = [];
  frame.objects.forEach((one, number) => {
    const [left, top, right, bottom] = one.box;
    const group = drawn("g", { class: one.room ? "object room" : "object", "data-object": number });
    if (one.outline) {
      group.append(drawn("path", { class: "outline", d: one.outline, fill: one.colour, "fill-opacity": 0.3, stroke: one.colour }));
    }
    group.append(drawn("rect", {
      class: "box", x: left - 0.5, y: top - 0.5, width: right - left + 1, height: bottom - top + 1, stroke: one.colour,
    }));
    // A name that does not fit, or hides another one, tells less than none.
    const tag = { left: left + 0.3 * size, top: top + 0.2 * size, right: left + (0.8 + 0.62 * one.category.length) * size, bottom: top + 1.4 * size };
    const free = tags.every((other) => tag.left > other.right || tag.right < other.left || tag.top > other.bottom || tag.bottom < other.top);
    if (!one.room && free && tag.right < width && right - left > 2.5 * size) {
      tags.push({ ...tag, node: drawn("text", { class: "tag", x: tag.left, y: top + 1.15 * size, "font-size": size }, one.category) });
    }
    all.append(group);
  });
  all.append(...tags.map((tag) => tag.node));
  return all;
}

function picture(frame, view, large = false) {
  const image = element("img", { src: frame.pictures[view], alt: `${view} of frame ${frame.number}` });
  return element("div", { className: "picture" }, image, overlay(frame, large));
}

function tile(frame, place) {
  const line = element("div", { className: "told" },
    element("b", { textContent: `${frame.number}` }),
    element("span", { textContent: frame.split }),
    element("span", { className: "spread", textContent: frame.scene }),
    element("span", { textContent: `${frame.objects.length} objects` }));
  const made = element("button", { className: "tile", onclick: () => enlarge(place) });
  made.append(picture(frame, wanted.view), line);
  made.dataset.frame = frame.number;
  return made;
}

function refresh() {
  shown = told.frames.filter((frame) =>
    (!wanted.split || frame.split === wanted.split)
    && (!wanted.scene || frame.scene === wanted.scene)
    && (!wanted.category || frame.objects.some((one) => one.category === wanted.category)));
  const grid = document.getElementById("frames");
  grid.replaceChildren(...shown.map(tile));
  document.getElementById("nothing").hidden = shown.length > 0;
  document.getElementById("shown").textContent = `${shown.length} of the ${told.frames.length} frames on this page`;
  for (const button of document.querySelectorAll("[data-key]")) {
    button.setAttribute("aria-pressed", String(wanted[button.dataset.key] === button.dataset.value));
  }
  page.dataset.shown = shown.length;
}

function choice(key, value, ...inside) {
  const made = element("button", {
    onclick: () => {
      wanted[key] = wanted[key] === value && key !== "view" ? "" : value;
      refresh();
    },
  }, ...inside);
  made.dataset.key = key;
  made.dataset.value = value;
  return made;
}

function counted(key, rows, title) {
  const most = Math.max(1, ...rows.map((row) => row.count));
  const list = rows.map((row) => {
    const swatch = element("span", { className: "swatch" });
    swatch.style.background = row.colour ?? "transparent";
    const made = choice(key, row.name, swatch,
      element("span", { className: "name", textContent: row.name, title: row.name }),
      element("span", { className: "count", textContent: row.count.toLocaleString("en"), title: row.told ?? "" }));
    made.style.setProperty("--share", `${(100 * row.count) / most}%`);
    return made;
  });
  return [element("h2", { textContent: title }), element("div", { className: "counts" }, ...list)];
}

function number(value, digits) {
  return value === null || value === undefined ? "–" : value.toFixed(digits);
}

function enlarge(place) {
  open = (place + shown.length) % shown.length;
  const frame = shown[open];
  const dialog = document.getElementById("large");
  const big = element("div", {}, picture(frame, wanted.view, true));
  const others = element("div", { className: "others" });
  for (const view of told.views) {
    const figure = element("figure", {
      onclick: () => {
        wanted.view = view;
        refresh();
        enlarge(open);
      },
    }, element("img", { src: frame.pictures[view], alt: view }), element("figcaption", { textContent: view }));
    figure.setAttribute("aria-current", String(view === wanted.view));
    others.append(figure);
  }
  const rows = frame.objects.map((one, row) => {
    const swatch = element("span", { className: "swatch" });
    swatch.style.background = one.colour;
    const of = element("span", { className: "of", textContent: one.name === one.category ? "" : ` ${one.name}` });
    const line = element("tr", { onmouseenter: () => point(row, true), onmouseleave: () => point(row, false) },
      element("td", {}, swatch, one.category, of),
      element("td", { textContent: one.pixels.toLocaleString("en") }),
      element("td", { textContent: one.share === null ? "–" : `${Math.round(100 * one.share)} %` }),
      element("td", { textContent: number(one.distance, 2) }));
    line.dataset.row = row;
    return line;
  });
  const head = element("tr", {}, ...["object", "pixels", "visible", "m away"].map((text) => element("th", { textContent: text })));
  document.getElementById("large-title").textContent =
    `Frame ${frame.number} · ${frame.split} · ${frame.scene} · ${frame.camera} · clip ${frame.clip}, frame ${frame.time} · ${frame.width}×${frame.height}`;
  document.getElementById("large-left").replaceChildren(big, others);
  document.getElementById("large-right").replaceChildren(element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)));
  for (const group of big.querySelectorAll(".object")) {
    const row = Number(group.dataset.object);
    group.addEventListener("mouseenter", () => point(row, true));
    group.addEventListener("mouseleave", () => point(row, false));
  }
  if (!dialog.open) dialog.showModal();
  page.dataset.open = frame.number;
}

function point(row, on) {
  for (const one of document.querySelectorAll(`#large [data-object="${row}"], #large [data-row="${row}"]`)) {
    one.classList.toggle("chosen", on);
  }
}

for (const name of ["masks", "boxes", "names", "room"]) {
  const box = document.getElementById(name);
  box.onchange = () => page.classList.toggle(`no-${name}`, !box.checked);
  box.onchange();
}
document.getElementById("before").onclick = () => enlarge(open - 1);
document.getElementById("after").onclick = () => enlarge(open + 1);
document.getElementById("close").onclick = () => document.getElementById("large").close();
document.getElementById("large").addEventListener("close", () => { page.dataset.open = ""; });
document.addEventListener("keydown", (event) => {
  if (!document.getElementById("large").open) return;
  if (event.key === "ArrowLeft") enlarge(open - 1);
  if (event.key === "ArrowRight") enlarge(open + 1);
});
document.getElementById("views").append(...told.views.map((view) => choice("view", view, view)));
document.getElementById("lists").prepend(
  ...counted("split", told.splits, "Splits (frames)"),
  ...(told.scenes.length > 1 ? counted("scene", told.scenes, "Scenes (frames)") : []),
  ...(told.categories.length ? counted("category", told.categories, "Categories (objects)") : []));
refresh();
