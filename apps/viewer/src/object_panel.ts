// The objects that were looked at more than once: list, search, and why one is inhibited.
import { cm, facts, grouped, h } from "./dom";
import { ask, type SceneObject } from "./protocol";

export class ObjectPanel {
  readonly element = h("div", { class: "panel object-panel" });
  private readonly search = h("input", { type: "search", placeholder: "number, or: inhibited, open", "aria-label": "search objects" });
  private readonly order = h("select", { "aria-label": "order" },
    h("option", { value: "looks" }, "most looked at"), h("option", { value: "id" }, "by number"),
    h("option", { value: "size" }, "largest"), h("option", { value: "last" }, "last looked at"));
  private readonly list = h("ul", { class: "objects" });
  private readonly count = h("p", { class: "note" });
  private readonly detail = h("div", { class: "detail" });
  private objects: SceneObject[] = [];
  private tick = 0;
  private selected: number | null = null;

  constructor(private readonly choose: (object: SceneObject | null) => void, private readonly goToTick: (tick: number) => void) {
    this.search.addEventListener("input", () => this.fill());
    this.order.addEventListener("change", () => this.fill());
    this.element.append(h("h2", {}, "Objects"), h("div", { class: "row" }, this.search, this.order), this.detail, this.count, this.list);
  }

  update(objects: SceneObject[], tick: number): void {
    this.objects = objects;
    this.tick = tick;
    this.fill();
  }
  select(id: number | null): void {
    this.selected = id;
    this.fill();
    this.choose(this.objects.find((object) => object.id === id) ?? null);
  }
  focusSearch(): void {
    this.search.focus();
  }
  /** The smallest object that holds the point. */
  objectAt(x: number, y: number, z: number): SceneObject | undefined {
    const holds = this.objects.filter(({ box3d: b }) => x >= b[0] && y >= b[1] && z >= b[2] && x <= b[3] && y <= b[4] && z <= b[5]);
    return holds.sort((a, b) => a.leaves - b.leaves)[0];
  }

  private fill(): void {
    const text = this.search.value.trim().toLowerCase();
    const wanted = this.objects.filter((o) =>
      text === "" || String(o.id).startsWith(text) || (text.length > 2 && ("inhibited".startsWith(text) ? o.inhibited > 0 : "open".startsWith(text) && o.inhibited === 0)));
    const by: Record<string, (o: SceneObject) => number> = {
      looks: (o) => -o.looks.length, id: (o) => o.id, size: (o) => -o.leaves, last: (o) => -o.looks[o.looks.length - 1][0],
    };
    const key = by[this.order.value];
    wanted.sort((a, b) => key(a) - key(b) || a.id - b.id);
    this.count.textContent = `${wanted.length} of ${this.objects.length} objects, ${this.objects.filter((o) => o.inhibited > 0).length} inhibited at tick ${this.tick}`;
    this.list.replaceChildren(...wanted.map((object) => this.item(object)));
    const chosen = this.objects.find((object) => object.id === this.selected);
    this.detail.replaceChildren(...(chosen === undefined ? [] : [this.why(chosen)]));
  }
  private item(object: SceneObject): HTMLElement {
    const [x0, y0, z0, x1, y1, z1] = object.box3d;
    const state = object.inhibited > 0 ? h("span", { class: "badge inhibited" }, `until tick ${object.last_expiry}`) : h("span", { class: "badge open" }, "open");
    return h("li", {}, h("button", {
      class: object.id === this.selected ? "object on" : "object", "data-id": object.id,
      onclick: () => this.select(object.id === this.selected ? null : object.id),
    }, h("img", { src: ask.cropUrl(object.id), alt: "", loading: "lazy" }),
      h("span", { class: "words" }, h("b", {}, `Object ${object.id}`),
        h("span", {}, `seen ${object.looks.length}× · ${cm(x1 - x0)} × ${cm(y1 - y0)} × ${cm(z1 - z0)} cm`)), state));
  }
  private why(object: SceneObject): HTMLElement {
    const inhibited = object.inhibited > 0;
    const past = object.flags.filter(([tick]) => tick < this.tick);
    const tickButton = (tick: number): HTMLElement => h("button", { class: "tick", onclick: () => this.goToTick(tick) }, String(tick));
    const verdict = inhibited
      ? `${grouped(object.inhibited)} of its leaves are inhibited. They will be forgotten from tick ${object.first_expiry} to ${object.last_expiry}: in ${object.first_expiry - this.tick} to ${object.last_expiry - this.tick} ticks.`
      : past.length > 0 ? "It was inhibited and has been forgotten since: it may be looked at again." : "It has not been looked at for long enough to be inhibited.";
    return h("section", { class: "why" }, h("h3", {}, `Object ${object.id}: ${inhibited ? "inhibited" : "open"}`), h("p", {}, verdict),
      facts([
        ["looks at ticks", h("span", { class: "ticks" }, ...object.looks.map(([tick]) => tickButton(tick)))],
        ["flag went on", h("span", { class: "ticks" }, ...(object.flags.length > 0 ? object.flags.map(([tick]) => tickButton(tick)) : ["never"]))],
      ]));
  }
}
