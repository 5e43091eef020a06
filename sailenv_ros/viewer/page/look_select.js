// What the agent that is shown keeps looking at: a list of nothing and all objects.

import { el, put } from "./dom.js";

const NOTHING = "";
const ELSEWHERE = "elsewhere";

export class LookSelect {
  constructor(app, select) {
    this.app = app;
    this.select = select;
    select.addEventListener("change", () => {
      this.choose(select.value);
      select.blur();
    });
  }

  get agent() {
    return this.app.scene?.agents.find(({ name }) => name === this.app.agent);
  }

  /** Show what the scene tells; a refused choice is taken back so, too. */
  update() {
    const agent = this.agent;
    this.select.disabled = !agent || !this.app.control;
    const objects = this.app.scene.instances.filter((instance) => !instance.is_part);
    objects.sort((one, other) => one.name.localeCompare(other.name));
    const faced = agent?.look_at;
    const found = objects.find(({ name }) => name === faced?.object);
    const wanted = [[NOTHING, "nothing"], ...objects.map(({ id, name }) => [String(id), name])];
    // What a program has set and this list cannot: a point of the world or of an object, an object that waits.
    const elsewhere = faced && (!found || faced.point.some((value) => value !== 0));
    if (elsewhere) wanted.push([ELSEWHERE, words(faced)]);
    const told = JSON.stringify(wanted);
    if (told !== this.told) {
      this.told = told;
      this.select.replaceChildren(...wanted.map(([value, text]) => el("option", { value, disabled: value === ELSEWHERE }, text)));
    }
    put(this.select, elsewhere ? ELSEWHERE : found ? String(found.id) : NOTHING);
  }

  /** Turning by hand ends it, as turning a mover ends what the mover faces. */
  release() {
    if (!this.agent?.look_at || !this.agent.following) return;
    this.agent.look_at = null;
    this.choose(NOTHING);
  }

  async choose(value) {
    await this.app.try("set_look_at", { agent: this.app.agent, obj: Number(value) || null });
    this.update();
  }
}

const words = ({ object, point }) => {
  const place = `(${point.map((value) => Number(value.toFixed(2))).join(", ")})`;
  return object ? `${object} at ${place}` : place;
};
