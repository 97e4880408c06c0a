// SPDX-License-Identifier: Apache-2.0
// Two cursors A and B of a plot: lines that the pointer or the arrow keys move along the time.
import type uPlot from "uplot";
import { Emitter, followPointer, h } from "../dom";

export type Times = [a: number, b: number];

export class CursorLines {
  readonly moved = new Emitter();
  times?: Times; // none: the cursors are off
  #lines: HTMLElement[];
  #plot?: uPlot;

  constructor() {
    this.#lines = ["A", "B"].map((name, i) => {
      const line = h("div", {
        class: "cursor-line",
        role: "slider",
        tabIndex: 0,
        "aria-label": `Cursor ${name}`,
        onpointerdown: (event: PointerEvent) => {
          event.stopPropagation();
          followPointer(event, (next) => this.#drag(i, next));
        },
        onmousedown: (event: MouseEvent) => event.stopPropagation(), // uPlot would begin to zoom
        onkeydown: (event: KeyboardEvent) => this.#takeKey(i, event),
      });
      line.append(h("span", {}, name));
      return line;
    });
  }

  attach(plot: uPlot): void {
    this.#plot = plot;
    plot.over.append(...this.#lines);
    this.place();
  }

  // Switches them on, at a third and two thirds of the visible time, or off.
  toggle(): void {
    const { min, max } = this.#plot?.scales["x"] ?? {};
    if (this.times || min === undefined || max === undefined || min === null || max === null) this.times = undefined;
    else this.times = [min + (max - min) / 3, min + (2 * (max - min)) / 3];
    this.place();
    this.moved.emit();
  }

  place(): void {
    this.#lines.forEach((line, i) => {
      const time = this.times?.[i];
      const at = time === undefined || !this.#plot ? NaN : this.#plot.valToPos(time, "x");
      line.hidden = !(at >= 0 && at <= (this.#plot?.over.clientWidth ?? 0));
      if (line.hidden) return;
      line.style.left = `${at}px`;
      line.setAttribute("aria-valuenow", String(time));
    });
  }

  #drag(which: number, event: PointerEvent): void {
    if (!this.#plot || !this.times) return;
    const box = this.#plot.over.getBoundingClientRect();
    const at = Math.min(box.width, Math.max(0, event.clientX - box.left));
    this.#set(which, this.#plot.posToVal(at, "x"));
  }

  #takeKey(which: number, event: KeyboardEvent): void {
    const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (direction === undefined || !this.#plot || !this.times) return;
    event.preventDefault();
    const pixels = event.shiftKey ? 20 : 2;
    this.#set(which, this.#plot.posToVal(this.#plot.valToPos(this.times[which]!, "x") + direction * pixels, "x"));
  }

  #set(which: number, time: number): void {
    this.times![which] = time;
    this.place();
    this.moved.emit();
  }
}
