// The pictures: tiles of views, what is drawn over them, and which pixel a pointer is on.

import { $, el } from "./dom.js";
import { placeOf } from "./lens.js";

const GAP = 6;

export class Stage {
  constructor({ onViews, onShown }) {
    this.onViews = onViews;
    this.onShown = onShown;
    this.main = "";
    this.all = true;
    this.chosen = [];
    this.head = null;
    this.waypoints = [];
    this.loop = false;
    this.overlay = null; // what is known of the objects of a frame, if it is wanted
    this.tiles = new Map();
    new ResizeObserver(() => this.arrange()).observe($("stage"));
    this.arrange();
  }

  /** Make a tile of each view that the simulator can render; those chosen before stay chosen. */
  offer(specs) {
    const names = specs.map(({ name }) => name);
    if (names.join() === [...this.tiles.keys()].join()) return;
    $("tiles").replaceChildren();
    this.tiles = new Map(names.map((view) => [view, this.#tile(view)]));
    this.chosen = specs.filter(({ shown }) => shown).map(({ name }) => name);
    this.main = this.chosen[0];
    this.arrange();
  }

  /** Show a view among the others, or no longer; the last one stays. */
  choose(view, shown) {
    const chosen = [...this.tiles.keys()].filter((name) => (name === view ? shown : this.chosen.includes(name)));
    if (!chosen.length) return;
    this.chosen = chosen;
    if (!chosen.includes(this.main)) this.main = chosen[0];
    this.changed();
  }

  #tile(view) {
    const picture = el("canvas", { class: "picture", width: 4, height: 3 });
    const over = el("canvas", { class: "over", width: 4, height: 3 });
    const label = el("span", { class: "label" }, view);
    const tile = el("div", { class: "tile", data: { view } }, picture, over, label);
    $("tiles").append(tile);
    return { view, tile, picture, over };
  }

  get views() {
    return this.all ? this.chosen : [this.main];
  }

  /** Show a view large. */
  enlarge(view) {
    this.main = view;
    this.changed();
  }

  toggleAll() {
    this.all = !this.all;
    this.changed();
  }

  changed() {
    this.arrange();
    this.onViews(this.views);
  }

  /** Lay the tiles out: one large, and the others beside it, or below where it is narrow. */
  arrange() {
    const box = $("tiles").getBoundingClientRect();
    if (!box.width || !this.main) return;
    const ratio = this.head ? this.head.width / this.head.height : 4 / 3;
    const small = this.all ? this.chosen.filter((view) => view !== this.main) : [];
    const count = small.length;
    const narrow = matchMedia("(max-width: 760px)").matches;
    for (const { tile, view } of this.tiles.values()) {
      tile.hidden = view !== this.main && !small.includes(view);
      tile.classList.toggle("main", view === this.main);
    }
    const place = (view, left, top, width) => {
      const style = this.tiles.get(view).tile.style;
      style.left = `${left}px`;
      style.top = `${top}px`;
      style.width = `${width}px`;
      style.height = `${width / ratio}px`;
    };
    if (narrow) {
      const beside = count ? (box.width - (count - 1) * GAP) / count : 0;
      place(this.main, 0, 0, box.width);
      small.forEach((view, at) => place(view, at * (beside + GAP), box.width / ratio + GAP, beside));
      $("tiles").style.height = `${box.width / ratio + (count ? GAP + beside / ratio : 0)}px`;
      return;
    }
    $("tiles").style.height = "";
    if (!count) {
      const width = Math.min(box.width, box.height * ratio);
      place(this.main, (box.width - width) / 2, (box.height - width / ratio) / 2, width);
      return;
    }
    const fits = (box.width - GAP + ((count - 1) * GAP * ratio) / count) / ((1 + 1 / count) * ratio);
    const height = Math.min(box.height, fits);
    const beside = (height - (count - 1) * GAP) / count;
    const left = (box.width - (height + beside) * ratio - GAP) / 2;
    const top = (box.height - height) / 2;
    place(this.main, left, top, height * ratio);
    small.forEach((view, at) =>
      place(view, left + height * ratio + GAP, top + at * (beside + GAP), beside * ratio),
    );
  }

  /** Show a frame: all its views at the same time, then say so. */
  async show(head, body) {
    let at = 0;
    const pieces = head.views.map(({ name, mime, size }) => {
      const piece = new Blob([body.slice(at, at + size)], { type: mime });
      at += size;
      return createImageBitmap(piece).then((bitmap) => [name, bitmap]);
    });
    const bitmaps = await Promise.all(pieces);
    // A page that is hidden is given no animation frames, shows nothing and so receives nothing.
    requestAnimationFrame(() => {
      const resized = !this.head || this.head.width !== head.width || this.head.height !== head.height;
      this.head = head;
      if (resized) this.arrange();
      for (const [name, bitmap] of bitmaps) this.#draw(this.tiles.get(name), bitmap);
      this.drawOver();
      this.onShown(head);
    });
  }

  #draw({ picture }, bitmap) {
    if (picture.width !== bitmap.width || picture.height !== bitmap.height) {
      picture.width = bitmap.width;
      picture.height = bitmap.height;
    }
    picture.getContext("2d").drawImage(bitmap, 0, 0);
    bitmap.close();
  }

  /** Draw what lies over the pictures: the selected object's outline, the waypoints. */
  drawOver() {
    const head = this.head;
    if (!head) return;
    for (const view of this.views) {
      const { over } = this.tiles.get(view);
      const box = over.getBoundingClientRect();
      const scale = devicePixelRatio;
      const [width, height] = [Math.round(box.width * scale), Math.round(box.height * scale)];
      if (over.width !== width) over.width = width;
      if (over.height !== height) over.height = height;
      const pen = over.getContext("2d");
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.clearRect(0, 0, width, height);
      // Whole coordinates are the middles of pixels.
      pen.setTransform(width / head.width, 0, 0, height / head.height, 0, 0);
      pen.translate(0.5, 0.5);
      const line = head.width / box.width;
      if (view === this.main) this.#objects(pen, line);
      this.#outline(pen, head, view === this.main ? line : line / 2);
      if (view === this.main) this.#waypoints(pen, head, line);
    }
  }

  #outline(pen, head, line) {
    if (!head.outline?.length) return;
    const path = closedLines(head.outline);
    pen.lineJoin = "round";
    pen.strokeStyle = "rgb(0 0 0 / 0.6)";
    pen.lineWidth = 5 * line;
    pen.stroke(path);
    pen.strokeStyle = "#ffd23f";
    pen.lineWidth = 2.5 * line;
    pen.stroke(path);
  }

  /** Boxes around objects, boxes in space, and the outline of what is hidden too. */
  #objects(pen, line) {
    if (!this.overlay) return;
    pen.lineJoin = "round";
    pen.lineWidth = 1.5 * line;
    for (const [id, left, top, right, bottom] of this.overlay.boxes) {
      pen.strokeStyle = colourOf(id);
      pen.strokeRect(left - 0.5, top - 0.5, right - left + 1, bottom - top + 1);
    }
    for (const [id, edges] of this.overlay.edges) {
      pen.strokeStyle = colourOf(id);
      pen.beginPath();
      for (const [u0, v0, u1, v1] of edges) {
        pen.moveTo(u0, v0);
        pen.lineTo(u1, v1);
      }
      pen.stroke();
    }
    if (!this.overlay.whole.length) return;
    pen.setLineDash([5 * line, 4 * line]);
    pen.lineWidth = 2.5 * line;
    pen.strokeStyle = "white";
    pen.stroke(closedLines(this.overlay.whole));
    pen.setLineDash([]);
  }

  #project([x, y, z]) {
    const m = this.head.camera_from_world;
    const depth = m[8] * x + m[9] * y + m[10] * z + m[11];
    if (depth < 0.05) return null;
    const across = m[0] * x + m[1] * y + m[2] * z + m[3];
    const down = m[4] * x + m[5] * y + m[6] * z + m[7];
    return placeOf(this.head.lens, across, down, depth);
  }

  #waypoints(pen, head, line) {
    const places = this.waypoints.map((waypoint) => this.#project(waypoint.position));
    pen.strokeStyle = "rgb(62 198 189 / 0.9)";
    pen.lineWidth = 2 * line;
    pen.setLineDash([6 * line, 5 * line]);
    pen.beginPath();
    places.forEach((place, at) => {
      const before = at || !this.loop ? places[at - 1] : places.at(-1);
      if (place && before) {
        pen.moveTo(...before);
        pen.lineTo(...place);
      }
    });
    pen.stroke();
    pen.setLineDash([]);
    pen.font = `600 ${11 * line}px system-ui, sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    places.forEach((place, at) => {
      if (!place) return;
      pen.beginPath();
      pen.arc(...place, 9 * line, 0, 2 * Math.PI);
      pen.fillStyle = "#0e7c74";
      pen.fill();
      pen.strokeStyle = "white";
      pen.lineWidth = 1.5 * line;
      pen.stroke();
      pen.fillStyle = "white";
      pen.fillText(String(at + 1), ...place);
    });
  }

  /** Which pixel of the frame an event is on; null for none. */
  pixel(event) {
    const tile = event.target.closest?.(".tile");
    if (!tile || !this.head) return null;
    const box = tile.getBoundingClientRect();
    const u = Math.floor(((event.clientX - box.left) / box.width) * this.head.width);
    const v = Math.floor(((event.clientY - box.top) / box.height) * this.head.height);
    if (u < 0 || v < 0 || u >= this.head.width || v >= this.head.height) return null;
    return { view: tile.dataset.view, frame: this.head.number, u, v };
  }
}

function closedLines(lines) {
  const path = new Path2D();
  for (const points of lines) {
    for (let at = 0; at < points.length; at += 2) {
      if (at) path.lineTo(points[at], points[at + 1]);
      else path.moveTo(points[at], points[at + 1]);
    }
    path.closePath();
  }
  return path;
}

/** A colour of its own for each object: steps of the golden angle keep hues apart. */
function colourOf(id) {
  return `hsl(${(id * 137.508) % 360} 85% 62%)`;
}
