// @ts-check
// The pictures: tiles of views, what is drawn over them, and which pixel a pointer is on.

import { $, around, el } from "./dom.js";
import { drawCircle, drawObjects, drawOutline, drawPeople, drawWaypoints } from "./drawing.js";
import { shownViews } from "./store.js";

/** @import {FrameHead} from "./messages.js" */
/** @import {Store} from "./store.js" */

/** @typedef {{ view: string, tile: HTMLElement, picture: HTMLCanvasElement, over: HTMLCanvasElement }} Tile */
/** @typedef {{ view: string, frame: number, u: number, v: number }} PlaceInView */

const GAP = 6;

export class Stage {
  root = $("stage");
  tiles = $("tiles");
  #store;
  #onShown;
  /** @type {Map<string, Tile>} */
  #byView = new Map();

  /**
   * @param {Store} store
   * @param {(head: FrameHead) => void} onShown Called with each frame that is drawn.
   */
  constructor(store, onShown) {
    this.#store = store;
    this.#onShown = onShown;
    new ResizeObserver(() => this.#arrange()).observe(this.root);
    store.on(["hello"], ({ hello }) => this.#offer((hello?.views ?? []).map(({ name }) => name)));
    store.on(["hello", "views"], () => this.#arrange());
    store.on(["frame", "overlay"], () => this.#drawOver());
  }

  /** Height of the large picture in the page [px]. */
  get mainHeight() {
    return this.#byView.get(this.#store.state.views.main)?.tile.getBoundingClientRect().height ?? 1;
  }

  focus() {
    this.root.focus({ preventScroll: true });
  }

  /** Make a tile of each view that the simulator can render. @param {readonly string[]} views */
  #offer(views) {
    if (views.join() === [...this.#byView.keys()].join()) return;
    this.#byView = new Map(views.map((view) => [view, tileOf(view)]));
    this.tiles.replaceChildren(...[...this.#byView.values()].map(({ tile }) => tile));
  }

  /** Lay the tiles out: one large, and the others beside it, or below where it is narrow. */
  #arrange() {
    const box = this.tiles.getBoundingClientRect();
    const { views, frame } = this.#store.state;
    const { main } = views;
    if (!box.width || !main) return;
    const ratio = frame ? frame.width / frame.height : 4 / 3;
    const small = views.all ? views.chosen.filter((view) => view !== main) : [];
    const count = small.length;
    const narrow = matchMedia("(max-width: 760px)").matches;
    for (const { tile, view } of this.#byView.values()) {
      tile.hidden = view !== main && !small.includes(view);
      tile.classList.toggle("main", view === main);
    }
    /** @type {(view: string, left: number, top: number, width: number) => void} */
    const place = (view, left, top, width) => {
      const style = this.#byView.get(view)?.tile.style;
      if (!style) return;
      style.left = `${left}px`;
      style.top = `${top}px`;
      style.width = `${width}px`;
      style.height = `${width / ratio}px`;
    };
    if (narrow) {
      const beside = count ? (box.width - (count - 1) * GAP) / count : 0;
      place(main, 0, 0, box.width);
      small.forEach((view, at) => place(view, at * (beside + GAP), box.width / ratio + GAP, beside));
      this.tiles.style.height = `${box.width / ratio + (count ? GAP + beside / ratio : 0)}px`;
      return;
    }
    this.tiles.style.height = "";
    if (!count) {
      const width = Math.min(box.width, box.height * ratio);
      place(main, (box.width - width) / 2, (box.height - width / ratio) / 2, width);
      return;
    }
    const fits = (box.width - GAP + ((count - 1) * GAP * ratio) / count) / ((1 + 1 / count) * ratio);
    const height = Math.min(box.height, fits);
    const beside = (height - (count - 1) * GAP) / count;
    const left = (box.width - (height + beside) * ratio - GAP) / 2;
    const top = (box.height - height) / 2;
    place(main, left, top, height * ratio);
    small.forEach((view, at) =>
      place(view, left + height * ratio + GAP, top + at * (beside + GAP), beside * ratio),
    );
  }

  /**
   * Show a frame: all its views at the same time, then say so.
   * @param {FrameHead} head
   * @param {ArrayBuffer} body
   */
  async show(head, body) {
    let at = 0;
    const bitmaps = await Promise.all(head.views.map(async ({ name, mime, size }) => {
      const piece = new Blob([body.slice(at, at + size)], { type: mime });
      at += size;
      return { name, bitmap: await createImageBitmap(piece) };
    }));
    // A page that is hidden is given no animation frames, shows nothing and so receives nothing.
    requestAnimationFrame(() => {
      const before = this.#store.state.frame;
      const resized = before?.width !== head.width || before.height !== head.height;
      for (const { name, bitmap } of bitmaps) this.#draw(name, bitmap);
      this.#onShown(head);
      this.#store.set({ frame: head });
      if (resized) this.#arrange();
    });
  }

  /** @param {string} view @param {ImageBitmap} bitmap */
  #draw(view, bitmap) {
    const picture = this.#byView.get(view)?.picture;
    if (picture && (picture.width !== bitmap.width || picture.height !== bitmap.height)) {
      picture.width = bitmap.width;
      picture.height = bitmap.height;
    }
    picture?.getContext("2d")?.drawImage(bitmap, 0, 0);
    bitmap.close();
  }

  /** Draw what lies over the pictures: objects, people's joints, the selected one's outline, image circle, waypoints. */
  #drawOver() {
    const { state } = this.#store;
    const { frame, overlay, views } = state;
    if (!frame) return;
    for (const view of shownViews(state)) {
      const over = this.#byView.get(view)?.over;
      const pen = over?.getContext("2d");
      if (!over || !pen) continue;
      const box = over.getBoundingClientRect();
      const scale = devicePixelRatio;
      const [width, height] = [Math.round(box.width * scale), Math.round(box.height * scale)];
      if (over.width !== width) over.width = width;
      if (over.height !== height) over.height = height;
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.clearRect(0, 0, width, height);
      // Whole coordinates are the middles of pixels.
      pen.setTransform(width / frame.width, 0, 0, height / frame.height, 0, 0);
      pen.translate(0.5, 0.5);
      const line = frame.width / box.width;
      const large = view === views.main;
      if (large && overlay) drawObjects(pen, overlay, line);
      if (large && overlay) drawPeople(pen, overlay, line);
      drawOutline(pen, frame.outline ?? [], large ? line : line / 2);
      if (overlay) drawCircle(pen, overlay, large ? line : line / 2);
      if (large && overlay) drawWaypoints(pen, overlay, line);
    }
  }

  /**
   * Which pixel of the frame an event is on; null for none.
   * @param {MouseEvent} event
   * @returns {PlaceInView | null}
   */
  pixel(event) {
    const { frame } = this.#store.state;
    const tile = around(event, ".tile");
    if (!(tile instanceof HTMLElement) || !frame) return null;
    const box = tile.getBoundingClientRect();
    const u = Math.floor(((event.clientX - box.left) / box.width) * frame.width);
    const v = Math.floor(((event.clientY - box.top) / box.height) * frame.height);
    if (u < 0 || v < 0 || u >= frame.width || v >= frame.height) return null;
    return { view: tile.dataset.view ?? "", frame: frame.number, u, v };
  }
}

/** @param {string} view @returns {Tile} */
function tileOf(view) {
  const picture = el("canvas", { class: "picture", width: 4, height: 3 });
  const over = el("canvas", { class: "over", width: 4, height: 3 });
  const label = el("span", { class: "label" }, view);
  return { view, tile: el("div", { class: "tile", data: { view } }, picture, over, label), picture, over };
}
