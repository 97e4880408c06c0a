// SPDX-License-Identifier: Apache-2.0
// One plot: the curves of its variables, with a line of names and values above.
import type { Context } from "../context";
import { download, Emitter, h, setText } from "../dom";
import { icon } from "../icons";
import { kDragType } from "../panels/object";
import { toolButton } from "../panels/panel";
import { formatNumber } from "../units";
import { Chart, type Curve, dashes } from "./chart";
import { CursorLines } from "./cursor_lines";
import type { CurveId, CurveStore } from "./curves";
import { type Caption, csvOf, pictureOf } from "./export";
import { svgOf } from "./svg";
import type { TimeAxis } from "./time_axis";

const kColors = 8; // --curve-0 to --curve-7

interface Line {
  name: string;
  color: number;
  stop: () => void;
  root: HTMLElement;
  values: HTMLElement; // a number for each recording that is shown
  unit: Element;
}

export class Plot {
  readonly root: HTMLElement;
  readonly removed = new Emitter();
  readonly used = new Emitter(); // the person has touched it
  readonly changed = new Emitter(); // its variables
  readonly noted = new Emitter<string>(); // what stands at the pointer and the cursors
  #context: Context;
  #axis: TimeAxis;
  #store: CurveStore;
  #lines: Line[] = [];
  #cursors = new CursorLines();
  #chart: Chart;
  #legend = h("div", { class: "legend" });
  #host = h("div", { class: "chart" });
  #empty = h("p", { class: "empty" }, "Drag variables here, or add one by its name.");

  constructor(context: Context, axis: TimeAxis, store: CurveStore) {
    this.#context = context;
    this.#axis = axis;
    this.#store = store;
    this.#chart = new Chart(context, axis, store, this.#cursors, this.#host);
    const entry = h("input", {
      class: "add-variable",
      type: "text",
      placeholder: "Add variable",
      "aria-label": "Add a variable to this plot",
      onchange: () => {
        if (this.#context.session.variables.has(entry.value)) this.add(entry.value);
        else if (entry.value !== "")
          context.session.noticed.emit({ level: 2, message: `there is no variable '${entry.value}' in this session` });
        entry.value = "";
      },
    });
    entry.setAttribute("list", "variables");
    const tools = [
      toolButton("cursors", "Two cursors with differences", () => this.#cursors.toggle()),
      toolButton("fit", "Show the whole range of values", () => this.#chart.freeY()),
      fileButton("CSV", "Save the visible samples as CSV", () => void this.#saveCsv()),
      fileButton("SVG", "Save the visible window as SVG", () => this.#saveSvg()),
      fileButton("PNG", "Save the picture as PNG", () => void this.#savePicture()),
      toolButton("close", "Remove this plot", () => this.removed.emit()),
    ];
    this.root = h(
      "div",
      {
        class: "plot",
        onpointerdown: () => this.used.emit(),
        ondragover: (event: DragEvent) => {
          if (!event.dataTransfer?.types.includes(kDragType)) return;
          event.preventDefault();
          this.root.classList.add("is-target");
        },
        ondragleave: () => this.root.classList.remove("is-target"),
        ondrop: (event: DragEvent) => {
          event.preventDefault();
          this.root.classList.remove("is-target");
          const name = event.dataTransfer?.getData(kDragType);
          if (name) this.add(name);
        },
      },
      h("div", { class: "plot-head" }, this.#legend, h("div", { class: "tools" }, entry, ...tools)),
      this.#host,
      this.#empty,
    );
    for (const event of [this.#chart.hovered, this.#cursors.moved])
      event.on(() => {
        this.#showValues();
        this.noted.emit(this.#noteText());
      });
  }

  get variables(): string[] {
    return this.#lines.map((line) => line.name);
  }

  add(name: string): void {
    if (this.#lines.some((line) => line.name === name)) return;
    const used = new Set(this.#lines.map((line) => line.color));
    let color = 0;
    while (used.has(color) && color < kColors - 1) ++color;
    const values = h("span", { class: "numbers" });
    const unit = h("span", { class: "unit" });
    const remove = h(
      "button",
      { type: "button", title: `Remove ${name}`, "aria-label": `Remove ${name}`, onclick: () => this.#remove(name) },
      icon("close"),
    );
    const root = h(
      "span",
      { class: "curve", style: `--color: var(--curve-${color})`, "data-variable": name },
      h("i", {}),
      h("b", {}, name),
      values,
      unit,
      remove,
    );
    this.#lines.push({
      name,
      color,
      stop: this.#context.session.record(name.slice(0, name.indexOf("."))),
      root,
      values,
      unit,
    });
    this.#legend.append(root);
    this.rebuild();
    this.changed.emit();
  }

  #remove(name: string): void {
    const line = this.#lines.find((one) => one.name === name);
    if (!line) return;
    line.stop();
    line.root.remove();
    this.#lines = this.#lines.filter((one) => one !== line);
    this.rebuild();
    this.changed.emit();
  }

  // The plot goes away.
  end(): void {
    for (const line of this.#lines) line.stop();
    this.#lines = [];
    this.#chart.setCurves([]);
    this.root.remove();
  }

  // After a change of variables, units, colours or recordings.
  rebuild(): void {
    this.#empty.hidden = this.#lines.length > 0;
    const recordings = this.#store.shown;
    for (const line of this.#lines) {
      line.values.replaceChildren(
        ...recordings.map((recording) =>
          h("span", { class: "number", title: this.#store.nameOf(recording), "data-recording": String(recording) }),
        ),
      );
    }
    this.#chart.setCurves(this.#curves);
    this.#showValues();
  }

  draw(): void {
    this.#chart.draw();
    this.#showValues();
  }

  get #curves(): Curve[] {
    return this.#lines.flatMap(({ name, color }) =>
      this.#store.shown.map((recording) => ({ name, recording, color: this.#context.color(`--curve-${color}`) })),
    );
  }

  // At the pointer the last sample before it, else the newest; between two cursors their difference.
  #showValues(): void {
    const { session } = this.#context;
    const times = this.#cursors.times;
    const now = this.#axis.isFollowing ? session.time : this.#axis.range[1];
    const hover = this.#chart.hoverTime;
    for (const line of this.#lines) {
      const unit = this.#context.unitOf(line.name);
      const shown = (value: number | undefined) => formatNumber(value === undefined ? value : value * unit.factor);
      this.#store.shown.forEach((recording, i) => {
        const at = (time: number) => this.#store.valueAt({ name: line.name, recording }, time)?.value;
        const place = line.values.children[i];
        if (!place) return;
        if (times) {
          const [a, b] = times.map(at);
          const difference = a === undefined || b === undefined ? undefined : b - a;
          setText(place, `A ${shown(a)}  B ${shown(b)}  Δ ${shown(difference)}`);
        } else {
          setText(place, shown(at(hover ?? now)));
        }
      });
      setText(line.unit, unit.text);
    }
  }

  #noteText(): string {
    const parts: string[] = [];
    const times = this.#cursors.times;
    const hover = this.#chart.hoverTime;
    if (times) {
      const [a, b] = times;
      parts.push(`A ${a.toFixed(3)} s  B ${b.toFixed(3)} s  Δ ${(b - a).toFixed(3)} s`);
    }
    if (hover !== undefined && this.#lines[0]) {
      const curve: CurveId = { name: this.#lines[0].name, recording: 0 };
      const sample = this.#store.valueAt(curve, hover);
      const isThinned = this.#store.isThinned(curve, ...this.#axis.range);
      if (sample) parts.push(`sample at ${sample.time.toFixed(3)} s${isThinned ? " (zoom in for all samples)" : ""}`);
      for (const entry of this.#chart.eventsNear(hover)) parts.push(`${entry.source}: ${entry.text}`);
    }
    return parts.join("   ");
  }

  get #fileName(): string {
    return (
      this.#lines
        .map((line) => line.name)
        .join("_")
        .slice(0, 80) || "plot"
    );
  }

  async #saveCsv(): Promise<void> {
    const { session } = this.#context;
    const curves = this.#curves;
    if (curves.length === 0) return;
    try {
      const table = await this.#store.exactTable(curves, ...this.#axis.range);
      const heads = curves.map(({ name, recording }) => {
        const of = this.#store.shown.length > 1 ? ` (${this.#store.nameOf(recording)})` : "";
        return `${name}${of} [${session.variables.get(name)?.unit ?? "1"}]`;
      });
      download(`${this.#fileName}.csv`, csvOf(heads, table));
    } catch (error) {
      session.noticed.emit({ level: 2, message: `no file was saved: ${(error as Error).message}` });
    }
  }

  #captionOf(curve: Curve): Caption {
    const unit = this.#context.unitOf(curve.name).text;
    const of = this.#store.shown.length > 1 ? ` (${this.#store.nameOf(curve.recording)})` : "";
    return {
      text: `${curve.name}${of}${unit ? ` [${unit}]` : ""}`,
      color: curve.color,
      dash: dashes[curve.recording % dashes.length]!,
    };
  }

  #saveSvg(): void {
    const curves = this.#curves;
    if (curves.length === 0) return;
    const { range } = this.#axis;
    const [times, ...columns] = this.#store.table(curves, ...range);
    // of a live session a time without a value is one of another node
    const isLive = !this.#context.session.isRecording;
    const parted = columns.map((column) => (isLive ? Array.from(column, (value) => value ?? undefined) : column));
    const drawn = curves.map((curve) => {
      const { text: unit, factor } = this.#context.unitOf(curve.name);
      return { ...this.#captionOf(curve), unit, factor, range: this.#chart.rangeOf(curve) };
    });
    const text = svgOf(drawn, [times, ...parted], range);
    download(`${this.#fileName}.svg`, new Blob([text], { type: "image/svg+xml" }));
  }

  async #savePicture(): Promise<void> {
    if (!this.#chart.canvas) return;
    const captions = this.#curves.map((curve) => this.#captionOf(curve));
    const [background, text] = [this.#context.color("--panel"), this.#context.color("--text")];
    const picture = await pictureOf(this.#chart.canvas, captions, background, text);
    if (picture) download(`${this.#fileName}.png`, picture);
  }
}

function fileButton(text: string, title: string, onclick: () => void): HTMLElement {
  return h("button", { class: "tool file", type: "button", title, "aria-label": title, onclick }, text);
}
