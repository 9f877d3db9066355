// Small ways to make elements.

type Child = Node | string | null | undefined;
type Properties = Record<string, string | number | boolean | ((event: never) => void)>;

/** An element; `on…` properties are listeners, `class` and `data-…` attributes, the rest properties of its own. */
export function h<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Properties = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else if (name in element) (element as unknown as Record<string, unknown>)[name] = value;
    else element.setAttribute(name, String(value));
  }
  for (const child of children) if (child != null) element.append(child);
  return element;
}

/** A two-column list of names and values. */
export function facts(rows: [string, Child][]): HTMLElement {
  return h("dl", {}, ...rows.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
}

export const grouped = (value: number): string => Math.round(value).toLocaleString("en").replaceAll(",", "\u202f");
export const cm = (metres: number): string => (100 * metres).toFixed(0);

/** A line drawing in a square of 20 × 20. */
export function icon(path: string): SVGElement {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg"), line = document.createElementNS(space, "path");
  svg.setAttribute("viewBox", "0 0 20 20");
  svg.setAttribute("aria-hidden", "true");
  line.setAttribute("d", path);
  svg.append(line);
  return svg;
}
