// What is seen now: the values under the pointer, the categories, how long a frame took.

import { el, fixed, section } from "./dom.js";

export class ViewPanel {
  title = "View";

  constructor(app) {
    this.app = app;
    this.probe = el("dl", { class: "values", id: "probe" });
    this.legend = el("div", { class: "legend", id: "legend" });
    this.shown = el("div", { id: "shown-views" });
    this.stages = el("div", { class: "stages", id: "stages" });
    this.over = { boxes: false, space: false, whole: false };
    this.objects = el("div", { id: "object-overlay" }, ...OVERLAYS.map((overlay) => this.#overlayBox(overlay)));
    this.camera = el("dl", { class: "values", id: "camera" });
    this.root = el(
      "div",
      {},
      section("Pixel", this.probe),
      section("Views", this.shown),
      section("Over the picture", this.objects),
      section("Seen now", this.legend),
      section("Camera", this.camera),
      section("Time of a frame", this.stages),
    );
    this.showValues(null);
    this.refreshed = 0;
    this.specs = [];
  }

  update() {}

  #overlayBox([key, label, title]) {
    const box = el("input", {
      type: "checkbox", data: { draws: key },
      on: {
        change: () => {
          this.over[key] = box.checked;
          this.app.drawObjects();
        },
      },
    });
    return el("label", { class: "line", title }, el("span", {}, label), box);
  }

  /** Offer a box for each view that the simulator can render, to show it or not. */
  offer(specs) {
    this.specs = specs;
    const stage = this.app.stage;
    const boxes = specs.map(({ name, meaning }) => {
      const box = el("input", {
        type: "checkbox", checked: stage.chosen.includes(name), data: { shows: name },
        on: {
          change: () => {
            stage.choose(name, box.checked);
            box.checked = stage.chosen.includes(name); // the last one stays
          },
        },
      });
      return el("label", { class: "line", title: meaning }, el("span", {}, name), box);
    });
    this.shown.replaceChildren(...boxes);
  }

  frame(head) {
    const now = performance.now();
    if (now - this.refreshed < 250) return;
    this.refreshed = now;
    this.#showLegend(head);
    this.#showCamera(head);
    this.#showStages(head.timings_ms);
  }

  showValues(values) {
    this.probe.replaceChildren(
      ...(values ? pairs(told(values, this.specs)) : [el("dd", { class: "whole" }, "Point at a picture.")]),
    );
  }

  #showLegend(head) {
    const scene = this.app.scene;
    if (!scene || !head.visible) return;
    const byCategory = new Map();
    for (const [id, pixels] of head.visible) {
      const instance = this.app.instances.get(id);
      const number = instance?.category_id ?? 255;
      const entry = byCategory.get(number) ?? { pixels: 0, ids: [] };
      entry.pixels += pixels;
      entry.ids.push(id);
      byCategory.set(number, entry);
    }
    const total = head.width * head.height;
    const rows = [...byCategory].sort((a, b) => b[1].pixels - a[1].pixels);
    this.legend.replaceChildren(
      ...rows.map(([number, { pixels, ids }]) => {
        const category = this.app.categories.get(number);
        const chip = el("span", { class: "chip" });
        chip.style.background = category ? `rgb(${category.colour.join(" ")})` : "rgb(128 128 128)";
        const names = ids.map((id) => this.app.instances.get(id)?.name ?? `#${id}`).join(", ");
        return el(
          "button",
          { class: "row", title: names, on: { click: () => this.app.select(ids[0]) } },
          chip,
          el("span", { class: "name" }, category?.name ?? "unlabelled"),
          el("span", { class: "count" }, ids.length > 1 ? `× ${ids.length}` : ""),
          el("span", { class: "share" }, `${fixed((100 * pixels) / total, 1)} %`),
        );
      }),
    );
  }

  #showCamera(head) {
    this.camera.replaceChildren(
      ...pairs([
        ["position", `${head.position.map((x) => fixed(x)).join(", ")} m`],
        ["pitch, yaw", `${fixed(head.rpy_deg[1], 1)}°, ${fixed(head.rpy_deg[2], 1)}°`],
        ["picture", `${head.width} × ${head.height}, ${fixed(head.fov_deg, 1)}° high`],
        ["frame", `${head.sequence} of ${head.agent}`],
      ]),
    );
  }

  #showStages(timings) {
    const whole = timings.render || 1;
    const parts = Object.entries(timings).filter(([name]) => name !== "render");
    this.stages.replaceChildren(
      ...[["whole", whole], ...parts].map(([name, ms]) => {
        const bar = el("span", { class: "bar" });
        bar.style.width = `${Math.min(100, (100 * ms) / whole)}%`;
        return el(
          "div",
          { class: "stage" },
          el("span", {}, name.replaceAll("_", " ")),
          el("span", { class: "track" }, bar),
          el("span", { class: "share" }, `${fixed(ms, 1)} ms`),
        );
      }),
    );
  }
}

const OVERLAYS = [
  ["boxes", "boxes", "The box around what is visible of each object"],
  ["space", "boxes in space", "The oriented box of each object"],
  ["whole", "whole object", "The outline of the object under the pointer, also of what is hidden"],
];

export function pairs(rows) {
  return rows.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]);
}

/** The values of a pixel in words, view by view. */
export function told(values, specs) {
  const rows = specs
    .filter(({ name }) => name in values)
    .map((spec) => [spec.name, (WORDS[spec.display] ?? numberWords)(values[spec.name], spec, values)]);
  return [["pixel", `${values.u}, ${values.v}`], ...rows];
}

const WORDS = {
  category: (name, spec, values) => `${name || "unlabelled"} (${values[`${spec.name}_id`]})`,
  instance: (name, spec, values) =>
    values[`${spec.name}_id`] ? `${name} (${values[`${spec.name}_id`]})` : "none",
  depth: (value) => depthWords(value),
  flow: (value) => flowWords(value),
};

function numberWords(value, { unit }) {
  if (value === null) return "none";
  const words = [value].flat().map((x) => (typeof x === "number" && !Number.isInteger(x) ? fixed(x, 3) : String(x)));
  return `${words.join(", ")} ${unit}`.trim();
}

export function depthWords(depth) {
  if (depth === null) return "nothing hit";
  return depth === "near" ? "nearer than the near plane" : `${fixed(depth, 3)} m`;
}

export function flowWords(flow) {
  return flow === null ? "none" : `${fixed(flow[0], 1)}, ${fixed(flow[1], 1)} px/s`;
}
