// SPDX-License-Identifier: Apache-2.0
// The drawing of a plot: uPlot with an axis for each unit, zoom in both directions, marks at events, two cursors.
import uPlot from "uplot";
import type { Context } from "../context";
import { Emitter } from "../dom";
import type { LogEntry } from "../session";
import type { CursorLines } from "./cursor_lines";
import type { CurveId, CurveStore } from "./curves";
import type { TimeAxis } from "./time_axis";

export interface Curve extends CurveId {
  color: string;
}

const kLeastDrag = 6; // pixels
const kWheelZoom = 1.0015; // for each unit of the wheel
const kLeastSpread = 10; // pixels between two fingers that zoom
const kMarkPixels = 5; // distance at which an event is shown
const kLeft = 3;
const kRight = 1; // sides of uPlot
export const dashes: number[][] = [[], [7, 4], [2, 3], [10, 3, 2, 3]]; // by recording

export class Chart {
  readonly hovered = new Emitter();
  hoverTime?: number;
  #context: Context;
  #axis: TimeAxis;
  #store: CurveStore;
  #host: HTMLElement;
  #cursors: CursorLines;
  #plot?: uPlot;
  #curves: Curve[] = [];
  #yRanges = new Map<string, [number, number]>(); // by scale; chosen by hand

  constructor(context: Context, axis: TimeAxis, store: CurveStore, cursors: CursorLines, host: HTMLElement) {
    this.#context = context;
    this.#axis = axis;
    this.#store = store;
    this.#cursors = cursors;
    this.#host = host;
    new ResizeObserver(() => this.#resize()).observe(host);
  }

  get canvas(): HTMLCanvasElement | undefined {
    return this.#plot?.ctx.canvas;
  }
  // The range of values that a curve's axis shows.
  rangeOf(curve: Curve): [number, number] {
    const { min, max } = this.#plot?.scales[this.#scaleOf(curve)] ?? {};
    return [min ?? -1, max ?? 1];
  }

  setCurves(curves: Curve[]): void {
    this.#curves = curves;
    this.#plot?.destroy();
    this.#plot = undefined;
    this.#yRanges.clear();
    if (curves.length === 0) return;
    this.#plot = new uPlot(this.#options(), this.#data(), this.#host);
    this.#cursors.attach(this.#plot);
    this.draw();
  }

  draw(): void {
    if (!this.#plot) return;
    const [min, max] = this.#axis.range;
    this.#plot.batch(() => {
      this.#plot!.setData(this.#data(), false);
      this.#plot!.setScale("x", { min, max });
    });
    this.#cursors.place();
  }

  freeY(): void {
    this.#yRanges.clear();
    this.draw();
  }

  // The events within some pixels of the pointer.
  eventsNear(time: number): LogEntry[] {
    if (!this.#plot) return [];
    const at = this.#plot.valToPos(time, "x");
    return this.#context.session.log.filter(
      (entry) => !entry.isEarlier && Math.abs(this.#plot!.valToPos(entry.time, "x") - at) <= kMarkPixels,
    );
  }

  #unitOf(curve: Curve) {
    return this.#context.unitOf(curve.name);
  }

  #data(): uPlot.AlignedData {
    const [times, ...columns] = this.#store.table(this.#curves, ...this.#axis.range);
    const shown = columns.map((column, i) => {
      const { factor } = this.#unitOf(this.#curves[i]!);
      return factor === 1 ? column : Array.from(column, (value) => (typeof value === "number" ? value * factor : value));
    });
    return [times, ...shown];
  }

  #scaleOf(curve: Curve): string {
    return `y:${this.#unitOf(curve).text}`;
  }

  #options(): uPlot.Options {
    const units = [...new Set(this.#curves.map((curve) => this.#unitOf(curve).text))];
    const text = this.#context.color("--muted");
    const grid = { stroke: this.#context.color("--grid"), width: 1 };
    const font = "11px system-ui, sans-serif";
    const axes: uPlot.Axis[] = [
      {
        stroke: text,
        grid,
        ticks: grid,
        font,
        size: 24,
        space: 60,
        values: (_, splits) => splits.map((t) => `${+t.toFixed(4)} s`),
      },
    ];
    const scales: uPlot.Scales = { x: { time: false, auto: false } };
    units.forEach((unit, i) => {
      const scale = `y:${unit}`;
      axes.push({
        scale,
        side: i % 2 === 0 ? kLeft : kRight,
        stroke: text,
        grid: i === 0 ? grid : { show: false },
        ticks: grid,
        font,
        size: 52,
        space: 24,
        label: unit || undefined,
        labelSize: unit ? 15 : 0,
        labelGap: 0,
        labelFont: font,
        values: (_, splits, _axis, _space, increment) => splits.map((value) => axisNumber(value, increment)),
      });
      scales[scale] = {
        range: (_, min, max) => this.#yRanges.get(scale) ?? padded(min, max),
      };
    });
    const series: uPlot.Series[] = [
      {},
      ...this.#curves.map((curve) => ({
        label: curve.name,
        scale: this.#scaleOf(curve),
        stroke: curve.color,
        dash: dashes[curve.recording % dashes.length],
        width: 1.5,
        pxAlign: false, // whole pixels make stairs of a slow curve
        spanGaps: !this.#context.session.isRecording, // there a gap has an empty sample
        points: { show: false },
      })),
    ];
    return {
      width: Math.max(50, this.#host.clientWidth),
      height: Math.max(50, this.#host.clientHeight),
      legend: { show: false },
      padding: [10, units.length > 1 ? 4 : 14, 0, 4],
      scales,
      axes,
      series,
      cursor: {
        sync: { key: "plots", setSeries: false },
        drag: { x: true, y: true, uni: 24, setScale: false },
        points: { size: 6 },
        dataIdx: (plot, which, near, time) => lastBefore(plot, which, near, time),
        bind: { dblclick: () => () => (this.#showAll(), null) },
      },
      hooks: {
        setSelect: [(plot) => this.#zoomTo(plot)],
        setCursor: [(plot) => this.#takeCursor(plot)],
        draw: [(plot) => this.#drawMarks(plot)],
        ready: [(plot) => this.#takePointer(plot), (plot) => this.#takeTouches(plot)],
      },
    };
  }

  #showAll(): void {
    this.#yRanges.clear();
    this.#axis.follow();
  }

  #zoomTo(plot: uPlot): void {
    const { left, top, width, height } = plot.select;
    if (width <= 0 || height <= 0) return;
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    const isWhole = (size: number, all: number) => size >= all - 1 || size < kLeastDrag;
    if (!isWhole(height, plot.over.clientHeight)) {
      for (const scale of Object.keys(plot.scales).filter((key) => key !== "x"))
        this.#yRanges.set(scale, [plot.posToVal(top + height, scale), plot.posToVal(top, scale)]);
    }
    if (isWhole(width, plot.over.clientWidth)) this.draw();
    else this.#axis.show(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
  }

  #takeCursor(plot: uPlot): void {
    const { left } = plot.cursor;
    this.hoverTime = left === undefined || left < 0 ? undefined : plot.posToVal(left, "x");
    this.hovered.emit();
  }

  #takePointer(plot: uPlot): void {
    plot.over.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const box = plot.over.getBoundingClientRect();
        const factor = kWheelZoom ** (event.deltaY || (event.shiftKey ? event.deltaX : 0));
        if (event.shiftKey) this.#zoomY(plot, factor, event.clientY - box.top);
        else if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) this.#axis.move(event.deltaX / box.width);
        else this.#axis.zoom(factor, plot.posToVal(event.clientX - box.left, "x"));
      },
      { passive: false },
    );
    // a click in the plot of a recording goes to that time
    let start = 0;
    plot.over.addEventListener("mousedown", (event) => (start = event.clientX));
    plot.over.addEventListener("click", (event) => {
      const { session } = this.#context;
      if (!session.info?.range || Math.abs(event.clientX - start) > kLeastDrag) return;
      const time = plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x");
      session.controlPlayback({ seek: Math.min(session.info.range.to, Math.max(session.info.range.from, time)) });
    });
  }

  // One finger moves the time, two zoom it around their middle; the page scrolls with vertical ways of one finger.
  #takeTouches(plot: uPlot): void {
    const fingers = new Map<number, number>(); // horizontal places in the plot, by pointer
    let isTap = true; // of one finger that has not moved
    const middle = () => [...fingers.values()].reduce((sum, x) => sum + x, 0) / fingers.size;
    const spread = () => Math.max(...fingers.values()) - Math.min(...fingers.values());
    const place = (event: PointerEvent) => event.clientX - plot.over.getBoundingClientRect().left;
    plot.over.addEventListener("pointerdown", (event) => {
      if (event.pointerType !== "touch" || fingers.size === 2) return;
      fingers.set(event.pointerId, place(event));
      isTap = fingers.size === 1;
    });
    plot.over.addEventListener("pointermove", (event) => {
      const last = fingers.get(event.pointerId);
      if (last === undefined || (isTap && Math.abs(place(event) - last) < kLeastDrag)) return;
      isTap = false;
      const [at, apart, width] = [middle(), spread(), plot.over.clientWidth];
      fingers.set(event.pointerId, place(event));
      this.#axis.move((at - middle()) / width);
      const [from, to] = this.#axis.range;
      if (apart > kLeastSpread && spread() > kLeastSpread)
        this.#axis.zoom(apart / spread(), from + (middle() / width) * (to - from));
    });
    for (const end of ["pointerup", "pointercancel"] as const)
      plot.over.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }

  #zoomY(plot: uPlot, factor: number, at: number): void {
    for (const [key, scale] of Object.entries(plot.scales)) {
      if (key === "x" || scale.min === undefined || scale.max === undefined) continue;
      const middle = plot.posToVal(at, key);
      this.#yRanges.set(key, [middle + (scale.min! - middle) * factor, middle + (scale.max! - middle) * factor]);
    }
    this.draw();
  }

  // Events as short lines at the upper border, the time of a recording as a whole line.
  #drawMarks(plot: uPlot): void {
    const { session } = this.#context;
    const { ctx } = plot;
    const { top, height, left, width } = plot.bbox;
    const scale = window.devicePixelRatio;
    const at = (time: number) => plot.valToPos(time, "x", true);
    const isVisible = (x: number) => x >= left && x <= left + width;
    const [usual, bad] = [this.#context.color("--mark"), this.#context.color("--bad")];
    ctx.save();
    for (const entry of session.log) {
      const x = at(entry.time);
      if (entry.isEarlier || !isVisible(x)) continue;
      ctx.strokeStyle = ctx.fillStyle = entry.level >= 3 ? bad : usual;
      ctx.lineWidth = scale;
      ctx.setLineDash([2 * scale, 3 * scale]);
      ctx.beginPath();
      ctx.moveTo(x, top);
      ctx.lineTo(x, top + height);
      ctx.stroke();
      ctx.setLineDash([]);
      ctx.beginPath();
      ctx.moveTo(x - 4 * scale, top - 6 * scale);
      ctx.lineTo(x + 4 * scale, top - 6 * scale);
      ctx.lineTo(x, top);
      ctx.fill();
    }
    const now = at(session.time);
    if (session.isRecording && isVisible(now)) {
      ctx.fillStyle = this.#context.color("--accent");
      ctx.fillRect(now - scale / 2, top, 1.5 * scale, height);
    }
    ctx.restore();
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#host;
    if (width > 0 && height > 0) this.#plot?.setSize({ width, height });
    this.#cursors.place();
  }
}

// Index of the last value of a curve at or before the time.
function lastBefore(plot: uPlot, which: number, near: number, time: number): number {
  const times = plot.data[0];
  const values = plot.data[which]!;
  let i = near;
  while (i > 0 && times[i]! > time) --i;
  while (i > 0 && (values[i] === null || values[i] === undefined)) --i;
  return i;
}

function padded(min: number | null, max: number | null): [number, number] {
  if (min === null || max === null || !Number.isFinite(min) || !Number.isFinite(max)) return [-1, 1];
  // noise in the last digits of a constant is no range
  const least = 1e-4 * Math.max(Math.abs(min), Math.abs(max), 1e-9);
  const half = Math.max((max - min) / 2, least);
  const middle = (min + max) / 2;
  return [middle - 1.12 * half, middle + 1.12 * half];
}

// With as many digits as two neighbours on the axis need.
function axisNumber(value: number, increment: number): string {
  if (value === 0) return "0";
  const digits = Math.max(0, -Math.floor(Math.log10(increment) + 1e-9));
  if (Math.abs(value) >= 1e5 || digits > 5) return value.toExponential(2);
  return String(+value.toFixed(digits));
}
