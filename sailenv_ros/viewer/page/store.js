// @ts-check
// The state of the page, and who reacts to its changes: the only thing that modules share.

/** @import {FrameHead, HelloMessage, InstanceNews, ObjectMessage, Overlay, PixelValues, SceneMessage, StatsMessage} from "./messages.js" */

/** @typedef {{ width: number, height: number, fov_deg: number }} Lens */

/**
 * All that more than one module knows.
 *
 * @typedef {object} State
 * @property {boolean} online False from a lost connection to the next greeting.
 * @property {HelloMessage | null} hello What never changes, as it was told last.
 * @property {SceneMessage | null} scene The scene as it was told last.
 * @property {Map<number, InstanceNews>} instances Its objects by their ids.
 * @property {StatsMessage | null} stats
 * @property {FrameHead | null} frame The frame that is shown.
 * @property {string} agent Whose pictures are shown.
 * @property {Lens} lens The debug agent's.
 * @property {{ main: string, all: boolean, chosen: readonly string[] }} views The large view; whether the others are beside it; which are chosen.
 * @property {string} tab The panel that is open.
 * @property {number} selected Id of the selected object; 0 for none.
 * @property {ObjectMessage | null} object What the simulator tells of it.
 * @property {boolean} placing Whether the next click says where it stands.
 * @property {PixelValues | null} pixel The values under the pointer.
 * @property {{ boxes: boolean, space: boolean, whole: boolean, people: boolean, circle: boolean }} draws What is drawn over the picture.
 * @property {Overlay | null} overlay What is known for that.
 * @property {boolean} pathAlways Whether the waypoints are shown with any panel.
 */

/** @returns {State} */
function initial() {
  return {
    online: true, hello: null, scene: null, instances: new Map(), stats: null, frame: null,
    agent: "", lens: { width: 640, height: 480, fov_deg: 60 }, views: { main: "", all: true, chosen: [] },
    tab: "View", selected: 0, object: null, placing: false, pixel: null,
    draws: { boxes: false, space: false, whole: false, people: false, circle: false }, overlay: null, pathAlways: false,
  };
}

export class Store {
  /** @type {Readonly<State>} */
  #state = initial();
  /** @type {{ keys: readonly (keyof State)[], react: (state: Readonly<State>) => void }[]} */
  #readers = [];

  get state() {
    return this.#state;
  }

  /**
   * Change the state; those react who read what is another value now.
   * @param {Partial<State>} changes
   */
  set(changes) {
    const before = this.#state;
    this.#state = { ...before, ...changes };
    const names = /** @type {(keyof State)[]} */ (Object.keys(changes));
    const changed = new Set(names.filter((name) => before[name] !== changes[name]));
    for (const { keys, react } of this.#readers) {
      if (keys.some((key) => changed.has(key))) react(this.#state);
    }
  }

  /**
   * Have a function called after each change of some of the values, and with the state as it is then.
   * @param {readonly (keyof State)[]} keys
   * @param {(state: Readonly<State>) => void} react
   */
  on(keys, react) {
    this.#readers.push({ keys, react });
  }
}

// ---- what follows from the state

/** @param {Readonly<State>} state */
export const mayChange = ({ hello }) => hello?.control ?? false;

/** The agent that is shown. @param {Readonly<State>} state */
export const agentOf = ({ scene, agent }) => scene?.agents.find(({ name }) => name === agent);

/** Whether the debug agent is shown. @param {Readonly<State>} state */
export const showsOwnAgent = ({ agent, hello }) => agent === hello?.debug_agent;

/** The mover that it follows, or the first one. @param {Readonly<State>} state */
export function moverOf(state) {
  const movers = state.scene?.movers ?? [];
  return movers.find(({ name }) => name === agentOf(state)?.mover) ?? movers[0];
}

/** Whether keys and mouse drive that mover. @param {Readonly<State>} state */
export function drives(state) {
  const mover = moverOf(state);
  return mayChange(state) && mover?.controller === "rigidbody" && !mover.is_body;
}

/** The views that are shown. @param {Readonly<State>} state */
export const shownViews = ({ views }) => (views.all ? views.chosen : [views.main]);
