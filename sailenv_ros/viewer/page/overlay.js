// @ts-check
// What lies over the frame that is shown, in its pixels: asked of the simulator, which knows lenses.

import { moverOf } from "./store.js";

/** @import {Actions} from "./actions.js" */
/** @import {State, Store} from "./store.js" */

/**
 * Keep the state's `overlay` that of the frame that is shown; one question at a time.
 * @param {Store} store
 * @param {Actions} actions
 */
export function followOverlay(store, actions) {
  let asking = false;
  let again = false;
  let pointed = 0;

  const follow = async () => {
    again = asking;
    if (asking) return;
    const { draws, frame, pixel, overlay } = store.state;
    const track = shownTrack(store.state);
    if (!track && !Object.values(draws).some(Boolean)) {
      if (overlay) store.set({ overlay: null });
      return;
    }
    if (!frame) return;
    const whole = draws.whole ? (pixel?.instance_id ?? 0) : 0;
    asking = true;
    try {
      store.set({ overlay: await actions.ask("overlay", { ...draws, frame: frame.number, whole, track }) });
    } catch {
      // The frame is no longer kept, or the mover is gone; the next frame is asked for.
    }
    asking = false;
    if (again) follow();
  };

  store.on(["frame", "draws", "scene", "agent", "tab", "pathAlways"], () => follow());
  store.on(["pixel"], ({ pixel }) => {
    const now = pixel?.instance_id ?? 0;
    if (pixel && now !== pointed) follow();
    pointed = now;
  });
}

/** The name of the mover whose track is shown; empty for none. @param {Readonly<State>} state */
function shownTrack(state) {
  return state.tab === "Path" || state.pathAlways ? (moverOf(state)?.name ?? "") : "";
}
