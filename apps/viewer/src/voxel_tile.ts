// Voxels of a tile as the server encodes them (include/saccade/inspection/voxel_tile.hpp), and entries for single leaves.

export const kDepth = 16;
export const kCentreKey = 32768;
const kTileBits = 18;

export const tileName = (x: number, y: number, z: number): string => `${x},${y},${z}`;

/** All occupied voxels of one depth in a tile. */
export class VoxelTile {
  readonly corner: [number, number, number];
  readonly rootDepth: number;
  readonly depth: number;
  readonly count: number;
  /** 12 bytes a voxel: cell x y z, log2 edge, r g b, occupancy, normal x y z, open faces. */
  readonly records: Uint8Array;
  readonly normals: Int8Array;
  /** Expiry tick (bits 1-31) and flag (bit 0). */
  readonly ior: Uint32Array;
  readonly byteLength: number;

  constructor(bytes: ArrayBuffer, offset = 0) {
    const view = new DataView(bytes, offset);
    if (view.getUint32(0, true) !== 0x31545653) throw new Error("the server sent something that is no tile");
    this.corner = [view.getUint16(4, true), view.getUint16(6, true), view.getUint16(8, true)];
    this.rootDepth = view.getUint8(10);
    this.depth = view.getUint8(11);
    this.count = view.getUint32(12, true);
    this.byteLength = 16 + 16 * this.count;
    this.records = new Uint8Array(bytes, offset + 16, 12 * this.count).slice();
    this.normals = new Int8Array(this.records.buffer);
    this.ior = new Uint32Array(bytes.slice(offset + 16 + 12 * this.count, offset + this.byteLength));
  }

  get name(): string {
    return tileName(...this.corner);
  }
  /** Edge of a voxel of this depth, in leaves. */
  get step(): number {
    return 2 ** (kDepth - this.depth);
  }
}

/** Tiles out of a stream in which they stand one after another. */
export async function* readTiles(stream: ReadableStream<Uint8Array>): AsyncGenerator<VoxelTile> {
  const reader = stream.getReader();
  let held = new Uint8Array(0);
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    const joined = new Uint8Array(held.length + value.length);
    joined.set(held);
    joined.set(value, held.length);
    let at = 0;
    while (joined.length - at >= 16) {
      const size = 16 + 16 * new DataView(joined.buffer, at + 12).getUint32(0, true);
      if (joined.length - at < size) break;
      yield new VoxelTile(joined.buffer, at);
      at += size;
    }
    held = joined.slice(at);
  }
  if (held.length > 0) throw new Error("the server broke off in the middle of a tile");
}

const everyThird = (code: number): number => {
  let value = 0;
  for (let bit = 0; bit < 6; ++bit) value |= ((code >> (3 * bit)) & 1) << bit;
  return value;
};

/** A value for single leaves, for blocks of leaves, tile by tile; coarser voxels have the largest of their leaves'. */
export class LeafValues {
  /** By tile, then by cell x | y << 6 | z << 12 of the finest depth. */
  private readonly tiles = new Map<string, Map<number, number>>();
  private readonly coarse = new Map<string, Map<number, number>>();

  /** `valueOf` an entry's bits above the Morton code; `edgeOf` the leaves along an edge that it stands for. */
  constructor(bytes: ArrayBuffer, valueOf: (rest: number) => number, edgeOf: (rest: number) => number) {
    const view = new DataView(bytes);
    for (let at = 0; at < view.byteLength; ) {
      const name = tileName(view.getUint16(at, true), view.getUint16(at + 2, true), view.getUint16(at + 4, true));
      const count = view.getUint32(at + 8, true);
      at += 12;
      const cells = new Map<number, number>();
      for (let i = 0; i < count; ++i, at += 4) {
        const entry = view.getUint32(at, true);
        const rest = entry >>> kTileBits;
        const x = everyThird(entry), y = everyThird(entry >> 1), z = everyThird(entry >> 2);
        const value = valueOf(rest), edge = edgeOf(rest);
        for (let k = 0; k < edge ** 3; ++k) {
          const dx = k % edge, dy = Math.floor(k / edge) % edge, dz = Math.floor(k / edge / edge);
          cells.set((x + dx) | ((y + dy) << 6) | ((z + dz) << 12), value);
        }
      }
      this.tiles.set(name, cells);
    }
  }

  /** Values of a tile's voxels of a depth, by cell x | y << 6 | z << 12 of that depth. */
  at(name: string, depth: number): Map<number, number> | undefined {
    const fine = this.tiles.get(name);
    const shift = kDepth - depth;
    if (fine === undefined || shift === 0) return fine;
    const key = `${name}/${depth}`;
    let cells = this.coarse.get(key);
    if (cells === undefined) {
      cells = new Map();
      for (const [cell, value] of fine) {
        const x = (cell & 63) >> shift, y = ((cell >> 6) & 63) >> shift, z = (cell >> 12) >> shift;
        const to = x | (y << 6) | (z << 12);
        cells.set(to, Math.max(cells.get(to) ?? 0, value));
      }
      this.coarse.set(key, cells);
    }
    return cells;
  }

  /** Calls `visit` with the key and value of every leaf. */
  forEachLeaf(visit: (x: number, y: number, z: number, value: number) => void): void {
    for (const [name, cells] of this.tiles) {
      const [x, y, z] = name.split(",").map(Number);
      for (const [cell, value] of cells) visit(x + (cell & 63), y + ((cell >> 6) & 63), z + (cell >> 12), value);
    }
  }
}

/** Weight and, as 4096, the flag. */
export const attentionValues = (bytes: ArrayBuffer): LeafValues =>
  new LeafValues(bytes, (rest) => (rest >> 2) | ((rest & 1) << 12), (rest) => ((rest & 2) !== 0 ? 2 : 1));
/** Share of the frames, 0..16383. */
export const lastSeenValues = (bytes: ArrayBuffer): LeafValues => new LeafValues(bytes, (rest) => rest + 1, () => 4);
/** 1 appeared, 2 gone, 3 gained attention. */
export const differenceValues = (bytes: ArrayBuffer): LeafValues => new LeafValues(bytes, (rest) => rest & 3, () => 1);
