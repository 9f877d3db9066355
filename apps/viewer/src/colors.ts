// How voxels are painted. All colours are sRGB bytes.
import { kCentreKey, LeafValues, VoxelTile } from "./voxel_tile";

export type Mode = "color" | "height" | "occupancy" | "weight" | "flag" | "lastseen" | "difference";
type Rgb = readonly [number, number, number];

const kViridis: Rgb[] = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
];
const kHeat: Rgb[] = [[70, 20, 24], [150, 28, 32], [214, 62, 30], [245, 130, 32], [253, 197, 50], [255, 245, 160]];
const kChanges: Rgb[] = [[0, 0, 0], [46, 196, 110], [232, 72, 72], [245, 170, 40]];
const kInhibited: Rgb = [255, 255, 255];

function along(ramp: Rgb[], share: number): Rgb {
  const place = Math.min(Math.max(share, 0), 1) * (ramp.length - 1);
  const i = Math.min(Math.floor(place), ramp.length - 2), t = place - i;
  const mix = (k: 0 | 1 | 2): number => ramp[i][k] + t * (ramp[i + 1][k] - ramp[i][k]);
  return [mix(0), mix(1), mix(2)];
}

/** Everything that colours depend on besides the tile. */
export interface Paint {
  mode: Mode;
  up: readonly [number, number, number];
  leaf_m: number;
  height_m: readonly [number, number];
  /** Tick that the attention is shown at. */
  tick: number;
  /** Weight that is painted brightest. */
  most_weight: number;
  /** Attention of an earlier tick; undefined: what the tiles say themselves. */
  attention?: LeafValues;
  lastSeen?: LeafValues;
  difference?: LeafValues;
}

/** Fills `out` (4 bytes a voxel) with the colours of a tile. */
export function paintTile(tile: VoxelTile, paint: Paint, out: Uint8Array): void {
  const { records, normals, ior } = tile;
  const mode = paint.mode, [ux, uy, uz] = paint.up;
  const cells =
    mode === "weight" || mode === "flag" ? paint.attention?.at(tile.name, tile.depth)
    : mode === "lastseen" ? paint.lastSeen?.at(tile.name, tile.depth)
    : mode === "difference" ? paint.difference?.at(tile.name, tile.depth)
    : undefined;
  const step_m = tile.step * paint.leaf_m;
  const origin = tile.corner.map((c) => (c - kCentreKey) * paint.leaf_m);
  const [low, high] = paint.height_m;
  for (let i = 0; i < tile.count; ++i) {
    const r = 12 * i;
    const x = records[r], y = records[r + 1], z = records[r + 2];
    const red = records[r + 4], green = records[r + 5], blue = records[r + 6];
    const lit = 0.8 + (0.2 * (normals[r + 8] * ux + normals[r + 9] * uy + normals[r + 10] * uz)) / 127;
    const grey = (0.3 * red + 0.59 * green + 0.11 * blue) * 0.38 + 26;
    let color: Rgb = [grey, grey, grey], light = 1;
    if (mode === "color") {
      color = [red, green, blue];
    } else if (mode === "height") {
      const height = (origin[0] + (x + 0.5) * step_m) * ux + (origin[1] + (y + 0.5) * step_m) * uy +
        (origin[2] + (z + 0.5) * step_m) * uz;
      color = along(kViridis, (height - low) / (high - low || 1));
      light = lit;
    } else if (mode === "occupancy") {
      color = along(kViridis, (records[r + 7] / 255 - 0.5) / 0.5);
      light = lit;
    } else {
      const value = cells?.get(x | (y << 6) | (z << 12)) ?? 0;
      if (mode === "lastseen") {
        if (value > 0) color = along(kViridis, (value - 1) / 16383);
        light = value > 0 ? lit : 1;
      } else if (mode === "difference") {
        if (value > 0) color = kChanges[value];
      } else {
        const own = Math.max(0, (ior[i] >>> 1) - paint.tick);
        const weight = paint.attention === undefined ? own : value & 4095;
        const flag = paint.attention === undefined ? own > 0 && (ior[i] & 1) !== 0 : (value & 4096) !== 0;
        if (mode === "flag") color = flag ? kInhibited : color;
        else if (weight > 0) color = along(kHeat, (weight - 1) / Math.max(1, paint.most_weight - 1));
      }
    }
    const o = 4 * i;
    out[o] = color[0] * light;
    out[o + 1] = color[1] * light;
    out[o + 2] = color[2] * light;
    out[o + 3] = 255;
  }
}

export interface Legend {
  title: string;
  /** CSS background of a bar from `low` to `high`; or swatches. */
  bar?: string;
  low?: string;
  high?: string;
  swatches?: [string, string][];
}

const css = (c: Rgb): string => `rgb(${c.map(Math.round).join(" ")})`;
const gradient = (ramp: Rgb[]): string => `linear-gradient(90deg, ${ramp.map(css).join(", ")})`;

export function legendOf(paint: Paint, lastStamp_s: number): Legend {
  switch (paint.mode) {
    case "color":
      return { title: "Colour, the mean of what was seen" };
    case "height":
      return { title: "Height", bar: gradient(kViridis), low: `${paint.height_m[0].toFixed(2)} m`, high: `${paint.height_m[1].toFixed(2)} m` };
    case "occupancy":
      return { title: "Occupancy", bar: gradient(kViridis), low: "0.5", high: "1" };
    case "weight":
      return { title: `IOR weight at tick ${paint.tick}`, bar: gradient(kHeat), low: "1 tick", high: `${paint.most_weight} ticks until forgotten` };
    case "flag":
      return { title: `IOR flag at tick ${paint.tick}`, swatches: [[css(kInhibited), "inhibited"], ["rgb(80 80 80)", "open"]] };
    case "lastseen":
      return { title: "Last in view", bar: gradient(kViridis), low: "first frame", high: `${lastStamp_s.toFixed(0)} s` };
    case "difference":
      return {
        title: "Changes since the earlier session",
        swatches: [[css(kChanges[1]), "appeared"], [css(kChanges[2]), "gone"], [css(kChanges[3]), "gained attention"]],
      };
  }
}
export const goneColor = 0xe84848;
