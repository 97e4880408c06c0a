// SPDX-License-Identifier: Apache-2.0
// All plots, over one time.
import type { Context } from "../context";
import { h, setText } from "../dom";
import { icon } from "../icons";
import { panel, toolButton } from "../panels/panel";
import { CurveStore } from "./curves";
import { Plot } from "./plot";
import { TimeAxis } from "./time_axis";

const kShortestPauseMs = 60; // between two drawings
const kPartOfTime = 0.25; // of the processor for drawing
const lengths: [number, string][] = [
  [5, "5 s"],
  [10, "10 s"],
  [30, "30 s"],
  [120, "2 min"],
  [600, "10 min"],
  [Infinity, "all"],
];

export interface PlotsState {
  length: number | null; // s; null: everything
  plots: string[][]; // variables
}

export class PlotsPanel {
  readonly root: HTMLElement;
  #context: Context;
  #axis: TimeAxis;
  #store: CurveStore;
  #plots: Plot[] = [];
  #last?: Plot; // the one that was used last
  #list = h("div", { class: "plots" });
  #names = h("datalist", { id: "variables" });
  #length = h("select", { title: "Time that is shown", "aria-label": "Time that is shown" });
  #pause = toolButton("pause", "Hold the plots; samples go on", () => this.#togglePause());
  #note = h("span", { class: "plot-note number" });
  #recordings = h("div", { class: "recordings", hidden: true });
  #isWaiting = false;
  #isStale = false; // something changed while waiting

  constructor(context: Context) {
    this.#context = context;
    const { session } = context;
    this.#axis = new TimeAxis(session);
    this.#store = new CurveStore(session);
    for (const [value, text] of lengths) this.#length.append(h("option", { value: String(value) }, text));
    this.#length.onchange = () => {
      this.#axis.length = Number(this.#length.value);
      context.workspaceChanged.emit();
    };
    this.root = panel(
      "plots",
      "Plots",
      [this.#note, this.#length, this.#pause, toolButton("plus", "Add a plot", () => this.#addPlot())],
      this.#recordings,
      this.#list,
      this.#names,
    );
    this.#store.changed.on(() => this.draw());
    this.#axis.changed.on(() => this.#showAxis());
    session.valuesChanged.on(() => this.draw());
    session.changed.on(() => {
      this.#offerNames();
      this.#offerRecordings();
    });
    context.themeChanged.on(() => this.#rebuild());
    context.unitsChanged.on(() => this.#rebuild());
    context.plotWanted.on((name) => {
      (this.#last ?? this.#plots[0] ?? this.#addPlot()).add(name);
    });
    this.#addPlot();
    this.#showAxis();
  }

  get state(): PlotsState {
    const { length } = this.#axis;
    return { length: Number.isFinite(length) ? length : null, plots: this.#plots.map((plot) => plot.variables) };
  }
  set state(state: PlotsState) {
    for (const plot of [...this.#plots]) this.#removePlot(plot);
    this.#axis.length = state.length ?? Infinity;
    for (const variables of state.plots) {
      const plot = this.#addPlot();
      for (const name of variables) plot.add(name);
    }
    if (this.#plots.length === 0) this.#addPlot();
  }

  draw(): void {
    this.#isStale = this.#isWaiting;
    if (this.#isWaiting) return;
    this.#isWaiting = true;
    requestAnimationFrame(() => {
      const start = performance.now();
      // hidden ones (another tab of a phone) cost nothing
      if (this.root.clientHeight > 0) for (const plot of this.#plots) plot.draw();
      const pause = Math.max(kShortestPauseMs, (performance.now() - start) / kPartOfTime);
      setTimeout(() => {
        this.#isWaiting = false;
        if (this.#isStale) this.draw();
      }, pause);
    });
  }

  #addPlot(): Plot {
    const plot = new Plot(this.#context, this.#axis, this.#store);
    plot.used.on(() => (this.#last = plot));
    plot.changed.on(() => this.#context.workspaceChanged.emit());
    plot.noted.on((text) => setText(this.#note, text));
    plot.removed.on(() => {
      this.#removePlot(plot);
      if (this.#plots.length === 0) this.#addPlot();
      this.#context.workspaceChanged.emit();
    });
    this.#plots.push(plot);
    this.#last = plot;
    this.#list.append(plot.root);
    this.#context.workspaceChanged.emit();
    return plot;
  }

  #removePlot(plot: Plot): void {
    plot.end();
    this.#plots = this.#plots.filter((one) => one !== plot);
    if (this.#last === plot) this.#last = this.#plots.at(-1);
  }

  #togglePause(): void {
    if (this.#axis.isFollowing) this.#axis.hold();
    else this.#axis.follow();
  }

  #showAxis(): void {
    const { isFollowing } = this.#axis;
    this.#pause.replaceChildren(icon(isFollowing ? "pause" : "follow"), isFollowing ? "" : "Follow");
    this.#pause.title = isFollowing ? "Hold the plots; samples go on" : "Follow the newest samples";
    this.#pause.setAttribute("aria-label", this.#pause.title);
    this.#pause.classList.toggle("is-on", !isFollowing);
    this.#length.value = String(this.#axis.length);
    this.draw();
  }

  // Which curve is of which recording.
  #offerRecordings(): void {
    const names = this.#context.session.description?.recordings ?? [];
    this.#recordings.hidden = names.length < 2;
    if (this.#recordings.childElementCount === names.length || names.length < 2) return;
    const isShown = h("input", {
      type: "checkbox",
      checked: this.#store.showsBeside,
      onchange: () => {
        this.#store.showsBeside = isShown.checked;
        this.#rebuild();
      },
    });
    const keys = names.map((name, i) => h("span", { class: `recording dash-${i % 4}` }, h("i", {}), name));
    this.#recordings.replaceChildren(keys[0]!, ...keys.slice(1, -1), h("label", {}, isShown, keys.at(-1)!));
    this.#rebuild();
  }

  #offerNames(): void {
    const names = [...this.#context.session.variables.keys()];
    if (names.length === this.#names.children.length) return;
    this.#names.replaceChildren(...names.map((value) => h("option", { value })));
    this.#rebuild(); // units are known now
  }

  #rebuild(): void {
    for (const plot of this.#plots) plot.rebuild();
  }
}
