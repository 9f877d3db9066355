// The map in three.js: tiles at the level of detail that the camera asks for, as points or, from near by, as cubes.
import * as THREE from "three";
import { paintTile, type Paint } from "./colors";
import { ask, type TileRow } from "./protocol";
import { kCentreKey, kDepth, readTiles, tileName, VoxelTile } from "./voxel_tile";

const kCoarsest = 13;
const kVoxel_px = 2.6; // edge of a voxel on the screen that the level of detail aims at
const kCube_px = 7; // larger voxels are drawn as cubes
const kMovingBudget = 60_000; // voxels while the camera moves, and at rest
const kRestingBudget = 900_000;
const kKeptVoxels = 3_000_000;
const kFetches = 4;

const kCut = `
  uniform vec3 clipLow, clipHigh, up; uniform vec2 slice;
  bool cut(vec3 p) {
    float h = dot(p, up);
    return any(lessThan(p, clipLow)) || any(greaterThan(p, clipHigh)) || h < slice.x || h > slice.y;
  }`;
const kPointVertex = `
  attribute vec4 paint; attribute float edge; uniform float scale; varying vec3 shown; ${kCut}
  void main() {
    shown = paint.rgb;
    gl_Position = cut(position) ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * viewMatrix * vec4(position, 1.0);
    gl_PointSize = max(1.0, 1.45 * edge * scale / gl_Position.w);
  }`;
const kCubeVertex = `
  attribute vec3 place; attribute vec4 paint; attribute float edge; uniform vec3 eye; uniform vec3 away; varying vec3 shown; ${kCut}
  void main() {
    // Only the three faces that can be seen exist; they are turned to the camera.
    vec3 side = away == vec3(0.0) ? eye - place : -away;
    side = vec3(side.x < 0.0 ? -1.0 : 1.0, side.y < 0.0 ? -1.0 : 1.0, side.z < 0.0 ? -1.0 : 1.0);
    shown = paint.rgb * (normal.x > 0.5 ? 0.86 : normal.y > 0.5 ? 0.93 : 1.0);
    gl_Position = cut(place) ? vec4(2.0, 2.0, 2.0, 1.0)
      : projectionMatrix * viewMatrix * vec4(place + side * position * edge, 1.0);
  }`;
const kFragment = `varying vec3 shown; void main() { gl_FragColor = vec4(shown, 1.0); }`;

function threeFaces(): { position: THREE.BufferAttribute; normal: THREE.BufferAttribute; index: number[] } {
  const position: number[] = [], normal: number[] = [], index: number[] = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (const [a, b] of [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) {
      const p = [0, 0, 0], n = [0, 0, 0];
      p[axis] = 0.5;
      p[(axis + 1) % 3] = a;
      p[(axis + 2) % 3] = b;
      n[axis] = 1;
      position.push(...p);
      normal.push(...n);
    }
    index.push(...[0, 1, 2, 0, 2, 3].map((i) => i + 4 * axis));
  }
  return {
    position: new THREE.BufferAttribute(new Float32Array(position), 3),
    normal: new THREE.BufferAttribute(new Float32Array(normal), 3),
    index,
  };
}

/** One level of one tile with its meshes. */
class Level {
  readonly colors: Uint8Array;
  painted = -1; // version of the paint
  lastShown = 0;
  readonly extent = new THREE.Box3();
  points?: THREE.Points;
  cubes?: THREE.Mesh;
  private readonly place: Float32Array;
  private readonly edge: Float32Array;
  private readonly attributes: THREE.BufferAttribute[] = [];

  constructor(readonly voxels: VoxelTile, readonly checksum: number, leaf_m: number, readonly sphere: THREE.Sphere) {
    const n = voxels.count, step = voxels.step * leaf_m;
    this.colors = new Uint8Array(4 * n);
    this.place = new Float32Array(3 * n);
    this.edge = new Float32Array(n);
    for (let i = 0; i < n; ++i) {
      const cells = 2 ** voxels.records[12 * i + 3];
      this.edge[i] = cells * step;
      for (let k = 0; k < 3; ++k) {
        this.place[3 * i + k] =
          (voxels.corner[k] - kCentreKey) * leaf_m + (voxels.records[12 * i + k] + 0.5 * cells) * step;
      }
    }
    this.extent.setFromArray(this.place);
    if (n > 0) this.extent.expandByScalar(0.5 * step);
  }

  repaint(): void {
    for (const attribute of this.attributes) attribute.needsUpdate = true;
  }
  mesh(asCubes: boolean, points: THREE.Material, cubes: THREE.Material): THREE.Object3D {
    if (asCubes) return (this.cubes ??= this.makeCubes(cubes));
    return (this.points ??= this.makePoints(points));
  }
  dispose(): void {
    this.points?.geometry.dispose();
    this.cubes?.geometry.dispose();
  }
  /** Distance along the ray to the first voxel it meets that `visible` accepts, and which it is. */
  intersect(ray: THREE.Ray, visible: (p: THREE.Vector3) => boolean): { distance: number; centre: THREE.Vector3; edge: number } | null {
    const box = new THREE.Box3(), hit = new THREE.Vector3(), centre = new THREE.Vector3(), size = new THREE.Vector3();
    let best: { distance: number; centre: THREE.Vector3; edge: number } | null = null;
    for (let i = 0; i < this.voxels.count; ++i) {
      centre.fromArray(this.place, 3 * i);
      if (ray.distanceSqToPoint(centre) > 0.75 * this.edge[i] ** 2 || !visible(centre)) continue;
      if (ray.intersectBox(box.setFromCenterAndSize(centre, size.setScalar(this.edge[i])), hit) === null) continue;
      const distance = hit.distanceTo(ray.origin);
      if (best === null || distance < best.distance) best = { distance, centre: centre.clone(), edge: this.edge[i] };
    }
    return best;
  }

  private finish<T extends THREE.Object3D & { geometry: THREE.BufferGeometry }>(mesh: T): T {
    mesh.geometry.boundingSphere = this.sphere;
    mesh.matrixAutoUpdate = false;
    return mesh;
  }
  private makePoints(material: THREE.Material): THREE.Points {
    const geometry = new THREE.BufferGeometry();
    const paint = new THREE.BufferAttribute(this.colors, 4, true);
    this.attributes.push(paint);
    geometry.setAttribute("position", new THREE.BufferAttribute(this.place, 3));
    geometry.setAttribute("edge", new THREE.BufferAttribute(this.edge, 1));
    geometry.setAttribute("paint", paint);
    return this.finish(new THREE.Points(geometry, material));
  }
  private makeCubes(material: THREE.Material): THREE.Mesh {
    const geometry = new THREE.InstancedBufferGeometry();
    const { position, normal, index } = threeFaces();
    const paint = new THREE.InstancedBufferAttribute(this.colors, 4, true);
    this.attributes.push(paint);
    geometry.setIndex(index);
    geometry.setAttribute("position", position);
    geometry.setAttribute("normal", normal);
    geometry.setAttribute("place", new THREE.InstancedBufferAttribute(this.place, 3));
    geometry.setAttribute("edge", new THREE.InstancedBufferAttribute(this.edge, 1));
    geometry.setAttribute("paint", paint);
    geometry.instanceCount = this.voxels.count;
    return this.finish(new THREE.Mesh(geometry, material));
  }
}

interface Tile {
  row: TileRow;
  sphere: THREE.Sphere;
  box: THREE.Box3;
  levels: Map<number, Level>;
  pending: Set<number>;
  shown?: THREE.Object3D;
  shownLevel?: Level;
}

export type AnyCamera = THREE.PerspectiveCamera | THREE.OrthographicCamera;

export class VoxelScene {
  readonly group = new THREE.Group();
  /** Voxels that are drawn now. */
  shownVoxels = 0;
  /** Where the voxels that have been loaded lie. */
  readonly box = new THREE.Box3();
  private readonly tiles = new Map<string, Tile>();
  private readonly uniforms = {
    clipLow: { value: new THREE.Vector3().setScalar(-1e9) },
    clipHigh: { value: new THREE.Vector3().setScalar(1e9) },
    up: { value: new THREE.Vector3(0, -1, 0) },
    slice: { value: new THREE.Vector2(-1e9, 1e9) },
    scale: { value: 1 },
    eye: { value: new THREE.Vector3() },
    away: { value: new THREE.Vector3() },
  };
  private readonly pointMaterial = new THREE.ShaderMaterial({ uniforms: this.uniforms, vertexShader: kPointVertex, fragmentShader: kFragment });
  private readonly cubeMaterial = new THREE.ShaderMaterial({ uniforms: this.uniforms, vertexShader: kCubeVertex, fragmentShader: kFragment, side: THREE.DoubleSide });
  private paintVersion = 0;
  private frame = 0;
  private fetching = 0;
  private wanted: { tile: Tile; depth: number; size_px: number }[] = [];
  private movingPressure = 1; // above 1: coarser, because the last frames took too long

  constructor(private readonly leaf_m: number, private paint: Paint, private readonly changed: () => void) {}

  /** All tiles coarsely, in the order in which they come; `progress` after some of them. */
  async load(progress: (tiles: number) => void): Promise<void> {
    const rows = new Map((await ask.tileList()).map((row) => [tileName(row[0], row[1], row[2]), row]));
    let count = 0;
    for await (const voxels of readTiles(await ask.allTiles(kCoarsest))) {
      const row = rows.get(voxels.name) ?? [...voxels.corner, voxels.rootDepth, 0];
      if (voxels.count > 0) this.addLevel(this.tileOf(row), voxels);
      if (++count % 64 === 0) progress(count);
    }
    progress(count);
  }

  /** Takes note of tiles that changed in a session that grows. */
  async refresh(): Promise<void> {
    const rows = await ask.tileList();
    for (const row of rows) {
      const known = this.tiles.get(tileName(row[0], row[1], row[2]));
      if (known !== undefined && known.row[4] === row[4]) continue;
      const tile = this.tileOf(row);
      tile.row = row;
      this.fetch(tile, kCoarsest);
    }
    this.changed();
  }

  setPaint(paint: Paint): void {
    this.paint = paint;
    this.uniforms.up.value.set(...paint.up);
    ++this.paintVersion;
    this.changed();
  }
  setClip(low: THREE.Vector3, high: THREE.Vector3): void {
    this.uniforms.clipLow.value.copy(low);
    this.uniforms.clipHigh.value.copy(high);
    this.changed();
  }
  setSlice(low: number, high: number): void {
    this.uniforms.slice.value.set(low, high);
    this.changed();
  }
  visible(p: THREE.Vector3): boolean {
    const { clipLow, clipHigh, up, slice } = this.uniforms;
    const height = p.dot(up.value);
    return new THREE.Box3(clipLow.value, clipHigh.value).containsPoint(p) && height >= slice.value.x && height <= slice.value.y;
  }

  /** Normals of the coarse voxels, to find which way is up. */
  forEachNormal(visit: (x: number, y: number, z: number) => void): void {
    for (const tile of this.tiles.values()) {
      const voxels = tile.levels.get(kCoarsest)?.voxels;
      for (let i = 0; voxels !== undefined && i < voxels.count; ++i) {
        visit(voxels.normals[12 * i + 8] / 127, voxels.normals[12 * i + 9] / 127, voxels.normals[12 * i + 10] / 127);
      }
    }
  }
  /** Heights along `up` between which all but the outermost 1 % of the coarse voxels lie. */
  heights(up: THREE.Vector3): [number, number] {
    const heights: number[] = [];
    const p = new THREE.Vector3();
    for (const tile of this.tiles.values()) {
      const place = tile.levels.get(kCoarsest)?.mesh(false, this.pointMaterial, this.cubeMaterial) as THREE.Points | undefined;
      const position = place?.geometry.getAttribute("position");
      for (let i = 0; position !== undefined && i < position.count; ++i) heights.push(p.fromBufferAttribute(position as THREE.BufferAttribute, i).dot(up));
    }
    if (heights.length === 0) return [0, 1];
    heights.sort((a, b) => a - b);
    return [heights[Math.floor(0.01 * heights.length)], heights[Math.floor(0.99 * (heights.length - 1))]];
  }

  /** Chooses levels for the camera and brings the group up to date. `height_px`: of the picture. */
  update(camera: AnyCamera, height_px: number, moving: boolean, lastFrame_ms: number): void {
    ++this.frame;
    if (moving) {
      this.movingPressure = Math.min(6, Math.max(1, this.movingPressure * (lastFrame_ms > 30 ? 1.12 : lastFrame_ms < 22 ? 0.96 : 1)));
    }
    const perspective = camera instanceof THREE.PerspectiveCamera;
    const focal_px = perspective ? height_px / 2 / Math.tan((camera.fov * Math.PI) / 360) : 0;
    this.uniforms.scale.value = perspective ? focal_px : (height_px * camera.zoom) / (camera.top - camera.bottom);
    this.uniforms.eye.value.copy(camera.position);
    if (perspective) this.uniforms.away.value.set(0, 0, 0);
    else camera.getWorldDirection(this.uniforms.away.value);
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const seen: { tile: Tile; leaf_px: number }[] = [];
    for (const tile of this.tiles.values()) {
      if (!frustum.intersectsSphere(tile.sphere)) {
        this.show(tile, undefined, false);
        continue;
      }
      const distance = Math.max(0.05, tile.sphere.center.distanceTo(camera.position) - 0.7 * tile.sphere.radius);
      seen.push({ tile, leaf_px: this.leaf_m * (perspective ? focal_px / distance : this.uniforms.scale.value) });
    }
    let target_px = kVoxel_px * (moving ? this.movingPressure : 1);
    const budget = moving ? kMovingBudget / Math.sqrt(this.movingPressure) : kRestingBudget;
    let choice = this.choose(seen, target_px);
    for (let i = 0; i < 12 && choice.total > budget; ++i) choice = this.choose(seen, (target_px *= 1.3));
    this.shownVoxels = 0;
    for (const { tile, level, px } of choice.levels) {
      this.show(tile, level, px > kCube_px);
      this.shownVoxels += level?.voxels.count ?? 0;
    }
    if (!moving) this.fetchMissing(seen);
    this.evict();
  }

  /** The finest voxel under a ray; coarse levels are refined first. */
  async pick(ray: THREE.Ray): Promise<{ point: THREE.Vector3; centre: THREE.Vector3 } | null> {
    const hits: { tile: Tile; distance: number }[] = [];
    const at = new THREE.Vector3();
    for (const tile of this.tiles.values()) {
      if (tile.shownLevel === undefined) continue;
      if (tile.box.containsPoint(ray.origin)) hits.push({ tile, distance: 0 });
      else if (ray.intersectBox(tile.box, at) !== null) hits.push({ tile, distance: at.distanceTo(ray.origin) });
    }
    hits.sort((a, b) => a.distance - b.distance);
    const visible = (p: THREE.Vector3): boolean => this.visible(p);
    for (const { tile } of hits) {
      if (tile.shownLevel?.intersect(ray, visible) == null) continue;
      if (!tile.levels.has(kDepth)) await this.fetch(tile, kDepth);
      const hit = tile.levels.get(kDepth)?.intersect(ray, visible);
      if (hit == null) continue;
      return { point: ray.at(hit.distance, new THREE.Vector3()), centre: hit.centre };
    }
    return null;
  }

  private choose(seen: { tile: Tile; leaf_px: number }[], target_px: number) {
    let total = 0;
    const levels = seen.map(({ tile, leaf_px }) => {
      const depth = Math.max(kCoarsest, Math.min(kDepth, kDepth - Math.ceil(Math.log2(target_px / leaf_px) - 0.5)));
      let level: Level | undefined;
      for (let d = Math.min(depth, kDepth); d >= kCoarsest && level === undefined; --d) level = tile.levels.get(d);
      for (let d = depth; d <= kDepth && level === undefined; ++d) level = tile.levels.get(d);
      total += level?.voxels.count ?? 0;
      return { tile, level, px: level === undefined ? 0 : leaf_px * level.voxels.step };
    });
    return { levels, total };
  }

  private fetchMissing(seen: { tile: Tile; leaf_px: number }[]): void {
    this.wanted = [];
    for (const { tile, leaf_px } of seen) {
      const depth = Math.max(kCoarsest, Math.min(kDepth, kDepth - Math.ceil(Math.log2(kVoxel_px / leaf_px) - 0.5)));
      const level = tile.levels.get(depth);
      const current = level !== undefined && level.checksum === tile.row[4];
      if (!current && !tile.pending.has(depth)) this.wanted.push({ tile, depth, size_px: leaf_px });
    }
    this.wanted.sort((a, b) => a.size_px - b.size_px);
    this.fetchNext();
  }
  private fetchNext(): void {
    while (this.fetching < kFetches && this.wanted.length > 0) {
      const { tile, depth } = this.wanted.pop()!;
      ++this.fetching;
      void this.fetch(tile, depth).finally(() => {
        --this.fetching;
        this.fetchNext();
        this.changed();
      });
    }
  }
  /** Whether coarser voxels alone do not make the motion smooth. */
  get isStrained(): boolean {
    return this.movingPressure > 2.5;
  }
  /** Tiles and levels that are still on the way. */
  get outstanding(): number {
    return this.wanted.length + this.fetching;
  }

  private async fetch(tile: Tile, depth: number): Promise<void> {
    if (tile.pending.has(depth)) return;
    tile.pending.add(depth);
    try {
      this.addLevel(tile, new VoxelTile(await ask.tile(tile.row, depth)));
    } finally {
      tile.pending.delete(depth);
    }
  }

  private tileOf(row: TileRow): Tile {
    const name = tileName(row[0], row[1], row[2]);
    let tile = this.tiles.get(name);
    if (tile === undefined) {
      const edge = 2 ** (kDepth - row[3]) * this.leaf_m;
      const low = new THREE.Vector3(row[0], row[1], row[2]).subScalar(kCentreKey).multiplyScalar(this.leaf_m);
      const box = new THREE.Box3(low, low.clone().addScalar(edge));
      tile = { row, box, sphere: box.getBoundingSphere(new THREE.Sphere()), levels: new Map(), pending: new Set() };
      this.tiles.set(name, tile);
    }
    return tile;
  }
  private addLevel(tile: Tile, voxels: VoxelTile): void {
    const old = tile.levels.get(voxels.depth);
    if (old !== undefined) {
      if (tile.shownLevel === old) this.show(tile, undefined, false);
      old.dispose();
    }
    const level = new Level(voxels, tile.row[4], this.leaf_m, tile.sphere);
    tile.levels.set(voxels.depth, level);
    this.box.union(level.extent);
  }
  private show(tile: Tile, level: Level | undefined, asCubes: boolean): void {
    const mesh = level?.mesh(asCubes, this.pointMaterial, this.cubeMaterial);
    if (level !== undefined) {
      level.lastShown = this.frame;
      if (level.painted !== this.paintVersion) {
        paintTile(level.voxels, this.paint, level.colors);
        level.repaint();
        level.painted = this.paintVersion;
      }
    }
    if (mesh !== tile.shown) {
      if (tile.shown !== undefined) this.group.remove(tile.shown);
      if (mesh !== undefined) this.group.add(mesh);
    }
    tile.shown = mesh;
    tile.shownLevel = level;
  }
  /** Drops the levels that were not shown for longest, but never the coarsest. */
  private evict(): void {
    if (this.frame % 30 !== 0) return;
    const levels: { tile: Tile; level: Level }[] = [];
    let total = 0;
    for (const tile of this.tiles.values()) {
      for (const level of tile.levels.values()) {
        total += level.voxels.count;
        if (level.voxels.depth > kCoarsest && level !== tile.shownLevel) levels.push({ tile, level });
      }
    }
    levels.sort((a, b) => a.level.lastShown - b.level.lastShown);
    for (const { tile, level } of levels) {
      if (total <= kKeptVoxels) break;
      total -= level.voxels.count;
      level.dispose();
      tile.levels.delete(level.voxels.depth);
    }
  }
}
