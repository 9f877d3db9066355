// Slider over the frames, with the curves that belong to them.
import type { Frames } from "./protocol";
import { h } from "./dom";

interface Curve {
  name: string;
  variable: string; // CSS custom property of its colour
  of: (frames: Frames, i: number) => number;
  show: (value: number) => string;
  row: number;
}
const count = (v: number): string => v.toFixed(0);
const kCurves: Curve[] = [
  { name: "open", variable: "--open", of: (f, i) => f.open[i], show: count, row: 0 },
  { name: "inhibited", variable: "--inhibited", of: (f, i) => f.inhibited[i], show: count, row: 0 },
  { name: "revisits", variable: "--revisit", of: (f, i) => 100 * f.revisit[i], show: (v) => `${v.toFixed(0)} %`, row: 1 },
  { name: "frame time", variable: "--time", of: (f, i) => f.ms[i], show: (v) => `${v.toFixed(0)} ms`, row: 2 },
];
const kRows = 3;
const kPlay_ms = 60;

export class Timeline {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { class: "curves" });
  private readonly slider = h("input", { type: "range", min: 0, max: 0, value: 0, class: "slider", "aria-label": "frame" });
  private readonly play = h("button", { class: "play", title: "Play (space)", "aria-label": "play" }, "▶");
  private readonly label = h("output", { class: "when" });
  private readonly key = h("div", { class: "key" });
  private timer = 0;
  private busy = false;

  constructor(private frames: Frames, private keyframes: number[], private readonly choose: (frame: number) => Promise<void>) {
    this.element = h("section", { class: "timeline", "aria-label": "time" },
      h("div", { class: "transport" }, this.play, this.label, this.key), this.canvas, this.slider);
    this.slider.addEventListener("input", () => void this.set(Number(this.slider.value)));
    this.play.addEventListener("click", () => this.toggle());
    const point = (event: PointerEvent): void => {
      const bounds = this.canvas.getBoundingClientRect();
      void this.set(Math.round(((event.clientX - bounds.left) / bounds.width) * (this.count - 1)));
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      point(event);
    });
    this.canvas.addEventListener("pointermove", (event) => event.buttons > 0 && point(event));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.update(frames, keyframes);
  }

  get count(): number {
    return this.frames.name.length;
  }
  get frame(): number {
    return Number(this.slider.value);
  }
  update(frames: Frames, keyframes: number[]): void {
    const atEnd = this.frame >= Number(this.slider.max);
    this.frames = frames;
    this.keyframes = keyframes;
    this.slider.max = String(Math.max(0, this.count - 1));
    if (atEnd) this.slider.value = this.slider.max;
    this.draw();
  }
  async set(frame: number): Promise<void> {
    this.slider.value = String(Math.min(Math.max(frame, 0), this.count - 1));
    this.draw();
    await this.choose(this.frame);
  }
  toggle(): void {
    if (this.timer !== 0) return this.stop();
    if (this.frame >= this.count - 1) this.slider.value = "0";
    this.play.textContent = "❚❚";
    this.timer = window.setInterval(() => {
      if (this.busy) return;
      if (this.frame >= this.count - 1) return this.stop();
      this.busy = true;
      const step = Math.max(1, Math.round(this.count / 400));
      void this.set(this.frame + step).finally(() => (this.busy = false));
    }, kPlay_ms);
  }
  stop(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.play.textContent = "▶";
  }

  draw(): void {
    const { canvas, frames } = this;
    const ratio = devicePixelRatio, width = canvas.clientWidth, height = canvas.clientHeight;
    if (width === 0 || this.count === 0) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const context = canvas.getContext("2d")!;
    const style = getComputedStyle(document.documentElement);
    context.scale(ratio, ratio);
    const xOf = (i: number): number => (i / Math.max(1, this.count - 1)) * (width - 2) + 1;
    const rowHeight = height / kRows;
    for (let row = 0; row < kRows; ++row) {
      const curves = kCurves.filter((curve) => curve.row === row);
      let most = row === 1 ? 100 : 0;
      for (const curve of curves) for (let i = 0; i < this.count; ++i) most = Math.max(most, curve.of(frames, i));
      for (const curve of curves) {
        context.beginPath();
        for (let i = 0; i < this.count; ++i) {
          context.lineTo(xOf(i), (row + 1) * rowHeight - 2 - (curve.of(frames, i) / (most || 1)) * (rowHeight - 4));
        }
        context.strokeStyle = style.getPropertyValue(curve.variable);
        context.lineWidth = 1.3;
        context.stroke();
      }
    }
    context.fillStyle = style.getPropertyValue("--lost");
    frames.tracking.forEach((tracking, i) => tracking === "lost" && context.fillRect(xOf(i) - 1, 0, 2, height));
    context.fillStyle = style.getPropertyValue("--keyframe");
    for (const i of this.keyframes) context.fillRect(xOf(i) - 0.5, height - 4, 1, 4);
    context.fillStyle = style.getPropertyValue("--text");
    context.fillRect(xOf(this.frame) - 0.5, 0, 1, height);
    const i = this.frame;
    this.label.textContent = `frame ${i} of ${this.count} · tick ${frames.tick[i]} · ${(frames.stamp_s[i] - frames.stamp_s[0]).toFixed(1)} s`;
    this.key.replaceChildren(...kCurves.map((curve) => {
      const item = h("span", {}, h("i", {}), `${curve.name} ${curve.show(curve.of(frames, i))}`);
      (item.firstChild as HTMLElement).style.background = `var(${curve.variable})`;
      return item;
    }));
  }
}
