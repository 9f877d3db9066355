// The page of `saccade view`.
import * as THREE from "three";
import { clipPanel } from "./clip_panel";
import { legendOf, type Mode, type Paint } from "./colors";
import { facts, grouped, h, icon } from "./dom";
import { FramePanel, rankNumber } from "./frame_panel";
import { leafPanel } from "./leaf_panel";
import { ObjectPanel } from "./object_panel";
import { ask, type Frames, type Leaf, type SceneObject, type Summary } from "./protocol";
import { SceneView } from "./scene_view";
import { Timeline } from "./timeline";
import { findUp } from "./up";
import { VoxelScene } from "./voxel_scene";
import { attentionValues, differenceValues, kCentreKey, lastSeenValues } from "./voxel_tile";

const kModes: [Mode, string][] = [
  ["color", "Colour"], ["height", "Height"], ["occupancy", "Occupancy"],
  ["weight", "IOR weight"], ["flag", "IOR flag"], ["lastseen", "Last seen"],
];
const kKeys: [string, string][] = [
  ["drag · right drag · wheel", "turn · move · zoom"], ["click", "leaf, or a pose of the camera path"],
  ["1 to 7", "colours"], ["space", "play"], ["← →", "one frame (shift: ten)"], ["F", "whole map"],
  ["C", "look from this frame"], ["T", "from above"], ["O", "perspective or orthographic"], ["R", "ruler: click two points"],
  ["/", "search objects"], ["S", "save a screenshot"], ["L", "light or dark"], ["Esc", "clear what is marked"], ["?", "this help"],
];
const kIcons = {
  fit: "M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4",
  camera: "M2.5 6.5h3.5l1.5-2h5l1.5 2h3.5v9.5h-15zM10 8.3a2.7 2.7 0 1 0 .01 0",
  theme: "M10 3a7 7 0 1 0 .01 0M10 3v14M10 6a4 4 0 0 1 0 8M10 4.5a5.5 5.5 0 0 1 0 11",
  help: "M7 7.2a3 3 0 1 1 4.6 2.5c-1 .7-1.6 1.200-1.6 2.600M10 15.700v.1",
};
const kBackground = { dark: "#15181d", light: "#eef0f3" };

class Page {
  private frames!: Frames;
  private paint!: Paint;
  private readonly voxels: VoxelScene;
  private readonly scene: SceneView;
  private timeline!: Timeline;
  private readonly framePanel: FramePanel;
  private readonly objectPanel: ObjectPanel;
  private readonly status = h("div", { class: "status", role: "status" });
  private readonly legend = h("div", { class: "legend" });
  private readonly modes = h("div", { class: "modes", role: "group", "aria-label": "colour by" });
  private readonly side = h("div", { class: "side-body" });
  private readonly tabs = h("nav", { class: "tabs" });
  private readonly help = h("dialog", { class: "help" });
  private readonly panels: Record<string, HTMLElement> = {};
  private selected: SceneObject | null = null;
  private objects: SceneObject[] = [];
  private ruler: THREE.Vector3 | null | undefined; // undefined: not measuring, null: no point yet
  private message = "";
  private attentionRequest = 0;

  constructor(private readonly summary: Summary) {
    this.paint = {
      mode: "color", up: [0, -1, 0], leaf_m: summary.leaf_size_m, height_m: [0, 1], tick: summary.tick,
      most_weight: Math.ceil(summary.ior_limit * summary.mf),
    };
    this.voxels = new VoxelScene(summary.leaf_size_m, this.paint, () => this.scene.touch());
    this.scene = new SceneView(summary, this.voxels, () => this.showStatus());
    this.framePanel = new FramePanel(summary, () => this.lookFromFrame(), (candidates, only) =>
      this.scene.showCandidateBoxes(candidates.filter((c) => c.box3d !== null && (only === null ? c.rank < 5 : c.rank === only))
        .map((c) => ({ box: c.box3d!, color: rankNumber(c.rank, candidates.length) }))));
    this.objectPanel = new ObjectPanel((object) => this.chooseObject(object), (tick) => this.goToTick(tick));
  }

  async start(): Promise<void> {
    this.lay();
    this.setTheme(matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
    this.frames = await ask.frames();
    this.timeline = new Timeline(this.frames, this.summary.keyframes, (frame) => this.showFrame(frame));
    document.querySelector("main")!.after(this.timeline.element);
    let placed = false;
    await this.voxels.load((tiles) => {
      if (!placed && tiles > 0 && !this.voxels.box.isEmpty()) {
        placed = true;
        this.scene.fit(this.frames);
      }
      this.say(`${grouped(tiles)} tiles`);
    });
    this.say("");
    const up = findUp(this.voxels);
    const heights = this.voxels.heights(up);
    this.scene.setUp(up);
    this.scene.fit(this.frames);
    this.repaint({ up: [up.x, up.y, up.z], height_m: heights });
    this.panels.view = clipPanel(this.scene, this.voxels, heights, () => this.startRuler());
    this.scene.showPath(this.frames, this.summary.keyframes);
    document.body.dataset.state = "ready";
    document.body.dataset.firstPictureMs = performance.now().toFixed(0);
    await this.timeline.set(this.timeline.count - 1);
    if (this.summary.before !== null) await this.showDifference();
    if (this.summary.state === "exploring") this.follow();
  }

  // ---- layout

  private lay(): void {
    const { summary } = this;
    const tool = (path: string, title: string, act: () => void): HTMLElement => h("button", { title, "aria-label": title, onclick: act }, icon(path));
    const modes = summary.before === null ? kModes : [...kModes, ["difference", "Changes"] as [Mode, string]];
    this.modes.append(...modes.map(([mode, name], i) => h("button", { "data-mode": mode, title: `${i + 1}`, onclick: () => void this.setMode(mode) }, name)));
    this.panels.frame = this.framePanel.element;
    this.panels.objects = this.objectPanel.element;
    this.panels.leaf = leafPanel(null, undefined, () => {}, () => {});
    this.panels.view = h("div", { class: "panel" });
    this.panels.session = this.sessionPanel();
    this.tabs.append(...[["frame", "Frame"], ["objects", "Objects"], ["leaf", "Leaf"], ["view", "View"], ["session", "Session"]].map(([name, text]) =>
      h("button", { "data-panel": name, onclick: () => this.openPanel(name) }, text)));
    this.help.append(h("h2", {}, "Keys and mouse"), facts(kKeys), h("form", { method: "dialog" }, h("button", { class: "wide" }, "Close")));
    const stage = h("div", { class: "stage" }, this.scene.canvas, this.legend, this.status);
    document.body.append(
      h("header", {}, h("h1", {}, "Saccade"), h("span", { class: "title", title: summary.input }, summary.before === null ? summary.title : `${summary.before} → ${summary.title}`),
        summary.state === "exploring" ? h("span", { class: "badge live" }, "live") : null, this.modes,
        h("div", { class: "tools" }, tool(kIcons.fit, "Whole map (F)", () => this.scene.fit(this.frames)), tool(kIcons.camera, "Screenshot (S)", () => void this.screenshot()),
          tool(kIcons.theme, "Light or dark (L)", () => this.setTheme(this.theme === "dark" ? "light" : "dark")), tool(kIcons.help, "Help (?)", () => this.help.showModal()))),
      h("main", {}, stage, h("aside", {}, this.tabs, this.side)), this.help);
    this.openPanel("frame");
    this.showLegend();
    new ResizeObserver(() => this.scene.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
    this.scene.resize(stage.clientWidth, stage.clientHeight);
    this.listen();
  }
  private sessionPanel(): HTMLElement {
    const s = this.summary;
    return h("div", { class: "panel" }, h("h2", {}, s.title), facts([
      ["input", s.input], ["kind", s.input_kind], ["state", s.state], ["made", s.created_utc], ["by", `saccade ${s.saccade_version}`],
      ["frames", grouped(s.frames)], ["keyframes", grouped(s.keyframes.length)], ["leaves", `${grouped(s.leaves)} of ${(100 * s.leaf_size_m).toFixed(1)} cm`],
      ["tick", grouped(s.tick)], ["inhibition", `after ${s.ior_limit} looks, factor ${s.mf}`],
      ["camera", `${s.camera.width} × ${s.camera.height} px, f ${s.camera.fx.toFixed(1)}`],
    ]), h("details", {}, h("summary", {}, "All settings"), h("pre", {}, s.config)));
  }
  private openPanel(name: string): void {
    this.side.replaceChildren(this.panels[name]);
    for (const tab of this.tabs.querySelectorAll("button")) tab.classList.toggle("on", tab.dataset.panel === name);
  }
  private get theme(): "dark" | "light" {
    return document.documentElement.dataset.theme as "dark" | "light";
  }
  private setTheme(theme: "dark" | "light"): void {
    document.documentElement.dataset.theme = theme;
    this.scene.setBackground(kBackground[theme]);
    this.timeline?.draw();
  }
  private say(message: string): void {
    this.message = message;
    this.showStatus();
  }
  private showStatus(): void {
    const { scene, voxels } = this;
    if (scene === undefined) return;
    const rate = scene.framesPerSecond > 0 ? ` · ${scene.framesPerSecond.toFixed(0)} frames/s` : "";
    this.status.textContent = this.message !== "" ? this.message : `${grouped(voxels.shownVoxels)} voxels${voxels.outstanding > 0 ? ", more on the way" : ""}${rate}`;
    document.body.dataset.voxels = String(voxels.shownVoxels);
    document.body.dataset.rest = String(scene.atRest);
  }
  private showLegend(): void {
    const legend = legendOf(this.paint, (this.frames?.stamp_s.at(-1) ?? 0) - (this.frames?.stamp_s[0] ?? 0));
    const bar = h("div", { class: "bar" });
    if (legend.bar !== undefined) bar.style.background = legend.bar;
    const swatches = (legend.swatches ?? []).map(([color, name]) => {
      const swatch = h("i", { class: "swatch" });
      swatch.style.background = color;
      return h("span", {}, swatch, name);
    });
    this.legend.replaceChildren(h("b", {}, legend.title),
      ...(legend.bar === undefined ? [] : [bar, h("div", { class: "ends" }, h("span", {}, legend.low!), h("span", {}, legend.high!))]),
      ...(swatches.length === 0 ? [] : [h("div", { class: "swatches" }, ...swatches)]));
    for (const button of this.modes.querySelectorAll("button")) button.classList.toggle("on", button.dataset.mode === this.paint.mode);
  }

  // ---- what is shown

  private repaint(change: Partial<Paint>): void {
    this.paint = { ...this.paint, ...change };
    this.voxels.setPaint(this.paint);
    this.showLegend();
    document.body.dataset.mode = this.paint.mode;
    document.body.dataset.tick = String(this.paint.tick);
  }
  async setMode(mode: Mode): Promise<void> {
    this.repaint({ mode });
    if (mode === "weight" || mode === "flag") await this.loadAttention();
    if (mode === "lastseen" && this.paint.lastSeen === undefined) {
      this.say("looking at the map from every frame…");
      const lastSeen = lastSeenValues(await ask.lastSeen());
      this.say("");
      this.repaint({ lastSeen });
    }
  }
  private async loadAttention(): Promise<void> {
    const request = ++this.attentionRequest;
    const tick = this.frames.tick[this.timeline.frame] ?? this.summary.tick;
    if (tick === this.summary.tick) return this.repaint({ tick, attention: undefined });
    const attention = attentionValues(await ask.attention(tick));
    if (request === this.attentionRequest) this.repaint({ tick, attention });
  }
  private async showFrame(frame: number): Promise<void> {
    this.scene.showFrustum(this.frames.pose[frame]);
    const shown = this.framePanel.show(this.frames, frame);
    if (this.paint.mode === "weight" || this.paint.mode === "flag") await this.loadAttention();
    const tick = this.frames.tick[frame];
    this.objects = await ask.objects(tick);
    this.objectPanel.update(this.objects, tick);
    this.showObjectBoxes();
    await shown;
    document.body.dataset.frame = String(frame);
  }
  private showObjectBoxes(): void {
    this.scene.showObjectBoxes(this.selected === null ? [] : [{ box: this.selected.box3d, color: 0xff3df2 }]);
  }
  private chooseObject(object: SceneObject | null): void {
    this.selected = object;
    this.showObjectBoxes();
    if (object !== null) this.scene.lookAtBox(object.box3d);
    document.body.dataset.object = object === null ? "" : String(object.id);
  }
  private goToTick(tick: number): void {
    const frame = this.frames.tick.findIndex((t, i) => t === tick + 1 && this.frames.pose[i] !== null);
    if (frame >= 0) void this.timeline.set(frame);
  }
  private lookFromFrame(): void {
    const pose = this.frames.pose[this.timeline.frame];
    if (pose !== null) this.scene.lookAsFrame(pose);
  }
  private async showDifference(): Promise<void> {
    const difference = differenceValues(await ask.difference());
    const gone: number[] = [];
    difference.forEachLeaf((x, y, z, value) => {
      if (value === 2) gone.push(...[x, y, z].map((c) => (c - kCentreKey + 0.5) * this.summary.leaf_size_m));
    });
    this.scene.showGone(new Float32Array(gone), this.summary.leaf_size_m);
    this.repaint({ difference });
    await this.setMode("difference");
  }
  /** Follows a session that is being explored. */
  private follow(): void {
    const news = new EventSource("api/news");
    let first = true;
    news.onmessage = async () => {
      if (first) {
        first = false;
        return;
      }
      Object.assign(this.summary, await ask.summary());
      this.frames = await ask.frames();
      const atEnd = this.timeline.frame >= this.timeline.count - 1;
      this.timeline.update(this.frames, this.summary.keyframes);
      this.scene.showPath(this.frames, this.summary.keyframes);
      await this.voxels.refresh();
      if (atEnd) await this.timeline.set(this.timeline.count - 1);
      document.body.dataset.frames = String(this.frames.name.length);
      if (this.summary.state === "exploring") return;
      document.querySelector(".badge.live")?.remove();
      news.close();
    };
  }

  // ---- what the user does

  private listen(): void {
    const { canvas } = this.scene;
    let down: [number, number] | null = null; // null: no button, or it was a drag
    canvas.addEventListener("pointerdown", (event) => (down = event.button === 0 ? [event.clientX, event.clientY] : null));
    canvas.addEventListener("pointermove", (event) => {
      if (down !== null && Math.hypot(event.clientX - down[0], event.clientY - down[1]) >= 4) down = null;
    });
    canvas.addEventListener("pointerup", (event) => {
      const clicked = down !== null && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4;
      down = null;
      if (clicked) void this.click(event);
    });
    window.addEventListener("keydown", (event) => this.pressed(event));
  }
  private async click(event: PointerEvent): Promise<void> {
    const { frame, leaf, point } = await this.scene.pointAt(event.clientX, event.clientY);
    if (this.ruler !== undefined) return this.measure(point);
    if (frame !== undefined) {
      this.openPanel("frame");
      return this.timeline.set(frame);
    }
    if (leaf === undefined) return;
    const key = leaf.clone().divideScalar(this.summary.leaf_size_m).floor().addScalar(kCentreKey);
    const found: Leaf | null = await ask.leaf(key.x, key.y, key.z);
    const object = this.objectPanel.objectAt(leaf.x, leaf.y, leaf.z);
    this.panels.leaf = leafPanel(found, object, (id) => {
      this.openPanel("objects");
      this.objectPanel.select(id);
    }, (tick) => this.goToTick(tick));
    if (found !== null) this.scene.showLeaf(found.low_m, found.edge_m);
    this.openPanel("leaf");
  }
  private startRuler(): void {
    this.ruler = null;
    this.say("ruler: click the first point");
  }
  private measure(point: THREE.Vector3 | undefined): void {
    if (point === undefined) return;
    if (this.ruler === null || this.ruler === undefined) {
      this.ruler = point;
      this.scene.showRuler(point, null);
      return this.say("ruler: click the second point");
    }
    this.scene.showRuler(this.ruler, point);
    this.say(`ruler: ${this.ruler.distanceTo(point).toFixed(3)} m, of it ${Math.abs(point.clone().sub(this.ruler).dot(this.scene.up)).toFixed(3)} m in height`);
    this.ruler = undefined;
  }
  private async screenshot(): Promise<void> {
    const picture = await this.scene.screenshot();
    if (picture === null) return;
    const link = h("a", { href: URL.createObjectURL(picture), download: `${this.summary.title.replace(/\.saccade$/, "")}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  private pressed(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || (target.matches("input, select") && target.getAttribute("type") !== "range")) return;
    const mode = this.modes.querySelectorAll("button")[Number(event.key) - 1]?.dataset.mode as Mode | undefined;
    const step = (event.shiftKey ? 10 : 1) * (event.key === "ArrowLeft" ? -1 : 1);
    const acts: Record<string, () => void> = {
      " ": () => this.timeline.toggle(), ArrowLeft: () => void this.timeline.set(this.timeline.frame + step), ArrowRight: () => void this.timeline.set(this.timeline.frame + step),
      f: () => this.scene.fit(this.frames), c: () => this.lookFromFrame(), t: () => this.scene.lookAlong(2),
      o: () => this.scene.setOrthographic(!this.scene.isOrthographic), r: () => this.startRuler(), s: () => void this.screenshot(),
      l: () => this.setTheme(this.theme === "dark" ? "light" : "dark"), "?": () => this.help.showModal(),
      "/": () => { this.openPanel("objects"); this.objectPanel.focusSearch(); },
      Escape: () => { this.ruler = undefined; this.scene.clearMarks(); this.say(""); this.objectPanel.select(null); },
    };
    const act = mode !== undefined ? () => void this.setMode(mode) : acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (act === undefined || this.timeline === undefined) return;
    event.preventDefault();
    act();
  }
  /** For measuring and testing from the browser's console. */
  get probes(): { spin: (seconds: number) => Promise<number>; picture: () => Promise<Blob | null> } {
    return { spin: (seconds) => this.scene.spin(seconds), picture: () => this.scene.screenshot() };
  }
}

function showFailure(error: unknown): void {
  const text = error instanceof Error ? error.message : String(error);
  document.body.append(h("div", { class: "failure", role: "alert" }, text));
}
window.addEventListener("unhandledrejection", (event) => showFailure(event.reason));

const page = new Page(await ask.summary());
(window as unknown as { saccade: Page["probes"] }).saccade = page.probes;
await page.start();
