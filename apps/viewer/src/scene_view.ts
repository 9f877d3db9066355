// Camera, controls and everything in the scene besides voxels: path, frustum, boxes, ruler.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Box3d, Frames, Summary } from "./protocol";
import type { AnyCamera, VoxelScene } from "./voxel_scene";
import { goneColor } from "./colors";

const kFov_deg = 50;
const kRest_ms = 180; // without motion until the picture is made fine
const kMostFrames = 40;
const kStrainedRatio = 0.5; // pixels of the picture for one of the screen, while the camera moves and drawing is slow

export interface Pointed {
  frame?: number;
  leaf?: THREE.Vector3;
  point?: THREE.Vector3;
}

export class SceneView {
  readonly canvas: HTMLCanvasElement;
  readonly up = new THREE.Vector3(0, -1, 0);
  /** Frames a second over the last second of motion; 0 before there was any. */
  framesPerSecond = 0;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly perspective = new THREE.PerspectiveCamera(kFov_deg, 1, 0.02, 200);
  private readonly orthographic = new THREE.OrthographicCamera(-1, 1, 1, -1, -200, 200);
  private camera: AnyCamera = this.perspective;
  private controls!: OrbitControls;
  private readonly path = new THREE.Group();
  private readonly objectBoxes = new THREE.Group();
  private readonly candidateBoxes = new THREE.Group();
  private readonly marks = new THREE.Group();
  private readonly gone = new THREE.Group();
  private frustum?: THREE.LineSegments;
  private pathPoints?: THREE.Points;
  private frameOfPoint: number[] = [];
  private dirty = true;
  private lastMotion = -1e9;
  private lastTime = 0;
  private lastFrame_ms = 0;
  private readonly times: number[] = [];
  private settled = false;

  constructor(private readonly summary: Summary, private readonly voxels: VoxelScene, private readonly onFrame: () => void) {
    this.renderer = new THREE.WebGLRenderer({ antialias: false, powerPreference: "high-performance" });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours are sRGB as they come
    THREE.ColorManagement.enabled = false;
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("aria-label", "The map. Drag to turn, right drag to move, wheel to zoom, click for a leaf.");
    this.scene.add(voxels.group, this.path, this.objectBoxes, this.candidateBoxes, this.marks, this.gone);
    this.makeControls();
    requestAnimationFrame(this.loop);
  }

  setBackground(color: string): void {
    this.renderer.setClearColor(new THREE.Color(color));
    this.touch();
  }
  resize(width: number, height: number): void {
    this.renderer.setSize(width, height, false);
    this.perspective.aspect = width / Math.max(1, height);
    this.perspective.updateProjectionMatrix();
    this.fitOrthographic(this.orthographic.top);
    this.touch();
  }
  /** Draw again; nothing moves. */
  touch(): void {
    this.dirty = true;
  }
  /** Whether the finest picture for this camera has been drawn. */
  get atRest(): boolean {
    return this.settled && !this.dirty && this.voxels.outstanding === 0;
  }

  // ---- camera

  setUp(up: THREE.Vector3): void {
    this.up.copy(up);
    this.makeControls();
  }
  /** The whole map, from a little above, on the side of the first camera. */
  fit(frames: Frames | null): void {
    const box = this.voxels.box;
    if (box.isEmpty()) return;
    const target = box.getCenter(new THREE.Vector3());
    const radius = 0.5 * box.getSize(new THREE.Vector3()).length();
    const first = frames?.pose.find((pose) => pose !== null);
    const forward = first ? new THREE.Vector3(0, 0, 1).applyQuaternion(new THREE.Quaternion(first[3], first[4], first[5], first[6])) : new THREE.Vector3(0, 0, 1);
    forward.addScaledVector(this.up, -forward.dot(this.up)).normalize().addScaledVector(this.up, -0.55).normalize();
    this.lookFrom(target.clone().addScaledVector(forward, -1.3 * radius), target);
    this.fitOrthographic(0.8 * radius);
  }
  /** Along an axis of the scene: 0, 1 the two horizontal ones, 2 from above. */
  lookAlong(axis: 0 | 1 | 2): void {
    this.setOrthographic(true);
    const right = new THREE.Vector3(1, 0, 0).addScaledVector(this.up, -this.up.x).normalize();
    const ahead = right.clone().cross(this.up).normalize();
    const from = axis === 2 ? this.up.clone().addScaledVector(ahead, -1e-3) : axis === 0 ? ahead.negate() : right;
    const target = this.voxels.box.getCenter(new THREE.Vector3());
    this.lookFrom(target.clone().addScaledVector(from, 10), target);
  }
  /** Where the camera was, looking the way it looked. */
  lookAsFrame(pose: number[]): void {
    this.setOrthographic(false);
    const eye = new THREE.Vector3(pose[0], pose[1], pose[2]);
    const forward = new THREE.Vector3(0, 0, 1).applyQuaternion(new THREE.Quaternion(pose[3], pose[4], pose[5], pose[6]));
    this.lookFrom(eye.clone().addScaledVector(forward, -0.05), eye.clone().addScaledVector(forward, 1.2));
  }
  lookAtBox(box: Box3d): void {
    const low = new THREE.Vector3(...box.slice(0, 3)), high = new THREE.Vector3(...box.slice(3));
    const target = low.clone().add(high).multiplyScalar(0.5);
    const away = this.camera.position.clone().sub(this.controls.target).normalize();
    this.lookFrom(target.clone().addScaledVector(away, Math.max(0.7, 3 * high.distanceTo(low))), target);
  }
  setOrthographic(on: boolean): void {
    if (on === this.isOrthographic) return;
    const target = this.controls.target.clone(), eye = this.camera.position.clone();
    if (on) this.fitOrthographic(eye.distanceTo(target) * Math.tan((kFov_deg * Math.PI) / 360));
    this.camera = on ? this.orthographic : this.perspective;
    this.makeControls();
    this.lookFrom(eye, target);
  }
  get isOrthographic(): boolean {
    return this.camera === this.orthographic;
  }
  private fitOrthographic(halfHeight: number): void {
    const aspect = this.perspective.aspect;
    Object.assign(this.orthographic, { top: halfHeight, bottom: -halfHeight, left: -halfHeight * aspect, right: halfHeight * aspect, zoom: 1 });
    this.orthographic.updateProjectionMatrix();
  }
  private lookFrom(eye: THREE.Vector3, target: THREE.Vector3): void {
    this.camera.position.copy(eye);
    this.controls.target.copy(target);
    this.controls.update();
    this.touch();
  }
  private makeControls(): void {
    const target = this.controls?.target.clone() ?? new THREE.Vector3();
    this.controls?.dispose();
    for (const camera of [this.perspective, this.orthographic]) camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(target);
    this.controls.zoomToCursor = true;
    this.controls.listenToKeyEvents(this.canvas);
    this.controls.addEventListener("change", () => {
      this.lastMotion = performance.now();
      this.settled = false;
      this.touch();
    });
  }

  // ---- what is in the scene

  showPath(frames: Frames, keyframes: number[]): void {
    this.path.clear();
    const keys = new Set(keyframes), all: number[] = [], places: number[] = [], colors: number[] = [];
    this.frameOfPoint = [];
    frames.pose.forEach((pose, i) => {
      if (pose === null) return;
      all.push(pose[0], pose[1], pose[2]);
      places.push(pose[0], pose[1], pose[2]);
      colors.push(...(keys.has(i) ? [0.95, 0.62, 0.15] : [0.25, 0.6, 0.95]));
      this.frameOfPoint.push(i);
    });
    const line = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(all, 3));
    this.path.add(new THREE.Line(line, new THREE.LineBasicMaterial({ color: 0x4a9ff0 })));
    const points = new THREE.BufferGeometry()
      .setAttribute("position", new THREE.Float32BufferAttribute(places, 3))
      .setAttribute("color", new THREE.Float32BufferAttribute(colors, 3));
    this.pathPoints = new THREE.Points(points, new THREE.PointsMaterial({ size: 5, sizeAttenuation: false, vertexColors: true }));
    this.path.add(this.pathPoints);
    this.touch();
  }
  showFrustum(pose: number[] | null): void {
    if (this.frustum !== undefined) this.scene.remove(this.frustum);
    this.frustum = undefined;
    if (pose !== null) {
      const { width, height, fx, fy, cx, cy } = this.summary.camera, depth = 0.35;
      const corner = (u: number, v: number): number[] => [((u - cx) / fx) * depth, ((v - cy) / fy) * depth, depth];
      const c = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
      const lines = c.flatMap((p, i) => [...[0, 0, 0], ...p, ...p, ...c[(i + 1) % 4]]);
      const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(lines, 3));
      this.frustum = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0xffb02e }));
      this.frustum.position.set(pose[0], pose[1], pose[2]);
      this.frustum.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
      this.scene.add(this.frustum);
    }
    this.touch();
  }
  showObjectBoxes(boxes: { box: Box3d; color: number }[]): void {
    this.replaceBoxes(this.objectBoxes, boxes);
  }
  showCandidateBoxes(boxes: { box: Box3d; color: number }[]): void {
    this.replaceBoxes(this.candidateBoxes, boxes);
  }
  showLeaf(low: number[], edge: number): void {
    this.marks.clear();
    const grow = 0.15 * edge;
    const box: Box3d = [low[0] - grow, low[1] - grow, low[2] - grow, low[0] + edge + grow, low[1] + edge + grow, low[2] + edge + grow];
    this.marks.add(boxLines(box, 0xff3df2));
    this.touch();
  }
  showRuler(a: THREE.Vector3, b: THREE.Vector3 | null): void {
    this.marks.clear();
    const points = b === null ? [a] : [a, b];
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    const onTop = { depthTest: false, transparent: true };
    this.marks.add(new THREE.Points(geometry, new THREE.PointsMaterial({ color: 0xff3df2, size: 9, sizeAttenuation: false, ...onTop })));
    if (b !== null) this.marks.add(new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: 0xff3df2, ...onTop })));
    this.touch();
  }
  clearMarks(): void {
    this.marks.clear();
    this.touch();
  }
  /** Leaves that the earlier session had and this one has not. */
  showGone(centres: Float32Array, leaf_m: number): void {
    this.gone.clear();
    const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(centres, 3));
    this.gone.add(new THREE.Points(geometry, new THREE.PointsMaterial({ color: goneColor, size: 1.4 * leaf_m, transparent: true, opacity: 0.7 })));
    this.touch();
  }
  setVisible(what: "path" | "boxes" | "gone", on: boolean): void {
    (what === "path" ? this.path : what === "boxes" ? this.objectBoxes : this.gone).visible = on;
    this.touch();
  }
  private replaceBoxes(group: THREE.Group, boxes: { box: Box3d; color: number }[]): void {
    group.clear();
    for (const { box, color } of boxes) group.add(boxLines(box, color));
    this.touch();
  }

  // ---- pointing

  async pointAt(clientX: number, clientY: number): Promise<Pointed> {
    const bounds = this.canvas.getBoundingClientRect();
    const place = new THREE.Vector2(((clientX - bounds.left) / bounds.width) * 2 - 1, 1 - ((clientY - bounds.top) / bounds.height) * 2);
    const frame = this.path.visible ? this.frameNear(place, bounds) : undefined;
    if (frame !== undefined) return { frame };
    const caster = new THREE.Raycaster();
    caster.setFromCamera(place, this.camera);
    const hit = await this.voxels.pick(caster.ray);
    return hit === null ? {} : { leaf: hit.centre, point: hit.point };
  }
  private frameNear(place: THREE.Vector2, bounds: DOMRect): number | undefined {
    const position = this.pathPoints?.geometry.getAttribute("position");
    const p = new THREE.Vector3();
    let best: number | undefined, nearest_px = 7;
    for (let i = 0; position !== undefined && i < position.count; ++i) {
      p.fromBufferAttribute(position as THREE.BufferAttribute, i).project(this.camera);
      if (p.z > 1) continue;
      const distance = Math.hypot(((p.x - place.x) * bounds.width) / 2, ((p.y - place.y) * bounds.height) / 2);
      if (distance < nearest_px) [nearest_px, best] = [distance, this.frameOfPoint[i]];
    }
    return best;
  }

  /** The finest picture as PNG. */
  screenshot(): Promise<Blob | null> {
    this.draw(false); // the browser keeps a drawing no longer than until it has shown it
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }
  /** Once around, for measuring; resolves to frames a second. */
  async spin(seconds: number): Promise<number> {
    const start = performance.now(), offset = this.camera.position.clone().sub(this.controls.target);
    let count = 0, last = 0;
    while ((last = performance.now() - start) < 1000 * seconds) {
      const turned = offset.clone().applyAxisAngle(this.up, (2 * Math.PI * last) / (1000 * seconds));
      this.camera.position.copy(this.controls.target).add(turned);
      this.controls.update();
      await new Promise(requestAnimationFrame);
      ++count;
    }
    return (1000 * count) / last;
  }

  // ---- drawing

  private readonly loop = (time: number): void => {
    requestAnimationFrame(this.loop);
    const moving = time - this.lastMotion < kRest_ms;
    if (!moving && !this.settled) {
      this.settled = true;
      this.dirty = true;
    }
    const passed = time - this.lastTime;
    if (!this.dirty) {
      this.lastTime = 0;
      return;
    }
    this.dirty = false;
    if (moving && this.lastTime > 0) this.noteTime(passed);
    this.lastTime = moving ? time : 0;
    this.draw(moving);
    this.onFrame();
  };
  private noteTime(ms: number): void {
    this.lastFrame_ms = ms;
    this.times.push(ms);
    if (this.times.length > kMostFrames) this.times.shift();
    this.framesPerSecond = (1000 * this.times.length) / this.times.reduce((a, b) => a + b, 0);
  }
  private draw(moving: boolean): void {
    const ratio = moving && this.voxels.isStrained ? kStrainedRatio : Math.min(devicePixelRatio, 1.5);
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.camera.updateMatrixWorld();
    this.voxels.update(this.camera, this.canvas.height, moving, this.lastFrame_ms);
    this.renderer.render(this.scene, this.camera);
  }
}

function boxLines([x0, y0, z0, x1, y1, z1]: Box3d, color: number): THREE.LineSegments {
  const c = [[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0], [x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1]];
  const edges = [0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4, 0, 4, 1, 5, 2, 6, 3, 7];
  const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(edges.flatMap((i) => c[i]), 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color }));
}
