// What the server answers (src/inspection/session_view.cpp, view_json.cpp, view_server.cpp). Lengths in metres, frame W.

export interface Summary {
  title: string;
  before: string | null;
  input: string;
  input_kind: string;
  created_utc: string;
  saccade_version: string;
  state: "exploring" | "complete" | "interrupted";
  camera: { width: number; height: number; fx: number; fy: number; cx: number; cy: number };
  leaf_size_m: number;
  leaves: number;
  tick: number;
  frames: number;
  keyframes: number[];
  ior_limit: number;
  mf: number;
  config: string;
}

/** Columns over all frames. */
export interface Frames {
  name: string[];
  stamp_s: number[];
  tracking: ("tracked" | "weak" | "lost")[];
  /** T_WC as x y z qx qy qz qw; null when lost. */
  pose: (number[] | null)[];
  /** The map's tick after the frame. */
  tick: number[];
  open: number[];
  inhibited: number[];
  attended: number[];
  ms: number[];
  rms_m: number[];
  revisit: number[];
}

export type Box3d = [number, number, number, number, number, number];

export interface Candidate {
  rank: number;
  score: number;
  source: string;
  box: [number, number, number, number];
  box3d: Box3d | null;
  revisited: number;
}

export interface SceneObject {
  id: number;
  box3d: Box3d;
  leaves: number;
  /** Tick and rank. */
  looks: [number, number][];
  /** Tick and number of leaves whose flag went on. */
  flags: [number, number][];
  inhibited: number;
  first_expiry: number;
  last_expiry: number;
}

export interface Leaf {
  key: [number, number, number];
  low_m: [number, number, number];
  edge_m: number;
  state: "occupied" | "free";
  occupancy: number;
  log_odds: number;
  color: [number, number, number];
  normal: [number, number, number];
  observations: number;
  tick: number;
  ior_weight: number;
  inhibited: boolean;
  forgotten_at_tick: number | null;
  attentions: { tick: number; frame: number; rank: number }[];
}

/** Root of a tile: corner key, depth, and a number that changes with the tile's content. */
export type TileRow = [number, number, number, number, number];
export type Layer = "color" | "saliency" | "map" | "ior";

async function get(question: string): Promise<Response> {
  const answer = await fetch(`api/${question}`);
  if (!answer.ok) throw new Error(`${question}: ${(await answer.text()).trim()}`);
  return answer;
}
const json = async <T>(question: string): Promise<T> => (await get(question)).json() as Promise<T>;
const bytes = async (question: string): Promise<ArrayBuffer> => (await get(question)).arrayBuffer();

export const ask = {
  summary: () => json<Summary>("summary"),
  frames: () => json<Frames>("frames"),
  candidates: (frame: number) => json<Candidate[]>(`candidates?frame=${frame}`),
  objects: (tick: number) => json<SceneObject[]>(`objects?tick=${tick}`),
  leaf: (x: number, y: number, z: number) => json<Leaf | null>(`leaf?x=${x}&y=${y}&z=${z}`),
  tileList: () => json<TileRow[]>("tilelist"),
  allTiles: async (depth: number) => (await get(`tiles?depth=${depth}`)).body!,
  tile: ([x, y, z, root]: TileRow, depth: number) => bytes(`tile?x=${x}&y=${y}&z=${z}&root=${root}&depth=${depth}`),
  attention: (tick: number) => bytes(`attention?tick=${tick}`),
  lastSeen: () => bytes("lastseen"),
  difference: () => bytes("difference"),
  pictureUrl: (frame: number, layer: Layer) => `api/picture?frame=${frame}&layer=${layer}`,
  cropUrl: (id: number) => `api/crop?id=${id}`,
};
