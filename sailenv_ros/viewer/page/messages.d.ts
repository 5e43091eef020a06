// Messages of the viewer's socket. Written by scripts/page_messages.py from the declarations in
// Python; not to be edited.

/** A file as the page takes it from a binary message. */
export interface SentFile {
  name: string;
  blob: Blob;
}

/** The first message: what never changes while the page is open. */
export interface HelloMessage {
  type: "hello";
  control: boolean;
  debug_agent: string;
  views: ViewInfo[];
  behaviours: BehaviourInfo[];
  picture_settings: PictureSetting[];
  materials: string[];
  skies: string[];
  data_sets: string[];
}

/** A view that can be shown; `shown` if it is at first. */
export interface ViewInfo {
  name: string;
  meaning: string;
  unit: string;
  display: "colour" | "mosaic" | "depth" | "category" | "instance" | "flow" | "direction" | "mask" | "place" | "displacement";
  shown: boolean;
}

/** A kind of behaviour. */
export interface BehaviourInfo {
  type: string;
  summary: string;
  parameters: BehaviourParameter[];
}

/** A parameter of a kind of behaviour. */
export interface BehaviourParameter {
  name: string;
  about: string;
  needed: boolean;
  default: any;
}

/** A setting of pictures: `choices` is empty where it is no list, limits are null for none. */
export interface PictureSetting {
  name: string;
  default: number | boolean | string;
  choices: string[];
  whole: boolean;
  least: number | null;
  most: number | null;
  unit: string;
}

/** The scene, sent after each change of it. */
export interface SceneMessage {
  type: "scene";
  scene: string;
  scenes: string[];
  epoch: number;
  revision: number;
  mode: "realtime" | "lockstep";
  paused: boolean;
  real_time_factor: number;
  seed: number;
  renderer: string;
  categories: CategoryNews[];
  instances: InstanceNews[];
  spawnables: string[];
  lights: LightNews[];
  environment: EnvironmentNews;
  agents: AgentNews[];
  movers: MoverNews[];
}

/** A category: its id in the category view, its name, its colour in 0 to 255. */
export interface CategoryNews {
  id: number;
  name: string;
  colour: [number, number, number];
}

/** An object, or a part of one; `painted` lists the materials that it was given. */
export interface InstanceNews {
  id: number;
  name: string;
  asset: string;
  category_id: number;
  category: string;
  static: boolean;
  moves: boolean;
  materials: string[];
  painted: (Record<string, any>)[];
  parent: number;
  is_part: boolean;
}

/** A light; see `sailenv_ros.types.lights.Light`. */
export interface LightNews {
  name: string;
  type: "directional" | "point" | "spot" | "area";
  intensity: number;
  indirect_multiplier: number;
  range_m: number;
  colour: [number, number, number];
  position_m: [number, number, number];
  direction: [number, number, number];
}

/** The surroundings; see `sailenv_ros.types.lights.Environment`. */
export interface EnvironmentNews {
  ambient: [number, number, number];
  background: string;
  background_colour: [number, number, number];
  sky_map: string;
  sky_rotation: number;
  sky_blend: boolean;
  outside_factor: number;
  sky_share: number;
  exposure: number;
}

/** An agent: its camera, its picture, what it follows and faces. */
export interface AgentNews {
  name: string;
  width: number;
  height: number;
  fov_deg: number;
  rate_hz: number;
  following: boolean;
  mover: string;
  picture: Record<string, number | boolean | string>;
  look_at: LookAtNews | null;
}

/** A faced point, of an object where one is named [m]. */
export interface LookAtNews {
  object: string;
  point: [number, number, number];
}

/** A mover: its driver and its track. */
export interface MoverNews {
  name: string;
  controller: "waypoint" | "rigidbody";
  waypoints: PoseValues[];
  total_time_s: number;
  loop: boolean;
  is_body: boolean;
}

/** A pose: position [m] and roll, pitch, yaw [deg]. */
export interface PoseValues {
  position: [number, number, number];
  rpy_deg: [number, number, number];
}

/** How fast the simulation runs, what it builds, what can be undone; twice a second. */
export interface StatsMessage {
  type: "stats";
  time_s: number;
  real_time_factor: number;
  skipped_frames: number;
  viewers: number;
  building: string;
  capturing: string;
  undo: string;
  redo: string;
}

/** The selected object, sent when it is selected and when it has changed; null if it is gone. */
export interface ObjectMessage {
  type: "object";
  id: number;
  object: ObjectValues | null;
  joint: JointValues | null;
}

/** An object as it is now: scale, size [m], mass [kg] and what moves it. */
export interface ObjectValues {
  position: [number, number, number];
  rpy_deg: [number, number, number];
  id: number;
  name: string;
  asset: string;
  category: string;
  scale: [number, number, number];
  size: [number, number, number];
  static: boolean;
  mass_kg: number;
  behaviours: (Record<string, any>)[];
}

/** The joint that an object moves on: its place and its limits [rad] or [m]. */
export interface JointValues {
  type: "hinge" | "slide";
  position: number;
  low: number;
  high: number;
}

/** No more frames come of the watched agent, and why. */
export interface WatchEndedMessage {
  type: "watch_ended";
  why: string;
}

/** The result of a command. */
export interface ReplyMessage {
  type: "reply";
  id: number | null;
  result: any;
}

/** Why a command was not done, in a sentence. */
export interface RefusedMessage {
  type: "refused";
  id: number | null;
  error: string;
}

/** Head of a binary message; the pictures follow it in the order of `views`. */
export interface FrameHead {
  number: number;
  dropped: number;
  views: ViewOfFrame[];
  outline?: number[][];
  type: "frame";
  agent: string;
  scene: string;
  epoch: number;
  revision: number;
  sequence: number;
  time_s: number;
  width: number;
  height: number;
  fov_deg: number;
  lens: LensValues;
  position: [number, number, number];
  rpy_deg: [number, number, number];
  lesson: string;
  timings_ms: Record<string, number>;
  visible?: ([number, number])[];
}

/** One picture of a frame: its media type and its size in bytes. */
export interface ViewOfFrame {
  name: string;
  mime: string;
  size: number;
}

/** A lens: lengths in px, coefficients by name, how far from the axis it sees. */
export interface LensValues {
  model: string;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  coefficients: ([string, number])[];
  max_angle_deg: number | null;
}

/** Head of a binary message that answers a command by a file; its bytes follow. */
export interface FileHead {
  type: "file";
  id: number | null;
  name: string;
  mime: string;
}

/** The page has shown a frame; this alone is not answered. */
export interface ShownMessage {
  do: "shown";
  number: number;
}

/** Attributes of a light of a given type, by their names in `Light`. */
export interface LightAttributes {
  colour?: number | readonly number[];
  intensity?: number;
  indirect_multiplier?: number;
  position_m?: number | readonly number[];
  direction?: number | readonly number[];
  range_m?: number;
  inner_cone_deg?: number;
  outer_cone_deg?: number;
  exponent?: number;
  width_m?: number;
  height_m?: number;
}

/** A data set that was captured: the key of its address, ``captured/KEY``, and what it has. */
export interface CapturedDataSet {
  key: string;
  name: string;
  frames: number;
  bytes: number;
}

/** Keys of an object that can be changed; None takes the asset's own. It is moved otherwise. */
export interface ObjectChanges {
  name?: string;
  category?: string | null;
  scale?: number | readonly number[];
  static?: boolean;
  mass?: number | null;
  gravity?: boolean;
  friction?: number;
  restitution?: number;
  colour?: number | readonly number[] | string | null;
  metallic?: number | null;
  roughness?: number | null;
  materials?: readonly (Record<string, any>)[] | null;
}

/** The room and what stands in it, seen from above [m]; the size is null for no room. */
export interface FloorPlanValues {
  size: [number, number, number] | null;
  openings: PlannedOpening[];
  objects: PlannedObject[];
}

/** A window or a door in a floor plan: middle along its wall, and width [m]. */
export interface PlannedOpening {
  type: string;
  wall: string;
  at: number;
  width: number;
}

/** An object in a floor plan: the corners of its box seen from above [m]. */
export interface PlannedObject {
  id: number;
  name: string;
  corners: ([number, number])[];
}

/** The name by which a generated room is begun again. */
export interface RoomMade {
  scene: string;
}

/** Drawn over a frame [px]. */
export interface Overlay {
  boxes: ([number, number, number, number, number])[];
  edges: ([number, ([number, number, number, number])[]])[];
  whole: number[][];
  waypoints: ([number, number, number])[];
  track: ([number, number, number, number])[];
  circle: number[][];
  people: ([number, ([number, number, number, number])[], ([number, number, boolean])[]])[];
}

/** An object that was set down; `held` if it was made static to stay where it is. */
export interface PlacedObject {
  position: [number, number, number];
  rpy_deg: [number, number, number];
  id: number;
  name: string;
  asset: string;
  category: string;
  scale: [number, number, number];
  size: [number, number, number];
  static: boolean;
  mass_kg: number;
  behaviours: (Record<string, any>)[];
  held: boolean;
}

/** Values at a pixel, by the views' names; those of further views stand beside these. */
export interface PixelValues {
  u: number;
  v: number;
  sequence: number;
  category?: string;
  category_id?: number;
  instance?: string;
  instance_id?: number;
  depth?: number | "near" | null;
  flow?: [number, number] | null;
}

/** A change that was undone or done again, and the id of its object or 0. */
export interface UndoneStep {
  what: string;
  id: number;
}

/** A kind of room that can be generated. */
export interface RoomKind {
  kind: string;
  title: string;
}

/** Keys of the environment. */
export interface EnvironmentChanges {
  ambient?: number | readonly number[] | string;
  background?: "sky" | "colour";
  background_colour?: number | readonly number[] | string;
  sky_zenith?: number | readonly number[] | string;
  sky_horizon?: number | readonly number[] | string;
  sky_ground?: number | readonly number[] | string;
  sky_share?: number;
  sky_map?: string;
  sky_rotation?: number;
  sky_blend?: boolean;
  outside_factor?: number;
  exposure?: number;
  meter_exposure?: boolean;
}

/** Everything that can be changed of a light, by its names in `Light`. */
export interface LightChanges {
  colour?: number | readonly number[];
  intensity?: number;
  indirect_multiplier?: number;
  position_m?: number | readonly number[];
  direction?: number | readonly number[];
  range_m?: number;
  inner_cone_deg?: number;
  outer_cone_deg?: number;
  exponent?: number;
  width_m?: number;
  height_m?: number;
  type?: "directional" | "point" | "spot" | "area";
}

/** One light. */
export interface Light {
  name: string;
  type: "directional" | "point" | "spot" | "area";
  colour: [number, number, number];
  intensity: number;
  indirect_multiplier: number;
  position_m: [number, number, number];
  direction: [number, number, number];
  range_m: number;
  inner_cone_deg: number;
  outer_cone_deg: number;
  exponent: number;
  width_m: number;
  height_m: number;
}

/** Keys of a material, but for the part that it is of; None takes the asset's own. */
export interface MaterialChanges {
  material?: string | null;
  picture?: string | null;
  colour?: number | readonly number[] | string | null;
  tint?: number | readonly number[] | string | null;
  roughness?: number | null;
  metallic?: number | null;
  emission?: number | readonly number[] | string | null;
  tile?: number | readonly number[] | null;
  turn?: number | null;
  seed?: number | null;
  mapping?: "box" | "own" | null;
}

/** Settings that change the picture and the measured depth; those of the shutter, instants too. */
export interface PictureSettings {
  exposure: number;
  auto_exposure_s: number;
  tone_curve: "filmic" | "linear";
  occlusion_strength: number;
  occlusion_radius_m: number;
  smooth_edges: boolean;
  supersampling: number;
  bloom: number;
  full_well: number;
  read_noise: number;
  depth_sensor: string;
  exposure_time_ms: number;
  exposure_samples: number;
  row_time_us: number;
  read_out: "down" | "up";
  gain: number;
  vignetting: number;
  lateral_colour: number;
  dirt: number;
  white_balance: number;
  jpeg_quality: number;
}

/** Some settings, by their names in `PictureSettings`. */
export interface PictureChanges {
  exposure?: number;
  auto_exposure_s?: number;
  tone_curve?: "filmic" | "linear";
  occlusion_strength?: number;
  occlusion_radius_m?: number;
  smooth_edges?: boolean;
  supersampling?: number;
  bloom?: number;
  full_well?: number;
  read_noise?: number;
  depth_sensor?: string;
  exposure_time_ms?: number;
  exposure_samples?: number;
  row_time_us?: number;
  read_out?: "down" | "up";
  gain?: number;
  vignetting?: number;
  lateral_colour?: number;
  dirt?: number;
  white_balance?: number;
  jpeg_quality?: number;
}

/** The names of the objects whose places a new room has taken. */
export interface RoomSet {
  replaced: string[];
}

/** State of the lessons at an instant. */
export interface LessonState {
  phase: "lesson" | "pause" | "ended" | "stopped";
  lap: number;
  laps: number;
  number: number;
  count: number;
  name: string;
  objects: string[];
  begins_ns: number;
  ends_ns: number;
}

export type News = HelloMessage | SceneMessage | StatsMessage | ObjectMessage | WatchEndedMessage;

export type Answer = ReplyMessage | RefusedMessage;

export type Head = FrameHead | FileHead;

export type Shown = ShownMessage;

/** What can be asked for, by its name. */
export interface Commands {
  add_behaviour: { values: { obj: number | string; behaviour: Record<string, any> }; result: ObjectValues };
  add_light: { values: { light_type: "directional" | "point" | "spot" | "area"; light_name?: string | null; attributes?: LightAttributes | null }; result: string };
  add_robot: { values: { file: string; u: number; v: number; frame?: number | null; mount?: string }; result: number };
  add_waypoint: { values: { mover: string }; result: PoseValues };
  capture_data_set: { values: { format_name: string; agent: string; frames: number; rate_hz: number }; result: CapturedDataSet };
  change_object: { values: { obj: number | string; changes?: ObjectChanges }; result: ObjectValues };
  change_scene: { values: { scene: string }; result: null };
  despawn_object: { values: { obj: number | string }; result: null };
  drive_mover: { values: { linear_m_s?: number | readonly number[]; angular_rad_s?: number | readonly number[]; mover?: string }; result: null };
  floor_plan: { values: {}; result: FloorPlanValues };
  generate_room: { values: { kind: string; seed: number }; result: RoomMade };
  get_joint: { values: { obj: number }; result: JointValues | null };
  get_object: { values: { obj: number | string }; result: ObjectValues };
  lens: { values: { width: number; height: number; fov_deg: number }; result: null };
  move_object: { values: { obj: number | string; position?: number | readonly number[] | null; rotation?: number | readonly number[] | null; pose?: { position: readonly number[]; rotation: readonly number[] } | null; teleport?: boolean }; result: ObjectValues };
  overlay: { values: { whole?: number; boxes?: boolean; space?: boolean; circle?: boolean; people?: boolean; track?: string; frame?: number | null }; result: Overlay };
  pause: { values: {}; result: null };
  place: { values: { obj: number; u: number; v: number; frame?: number | null }; result: PlacedObject };
  probe: { values: { u: number; v: number; frame?: number | null }; result: PixelValues };
  randomise: { values: {}; result: number };
  redo: { values: {}; result: UndoneStep };
  remove_behaviours: { values: { obj: number | string }; result: ObjectValues };
  remove_light: { values: { light_name: string }; result: null };
  reset: { values: { seed?: number | null }; result: number };
  resume: { values: {}; result: null };
  room_kinds: { values: {}; result: RoomKind[] };
  save_scene: { values: { name: string; overwrite?: boolean; title?: string | null; cameras?: readonly string[]; keep_models?: boolean }; result: string };
  scene_text: { values: { title?: string | null; cameras?: readonly string[] }; result: string };
  screenshot: { values: { view: string; frame?: number | null }; result: SentFile };
  select: { values: { obj: number }; result: null };
  send_picture: { values: { data: string; first?: boolean; last?: boolean }; result: string | null };
  set_environment: { values: { changes?: EnvironmentChanges }; result: null };
  set_joint_position: { values: { obj: number | string; position: number; seconds?: number }; result: ObjectValues };
  set_light: { values: { light_name: string; changes?: LightChanges }; result: Light };
  set_look_at: { values: { obj?: number | string | null; point_m?: number | readonly number[] | null; agent?: string | null }; result: null };
  set_material: { values: { obj: number | string; part?: string; changes?: MaterialChanges }; result: ObjectValues };
  set_mover_controller: { values: { controller: "waypoint" | "rigidbody"; mover?: string }; result: null };
  set_picture: { values: { settings?: PictureSettings | null; agent?: string | null; changes?: PictureChanges }; result: PictureSettings };
  set_real_time_factor: { values: { factor: number }; result: null };
  set_room: { values: { size: readonly [number, number, number] }; result: RoomSet };
  set_waypoints: { values: { waypoints: readonly ({ position: readonly number[]; rotation: readonly number[] } | readonly [number | readonly number[], number | readonly number[]])[]; mover?: string; append?: boolean; total_time_s?: number | null; loop?: boolean | null }; result: null };
  sheet: { values: {}; result: SentFile };
  spawn: { values: { asset: string; u: number; v: number; frame?: number | null }; result: PlacedObject };
  start_lessons: { values: { lessons?: Record<string, any> | string | null }; result: LessonState };
  step: { values: { count?: number }; result: number };
  stop_capture: { values: {}; result: null };
  stop_lessons: { values: {}; result: null };
  turn_mover: { values: { pitch_rad?: number; yaw_rad?: number; mover?: string }; result: null };
  undo: { values: {}; result: UndoneStep };
  watch: { values: { agent: string; views: readonly string[] }; result: null };
}
