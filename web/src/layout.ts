// SPDX-License-Identifier: Apache-2.0
// The places of the panels: three columns with borders that can be moved; on a narrow screen one tab at a time.
import { Emitter, followPointer, h } from "./dom";
import { icon, type IconName } from "./icons";

export interface Panels {
  tree: HTMLElement;
  object: HTMLElement;
  view: HTMLElement;
  circuit: HTMLElement; // in the place of the view
  plots: HTMLElement;
  operate: HTMLElement;
  health: HTMLElement;
  log: HTMLElement;
}

interface Border {
  name: string; // --size-<name> of the style sheet
  usual: number; // px
  least: number;
  isVertical: boolean; // a vertical border changes a width
  sign: number; // of the size over the pointer's way
}

const borders: Border[] = [
  { name: "left", usual: 280, least: 180, isVertical: true, sign: 1 },
  { name: "right", usual: 300, least: 220, isVertical: true, sign: -1 },
  { name: "plots", usual: Math.round(0.43 * window.innerHeight), least: 120, isVertical: false, sign: -1 },
  { name: "object", usual: Math.round(0.48 * window.innerHeight), least: 100, isVertical: false, sign: -1 },
  { name: "log", usual: 220, least: 80, isVertical: false, sign: -1 },
];
const kKeyStep = 16; // px

const tabs: [string, string, IconName][] = [
  ["view", "View", "machine"],
  ["machine", "Machine", "list"],
  ["plots", "Plots", "plot"],
  ["session", "Session", "target"],
];

export type Center = "view" | "circuit";

export class Layout {
  readonly root: HTMLElement;
  readonly centerChanged = new Emitter<Center>();
  readonly tabBar: HTMLElement;
  #sizes = new Map<string, number>();
  #center: Center = "view";
  #changed: () => void;

  constructor(panels: Panels, changed: () => void) {
    this.#changed = changed;
    const border = (name: string) => this.#border(borders.find((one) => one.name === name)!);
    this.root = h(
      "main",
      { class: "columns" },
      h("div", { class: "column left" }, panels.tree, border("object"), panels.object),
      border("left"),
      h("div", { class: "column center" }, panels.view, panels.circuit, border("plots"), panels.plots),
      border("right"),
      h("div", { class: "column right" }, panels.operate, panels.health, border("log"), panels.log),
    );
    const buttons = tabs.map(([name, text, symbol]) =>
      h(
        "button",
        { type: "button", role: "tab", "data-tab": name, onclick: () => this.showTab(name) },
        icon(symbol),
        text,
      ),
    );
    this.tabBar = h("nav", { class: "tabs", role: "tablist" }, ...buttons);
    for (const one of [panels.view, panels.circuit]) one.querySelector(".tools")!.prepend(this.#centerSwitch());
    this.sizes = {};
    this.showTab("view");
    this.showCenter("view");
  }

  get sizes(): Record<string, number> {
    return Object.fromEntries(this.#sizes);
  }
  set sizes(sizes: Record<string, number>) {
    for (const border of borders) this.#set(border, sizes[border.name] ?? border.usual);
  }

  showTab(name: string): void {
    document.documentElement.dataset["tab"] = name;
    for (const button of this.tabBar.children)
      button.setAttribute("aria-selected", String((button as HTMLElement).dataset["tab"] === name));
  }

  get center(): Center {
    return this.#center;
  }

  // What stands above the plots.
  showCenter(name: Center): void {
    this.#center = name;
    document.documentElement.dataset["center"] = name;
    this.centerChanged.emit(name);
  }

  #centerSwitch(): HTMLElement {
    const names: [Center, string][] = [
      ["view", "View"],
      ["circuit", "Circuit"],
    ];
    const button = ([name, text]: [Center, string]) =>
      h(
        "button",
        { type: "button", "data-center": name, title: `Show: ${text}`, onclick: () => this.#chooseCenter(name) },
        text,
      );
    return h("div", { class: "segments center-switch", role: "group", "aria-label": "Picture" }, ...names.map(button));
  }

  #chooseCenter(name: Center): void {
    this.showCenter(name);
    this.#changed();
  }

  #border(border: Border): HTMLElement {
    return h("div", {
      class: `border ${border.isVertical ? "is-vertical" : "is-horizontal"} border-${border.name}`,
      role: "separator",
      tabIndex: 0,
      "aria-label": `Size of ${border.name}`,
      "aria-orientation": border.isVertical ? "vertical" : "horizontal",
      onpointerdown: (event: PointerEvent) => {
        const place = (one: PointerEvent) => (border.isVertical ? one.clientX : one.clientY);
        const [start, size] = [place(event), this.#sizes.get(border.name)!];
        followPointer(event, (next) => this.#set(border, size + border.sign * (place(next) - start)), this.#changed);
      },
      ondblclick: () => this.#resize(border, border.usual),
      onkeydown: (event: KeyboardEvent) => {
        const way = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
        if (way === undefined) return;
        event.preventDefault();
        this.#resize(border, this.#sizes.get(border.name)! + border.sign * way * kKeyStep);
      },
    });
  }

  #resize(border: Border, size: number): void {
    this.#set(border, size);
    this.#changed();
  }

  #set(border: Border, size: number): void {
    const most = (border.isVertical ? window.innerWidth * 0.4 : window.innerHeight * 0.75) || size;
    const limited = Math.round(Math.max(border.least, Math.min(most, size)));
    this.#sizes.set(border.name, limited);
    document.documentElement.style.setProperty(`--size-${border.name}`, `${limited}px`);
  }
}
