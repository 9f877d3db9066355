// Clip box, slice, ruler and standard views.
import * as THREE from "three";
import { h } from "./dom";
import type { SceneView } from "./scene_view";
import type { VoxelScene } from "./voxel_scene";

const kSteps = 1000;

/** Two sliders that bound an interval. */
function interval(name: string, low: number, high: number, changed: (low: number, high: number) => void): { element: HTMLElement; reset: () => void } {
  const from = h("input", { type: "range", min: 0, max: kSteps, value: 0, "aria-label": `${name} from` });
  const to = h("input", { type: "range", min: 0, max: kSteps, value: kSteps, "aria-label": `${name} to` });
  const text = h("output", {});
  const at = (input: HTMLInputElement): number => low + ((high - low) * Number(input.value)) / kSteps;
  const update = (): void => {
    const whole = Number(from.value) === 0 && Number(to.value) === kSteps;
    text.textContent = whole ? "all" : `${at(from).toFixed(2)} to ${at(to).toFixed(2)} m`;
    changed(Number(from.value) === 0 ? -1e9 : at(from), Number(to.value) === kSteps ? 1e9 : at(to));
  };
  for (const input of [from, to]) input.addEventListener("input", update);
  update();
  return {
    element: h("div", { class: "interval" }, h("label", {}, name, text), from, to),
    reset: () => {
      from.value = "0";
      to.value = String(kSteps);
      update();
    },
  };
}

export function clipPanel(scene: SceneView, voxels: VoxelScene, heights: [number, number], startRuler: () => void): HTMLElement {
  const low = new THREE.Vector3().setScalar(-1e9), high = new THREE.Vector3().setScalar(1e9);
  const axes = (["x", "y", "z"] as const).map((axis) =>
    interval(axis, voxels.box.min[axis], voxels.box.max[axis], (a, b) => {
      low[axis] = a;
      high[axis] = b;
      voxels.setClip(low, high);
    }));
  const slice = interval("height", heights[0] - 0.1, heights[1] + 0.1, (a, b) => voxels.setSlice(a, b));
  const box = voxels.box.getSize(new THREE.Vector3());
  const toggle = (name: string, what: "path" | "boxes" | "gone", on: boolean): HTMLElement => {
    const input = h("input", { type: "checkbox", checked: on, onchange: () => scene.setVisible(what, input.checked) });
    return h("label", { class: "check" }, input, name);
  };
  return h("div", { class: "panel view-panel" },
    h("h2", {}, "View"),
    h("div", { class: "row" },
      h("button", { onclick: () => scene.lookAlong(2) }, "From above"),
      h("button", { onclick: () => scene.lookAlong(0) }, "Front"),
      h("button", { onclick: () => scene.lookAlong(1) }, "Side")),
    h("div", { class: "row" },
      h("button", { onclick: () => scene.setOrthographic(!scene.isOrthographic), title: "O" }, "Perspective / orthographic"),
      h("button", { onclick: startRuler, title: "R" }, "Ruler")),
    h("div", { class: "row" }, toggle("camera path", "path", true), toggle("object boxes", "boxes", true)),
    h("h3", {}, "Slice"), slice.element,
    h("h3", {}, "Clip box"), ...axes.map((axis) => axis.element),
    h("button", { class: "wide", onclick: () => [slice, ...axes].forEach((part) => part.reset()) }, "Show all again"),
    h("p", { class: "note" }, `The map spans ${box.x.toFixed(1)} × ${box.y.toFixed(1)} × ${box.z.toFixed(1)} m.`));
}
