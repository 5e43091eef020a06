// @ts-check
// What is known of the objects of the frame that is shown, to be drawn over it.

/** @import {Actions} from "./actions.js" */
/** @import {Store} from "./store.js" */

/**
 * Keep the state's `overlay` that of the frame that is shown; one question at a time.
 * @param {Store} store
 * @param {Actions} actions
 */
export function followObjects(store, actions) {
  let asking = false;
  let pointed = 0;

  const follow = async () => {
    const { draws, frame, pixel, overlay } = store.state;
    if (!draws.boxes && !draws.space && !draws.whole) {
      if (overlay) store.set({ overlay: null });
      return;
    }
    if (asking || !frame) return;
    asking = true;
    try {
      const whole = draws.whole ? (pixel?.instance_id ?? 0) : 0;
      store.set({
        overlay: await actions.ask("objects", { frame: frame.number, boxes: draws.boxes, space: draws.space, whole }),
      });
    } catch {
      // The frame is no longer kept; the next one is asked for.
    }
    asking = false;
  };

  store.on(["frame", "draws"], () => follow());
  store.on(["pixel"], ({ pixel }) => {
    const now = pixel?.instance_id ?? 0;
    if (pixel && now !== pointed) follow();
    pointed = now;
  });
}
