// SPDX-License-Identifier: Apache-2.0
// The diagram of the hydraulic circuit, with present values: pressures at the volumes, positions and flows at the
// components. Drag to move, wheel to zoom, a click selects.
import type { Context } from "../context";
import { atMostEvery, followPointer, h, setText } from "../dom";
import { formatNumber } from "../units";
import { panel, toolButton } from "./panel";

const kShowEveryMs = 100;
const kClickPixels = 5; // a longer way of the pointer moves the diagram
const kZoomPerNotch = 1.2;
const kLeastTop = 100e5; // Pa, at which the scale of colours ends at least
const positions = ["spool_position", "swash", "opening", "setting"]; // shares, shown as per cent
const flows = ["flow", "flow_pa", "flow_a"];

interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

export class CircuitPanel {
  readonly root: HTMLElement;
  #context: Context;
  #frame = h("div", { class: "circuit-frame", tabIndex: 0, "aria-label": "Hydraulic circuit" });
  #svg?: SVGSVGElement;
  #size: Box = { x: 0, y: 0, width: 1, height: 1 };
  #box: Box = { x: 0, y: 0, width: 1, height: 1 };
  #session?: string; // whose diagram is there
  #isShown = false;
  #stop: (() => void)[] = [];
  #top = kLeastTop; // Pa, highest pressure so far

  constructor(context: Context) {
    this.#context = context;
    const fit = toolButton("fit", "Show all of the circuit", () => this.#fit());
    this.root = panel("circuit", "Circuit", [fit], this.#frame);
    const show = atMostEvery(kShowEveryMs, () => this.#showValues());
    context.session.valuesChanged.on(show);
    context.unitsChanged.on(show);
    context.session.changed.on(() => this.#update());
    context.session.restarted.on(() => (this.#top = kLeastTop));
    context.selectionChanged.on(() => this.#mark());
    this.#frame.onwheel = (event) => this.#zoom(event);
    this.#frame.onpointerdown = (event) => this.#takePointer(event);
    new ResizeObserver(() => this.#applyBox()).observe(this.#frame);
  }

  // Values are subscribed while the panel is shown.
  setShown(isShown: boolean): void {
    this.#isShown = isShown;
    this.#update();
  }

  #update(): void {
    for (const stop of this.#stop.splice(0)) stop();
    const { session } = this.#context;
    if (!this.#isShown || session.description === undefined) return;
    if (this.#session !== session.description.session) {
      this.#session = session.description.session;
      void this.#load();
      return;
    }
    const names = new Set<string>();
    for (const one of this.#groups("data-volume")) names.add(one.dataset["volume"]!);
    for (const one of this.#groups("data-element")) names.add(one.dataset["element"]!);
    for (const name of names) if (session.elements.has(name)) this.#stop.push(session.watch(name));
    this.#showValues();
  }

  async #load(): Promise<void> {
    this.#svg = undefined;
    this.#frame.replaceChildren(h("p", { class: "empty" }, "Waiting for the diagram."));
    try {
      const answer = await fetch(this.#context.session.urlOf("circuit.svg"));
      const text = await answer.text();
      if (!answer.ok) throw new Error(text.trim());
      const svg = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
      if (!(svg instanceof SVGSVGElement)) throw new Error("it is no SVG");
      svg.querySelector("style")?.remove(); // the page has its own
      this.#svg = document.importNode(svg, true);
      const { width, height } = this.#svg.viewBox.baseVal;
      this.#size = { x: 0, y: 0, width, height };
      this.#svg.removeAttribute("width");
      this.#svg.removeAttribute("height");
      this.#frame.replaceChildren(this.#svg);
      this.#fit();
      this.#mark();
      this.#update();
    } catch (error) {
      this.#session = undefined;
      this.#frame.replaceChildren(h("p", { class: "empty" }, `No diagram: ${(error as Error).message}`));
    }
  }

  #groups(attribute: string): (SVGElement & HTMLOrSVGElement)[] {
    return [...(this.#svg?.querySelectorAll<SVGElement>(`[${attribute}]`) ?? [])];
  }

  // ---- values

  #showValues(): void {
    if (!this.#isShown || !this.#svg) return;
    const { session } = this.#context;
    const pressures = new Map<string, number>();
    for (const one of this.#groups("data-volume")) {
      const volume = one.dataset["volume"]!;
      const value = session.values.get(`${volume}.pressure`);
      if (typeof value === "number") pressures.set(volume, value);
    }
    this.#top = Math.max(this.#top, ...pressures.values());
    for (const one of this.#groups("data-volume")) {
      const pressure = pressures.get(one.dataset["volume"]!);
      one.classList.toggle("is-live", pressure !== undefined);
      if (pressure === undefined) continue;
      one.style.setProperty("--pressure", `${Math.round(Math.max(0, Math.min(1, pressure / this.#top)) * 100)}%`);
      const text = one.querySelector(".value");
      if (text) setText(text, this.#text(`${one.dataset["volume"]!}.pressure`, pressure));
    }
    for (const one of this.#groups("data-element")) {
      const text = one.querySelector(".value");
      if (text) setText(text, this.#valuesOf(one.dataset["element"]!));
    }
  }

  #text(variable: string, value: number): string {
    const unit = this.#context.unitOf(variable);
    const shown = value * unit.factor;
    const size = Math.abs(shown);
    const text = size >= 1e5 ? formatNumber(shown) : shown.toFixed(size >= 100 ? 0 : 1);
    return `${text === "-0.0" ? "0.0" : text} ${unit.text}`;
  }

  // Position of the spool, the swash, ... and a flow.
  #valuesOf(element: string): string {
    const { values } = this.#context.session;
    const texts: string[] = [];
    const first = (labels: string[]) => labels.find((label) => typeof values.get(`${element}.${label}`) === "number");
    const position = first(positions);
    if (position) texts.push(`${Math.round(values.get(`${element}.${position}`)! * 100)} %`);
    const flow = first(flows) ?? first(["stroke", "angle", "speed", "ls_pressure"]);
    if (flow) texts.push(this.#text(`${element}.${flow}`, values.get(`${element}.${flow}`)!));
    return texts.join(", ");
  }

  #mark(): void {
    const { selected } = this.#context;
    for (const one of [...this.#groups("data-element"), ...this.#groups("data-volume")])
      one.classList.toggle("is-selected", (one.dataset["element"] ?? one.dataset["volume"]) === selected);
  }

  // ---- the part that is shown

  #fit(): void {
    this.#box = { ...this.#size };
    this.#applyBox();
  }

  #applyBox(): void {
    const { x, y, width, height } = this.#box;
    this.#svg?.setAttribute("viewBox", `${x} ${y} ${width} ${height}`);
  }

  // Units of the diagram per pixel of the page.
  get #scale(): number {
    const { width, height } = this.#frame.getBoundingClientRect();
    return Math.max(this.#box.width / width, this.#box.height / height);
  }

  #zoom(event: WheelEvent): void {
    event.preventDefault();
    const factor = event.deltaY > 0 ? kZoomPerNotch : 1 / kZoomPerNotch;
    const frame = this.#frame.getBoundingClientRect();
    const box = this.#box;
    if (box.width * factor > 4 * this.#size.width || box.width * factor < 100) return;
    // the diagram stands in the middle of the frame; the point under the pointer stays
    const x = box.x + box.width / 2 + (event.clientX - frame.x - frame.width / 2) * this.#scale;
    const y = box.y + box.height / 2 + (event.clientY - frame.y - frame.height / 2) * this.#scale;
    this.#box = {
      x: x + (box.x - x) * factor,
      y: y + (box.y - y) * factor,
      width: box.width * factor,
      height: box.height * factor,
    };
    this.#applyBox();
  }

  #takePointer(event: PointerEvent): void {
    const group = (event.target as Element).closest<SVGElement>("[data-element], [data-volume]");
    const start = { ...this.#box };
    let isClick = true;
    followPointer(
      event,
      (next) => {
        const [dx, dy] = [next.clientX - event.clientX, next.clientY - event.clientY];
        if (Math.hypot(dx, dy) > kClickPixels) isClick = false;
        if (isClick) return;
        this.#box = { ...start, x: start.x - dx * this.#scale, y: start.y - dy * this.#scale };
        this.#applyBox();
      },
      () => {
        if (isClick && group) this.#context.select(group.dataset["element"] ?? group.dataset["volume"]);
      },
    );
  }
}
