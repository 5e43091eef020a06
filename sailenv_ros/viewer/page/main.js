// @ts-check
// The page as a whole: its store, the socket, and the parts that share them.

import { Actions } from "./actions.js";
import { AddPanel } from "./add_panel.js";
import { Bar } from "./bar.js";
import { $, el, toast } from "./dom.js";
import { LightPanel } from "./light_panel.js";
import { Link } from "./link.js";
import { LookSelect } from "./look_select.js";
import { ObjectPanel } from "./object_panel.js";
import { followOverlay } from "./overlay.js";
import { PathPanel } from "./path_panel.js";
import { PicturePanel } from "./picture_panel.js";
import { Pointer } from "./pointer.js";
import { RoomPanel } from "./room_panel.js";
import { ScenePanel } from "./scene_panel.js";
import { Stage } from "./stage.js";
import { Store, mayChange, moverOf, showsOwnAgent } from "./store.js";
import { ViewPanel } from "./view_panel.js";
import { Walker } from "./walk.js";

/** @import {HelloMessage, News, SceneMessage} from "./messages.js" */

/** @typedef {{ title: string, root: HTMLElement }} Panel */

const store = new Store();
const link = new Link({
  news: take,
  frame: (head, pictures) => stage.show(head, pictures),
  offline: () => store.set({ online: false }),
});
const actions = new Actions(store, link);
const stage = new Stage(store, (head) => link.shown(head.number));
const walker = new Walker(store, actions, stage);

new Bar(store, actions);
new LookSelect(store, actions);
new Pointer(store, actions, stage, walker);
followOverlay(store, actions);
tabs([
  new ViewPanel(store, actions), new ObjectPanel(store, actions), new AddPanel(store, actions),
  new RoomPanel(store, actions), new LightPanel(store, actions), new PicturePanel(store, actions),
  new PathPanel(store, actions), new ScenePanel(store, actions),
]);
marks();
store.on(["agent", "views"], () => actions.watch());
link.connect();

// ---- what the simulator tells

/** @param {News} news */
function take(news) {
  if (news.type === "hello") greeted(news);
  else if (news.type === "scene") told(news);
  else if (news.type === "stats") store.set({ stats: news });
  else if (news.type === "watch_ended") lost(news.why);
  else if (news.id === store.state.selected) store.set({ object: news });
}

/** @param {HelloMessage} hello */
function greeted(hello) {
  const { agent, views, selected } = store.state;
  const known = hello.views.map(({ name }) => name);
  const chosen = views.chosen.filter((view) => known.includes(view));
  const first = hello.views.filter(({ shown }) => shown).map(({ name }) => name);
  const stay = chosen.length === views.chosen.length && chosen.length > 0;
  store.set({
    hello, online: true, agent: agent || hello.debug_agent,
    views: stay ? views : { ...views, chosen: first, main: first[0] ?? "" },
  });
  if (stay) actions.watch(); // of another connection
  if (selected) actions.select(selected);
}

/** @param {SceneMessage} scene */
function told(scene) {
  const { hello, lens, scene: before } = store.state;
  const own = scene.agents.find(({ name }) => name === hello?.debug_agent);
  store.set({
    scene,
    instances: new Map(scene.instances.map((instance) => [instance.id, instance])),
    lens: own ? { width: own.width, height: own.height, fov_deg: own.fov_deg } : lens,
  });
  const { selected, object, instances } = store.state;
  const gone = object !== null && !instances.has(object.id);
  if (selected && (gone || before?.epoch !== scene.epoch)) actions.select(0);
}

/** @param {string} why */
function lost(why) {
  toast(`No more pictures of ${store.state.agent}: ${why}`, "error");
  if (!showsOwnAgent(store.state)) store.set({ agent: store.state.hello?.debug_agent ?? "" });
}

// ---- panels

/** Offer the panels; one is shown. @param {readonly Panel[]} panels */
function tabs(panels) {
  const made = panels.map(({ title }) =>
    el("button", { role: "tab", data: { tab: title }, on: { click: () => store.set({ tab: title }) } }, title));
  $("tabs").append(...made);
  /** @param {string} tab */
  const open = (tab) => {
    const panel = panels.find(({ title }) => title === tab);
    $("panel").replaceChildren(...(panel ? [panel.root] : []));
    $("panel").scrollTop = 0;
    for (const button of made) button.setAttribute("aria-selected", String(button.dataset.tab === tab));
  };
  store.on(["tab"], (state) => open(state.tab));
  open(store.state.tab);
}

// ---- what the page says of itself, for its styles

function marks() {
  const begun = performance.now();
  const { body } = document;
  store.on(["online"], ({ online }) => {
    $("offline").hidden = online;
  });
  store.on(["hello"], (state) => body.classList.toggle("watching", !mayChange(state)));
  store.on(["scene", "agent"], (state) => {
    if (!state.scene) return;
    document.title = `${state.scene.scene} – SAILenv`;
    body.dataset.scene = state.scene.scene;
    body.dataset.epoch = String(state.scene.epoch);
    body.dataset.controller = moverOf(state)?.controller ?? "";
  });
  store.on(["selected"], ({ selected }) => {
    body.dataset.selected = String(selected);
  });
  store.on(["placing"], ({ placing }) => body.classList.toggle("placing", placing));
  store.on(["frame"], ({ frame }) => {
    body.dataset.frame = String(frame?.number ?? 0);
  });
  // Instead of the first picture, what is waited for, and how long by now.
  store.on(["stats"], ({ stats, frame }) => {
    if (frame) return;
    const seconds = Math.round((performance.now() - begun) / 1000);
    const what = stats?.building || "waiting for the first picture …";
    body.style.setProperty("--waiting", JSON.stringify(`${what} (${seconds} s)`));
  });
}
