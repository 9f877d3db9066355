// What the map knows of one leaf.
import { facts, h } from "./dom";
import type { Leaf, SceneObject } from "./protocol";

export function leafPanel(leaf: Leaf | null, object: SceneObject | undefined, openObject: (id: number) => void, goToTick: (tick: number) => void): HTMLElement {
  const panel = h("div", { class: "panel leaf-panel" }, h("h2", {}, "Leaf"));
  if (leaf === null) {
    panel.append(h("p", { class: "note" }, "Click on the map to see what a leaf holds."));
    return panel;
  }
  const swatch = h("i", { class: "swatch" });
  swatch.style.background = `rgb(${leaf.color.join(" ")})`;
  const until = leaf.forgotten_at_tick;
  panel.append(
    h("p", {}, h("span", { class: `badge ${leaf.inhibited ? "inhibited" : "open"}` }, leaf.inhibited ? "inhibited" : "open"),
      ` ${leaf.state}, ${(100 * leaf.edge_m).toFixed(1)} cm`),
    facts([
      ["corner in W", leaf.low_m.map((v) => v.toFixed(3)).join("  ") + " m"],
      ["key", leaf.key.join("  ")],
      ["occupancy", `${leaf.occupancy.toFixed(3)} (log-odds ${leaf.log_odds.toFixed(2)})`],
      ["colour", h("span", {}, swatch, leaf.color.join(" "))],
      ["normal", leaf.normal.map((v) => v.toFixed(2)).join("  ")],
      ["seen in", `${leaf.observations} frames`],
      ["IOR weight", `${leaf.ior_weight} ticks at tick ${leaf.tick}`],
      ["forgotten", until === null ? "not remembered" : `at tick ${until}`],
      ["attended at", h("span", { class: "ticks" }, ...(leaf.attentions.length === 0 ? ["never"] : leaf.attentions.map((look) =>
        h("button", { class: "tick", title: `rank ${look.rank}`, onclick: () => goToTick(look.tick) }, String(look.tick)))))],
      ["object", object === undefined ? "none" : h("button", { class: "tick", onclick: () => openObject(object.id) }, `Object ${object.id}`)],
    ]));
  return panel;
}
