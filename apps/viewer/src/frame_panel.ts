// One frame: its pictures with the candidates in them, and the list of candidates.
import * as THREE from "three";
import { facts, h } from "./dom";
import { ask, type Candidate, type Frames, type Layer, type Summary } from "./protocol";

const kNames: Record<Layer, string> = { color: "Colour", saliency: "Saliency", ior: "2D IOR map", map: "Map" };

export const rankColor = (rank: number, count: number): string => `hsl(${50 + (190 * rank) / Math.max(1, count - 1)} 90% 58%)`;
export const rankNumber = (rank: number, count: number): number =>
  new THREE.Color().setHSL((50 + (190 * rank) / Math.max(1, count - 1)) / 360, 0.9, 0.58).getHex();

export class FramePanel {
  readonly element = h("div", { class: "panel frame-panel" });
  private layer: Layer = "color";
  private request = 0;
  private frame = 0;

  constructor(private readonly summary: Summary, private readonly goTo: () => void, private readonly mark: (candidates: Candidate[], only: number | null) => void) {}

  async show(frames: Frames, frame: number): Promise<void> {
    const request = ++this.request;
    this.frame = frame;
    const candidates = frames.pose[frame] === null ? [] : await ask.candidates(frame);
    if (request !== this.request) return;
    this.mark(candidates, null);
    if (this.summary.keyframes.length === 0 && this.layer === "color") this.layer = "map";
    this.element.replaceChildren(
      h("h2", {}, frames.name[frame], h("span", { class: `badge ${frames.tracking[frame]}` }, frames.tracking[frame])),
      this.pictures(candidates),
      facts([
        ["candidates", `${frames.open[frame]} open, ${frames.inhibited[frame]} inhibited, ${frames.attended[frame]} attended`],
        ["returns", `${(100 * frames.revisit[frame]).toFixed(0)} % of the attended`],
        ["residual", `${(1000 * frames.rms_m[frame]).toFixed(1)} mm`],
        ["time", `${frames.ms[frame].toFixed(0)} ms`],
      ]),
      h("button", { class: "wide", onclick: this.goTo, title: "C" }, "Look from here"),
      this.list(candidates));
  }

  private nearestKeyframe(): number | undefined {
    let best: number | undefined;
    for (const key of this.summary.keyframes) {
      if (best === undefined || Math.abs(key - this.frame) < Math.abs(best - this.frame)) best = key;
    }
    return best;
  }
  private pictures(candidates: Candidate[]): HTMLElement {
    const key = this.nearestKeyframe();
    const frameOf = (layer: Layer): number | undefined => (layer === "color" || layer === "saliency" ? key : this.frame);
    const box = h("div", { class: "pictures" });
    const draw = (): void => {
      const shown = frameOf(this.layer);
      const isOwn = shown === this.frame;
      const away = shown === undefined ? 0 : shown - this.frame;
      const note = shown === undefined ? "this session keeps no images of frames"
        : isOwn ? `${kNames[this.layer]} of this frame` + (this.layer === "map" ? ", as the map is now" : this.layer === "ior" ? ": white was inhibited" : "")
        : `${kNames[this.layer]} of the nearest keyframe, ${Math.abs(away)} frames ${away < 0 ? "earlier" : "later"}`;
      box.replaceChildren(
        h("div", { class: "picture" }, shown === undefined ? null : h("img", { src: ask.pictureUrl(shown, this.layer), alt: note }),
          isOwn ? this.overlay(candidates) : null),
        h("p", { class: "note" }, note),
        h("div", { class: "tabs", role: "tablist" }, ...(Object.keys(kNames) as Layer[]).map((layer) =>
          h("button", {
            role: "tab", "aria-selected": String(layer === this.layer), class: layer === this.layer ? "on" : "",
            onclick: () => { this.layer = layer; draw(); },
          }, kNames[layer]))));
    };
    draw();
    return box;
  }
  private overlay(candidates: Candidate[]): SVGElement {
    const space = "http://www.w3.org/2000/svg";
    const { width, height } = this.summary.camera;
    const svg = document.createElementNS(space, "svg");
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    for (const c of [...candidates].reverse()) {
      const color = rankColor(c.rank, candidates.length);
      const rect = document.createElementNS(space, "rect");
      const [u, v, w, box_height] = c.box;
      for (const [name, value] of Object.entries({ x: u, y: v, width: w, height: box_height, stroke: color, "stroke-width": c.rank < 3 ? 3 : 1.5, fill: "none" })) {
        rect.setAttribute(name, String(value));
      }
      svg.append(rect);
      if (c.rank > 9) continue;
      const text = document.createElementNS(space, "text");
      for (const [name, value] of Object.entries({ x: u + 4, y: v + 18, fill: color, "font-size": 18 })) text.setAttribute(name, String(value));
      text.textContent = String(c.rank);
      svg.append(text);
    }
    return svg;
  }
  private list(candidates: Candidate[]): HTMLElement {
    if (candidates.length === 0) return h("p", { class: "note" }, "Nothing was attended in this frame.");
    return h("table", { class: "candidates" },
      h("thead", {}, h("tr", {}, ...["rank", "score", "from", "seen before"].map((name) => h("th", {}, name)))),
      h("tbody", {}, ...candidates.map((c) => {
        const dot = h("i", { class: "dot" });
        dot.style.background = rankColor(c.rank, candidates.length);
        return h("tr", {
          tabIndex: 0,
          onpointerenter: () => this.mark(candidates, c.rank), onpointerleave: () => this.mark(candidates, null),
          onfocus: () => this.mark(candidates, c.rank), onblur: () => this.mark(candidates, null),
        }, h("td", {}, dot, String(c.rank)), h("td", {}, c.score.toFixed(2)), h("td", {}, c.source), h("td", {}, `${(100 * c.revisited).toFixed(0)} %`));
      })));
  }
}
