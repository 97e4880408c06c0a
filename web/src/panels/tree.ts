// SPDX-License-Identifier: Apache-2.0
// The elements of the machine by their kind, with a filter over the names of elements, variables and parameters.
import type { Context } from "../context";
import { h } from "../dom";
import { icon } from "../icons";
import { type Kind, kindOf, kinds } from "../signals";
import { panel } from "./panel";

interface Row {
  element: string;
  names: string; // what the filter looks at, in lower case
}

export const usualClosed: string[] = ["Contacts", "Volumes", "Session"];

export class TreePanel {
  readonly root: HTMLElement;
  #context: Context;
  #list = h("div", { class: "tree", role: "tree", tabIndex: 0, "aria-label": "Elements of the machine" });
  #filter = h("input", { type: "search", placeholder: "Filter", "aria-label": "Show elements that contain" });
  #count = h("span", { class: "count" });
  #groups = new Map<Kind, Row[]>();
  #closed = new Set(usualClosed);

  constructor(context: Context) {
    this.#context = context;
    this.root = panel("tree", "Machine", [this.#count], h("div", { class: "bar" }, this.#filter), this.#list);
    this.#filter.oninput = () => this.#show();
    this.#list.onkeydown = (event) => this.#takeKey(event);
    context.session.changed.on(() => this.#collect());
    context.selectionChanged.on(() => this.#mark());
  }

  get closed(): string[] {
    return [...this.#closed];
  }
  set closed(groups: string[]) {
    this.#closed = new Set(groups);
    this.#show();
  }

  #collect(): void {
    const { session } = this.#context;
    const labels = new Map<string, Set<string>>();
    for (const [element, variables] of session.elements)
      labels.set(element, new Set(variables.map((variable) => variable.label)));
    for (const name of session.parameters.keys()) {
      const dot = name.indexOf(".");
      const element = name.slice(0, dot);
      if (!labels.has(element)) labels.set(element, new Set());
      labels.get(element)!.add(name.slice(dot + 1));
    }
    this.#groups.clear();
    for (const kind of kinds) this.#groups.set(kind, []);
    for (const [element, names] of labels)
      this.#groups.get(kindOf(element, names))!.push({
        element,
        names: [element, ...[...names].map((name) => `${element}.${name}`)].join("\n").toLowerCase(),
      });
    this.#show();
  }

  #show(): void {
    const wanted = this.#filter.value.trim().toLowerCase();
    let count = 0;
    const groups: HTMLElement[] = [];
    for (const [kind, rows] of this.#groups) {
      const shown = rows.filter((row) => row.names.includes(wanted));
      if (shown.length === 0) continue;
      count += shown.length;
      const isOpen = wanted !== "" || !this.#closed.has(kind);
      const head = h(
        "button",
        {
          class: "group",
          type: "button",
          tabIndex: -1,
          "aria-expanded": String(isOpen),
          onclick: () => this.#toggle(kind),
        },
        icon("chevron"),
        kind,
        h("span", { class: "count" }, String(shown.length)),
      );
      const list = isOpen ? shown.map((row) => this.#rowOf(row)) : [];
      groups.push(h("div", { role: "group", "aria-label": kind }, head, ...list));
    }
    this.#list.replaceChildren(...groups);
    if (count === 0)
      this.#list.append(
        h("p", { class: "empty" }, wanted ? "No element, variable or parameter of this name." : "No elements yet."),
      );
    this.#count.textContent = count > 0 ? `${count} elements` : "";
    this.#mark();
  }

  #rowOf(row: Row): HTMLElement {
    return h(
      "div",
      {
        class: "row",
        role: "treeitem",
        "data-element": row.element,
        title: row.element,
        onclick: () => this.#context.select(row.element),
      },
      row.element,
    );
  }

  #toggle(kind: Kind): void {
    if (!this.#closed.delete(kind)) this.#closed.add(kind);
    this.#show();
    this.#context.workspaceChanged.emit();
  }

  #mark(): void {
    for (const row of this.#list.querySelectorAll<HTMLElement>(".row")) {
      const isSelected = row.dataset["element"] === this.#context.selected;
      row.setAttribute("aria-selected", String(isSelected));
      if (isSelected) row.scrollIntoView({ block: "nearest" });
    }
  }

  #takeKey(event: KeyboardEvent): void {
    const rows = [...this.#list.querySelectorAll<HTMLElement>(".row")];
    const at = rows.findIndex((row) => row.dataset["element"] === this.#context.selected);
    const next = { ArrowDown: at + 1, ArrowUp: at < 0 ? 0 : at - 1, Home: 0, End: rows.length - 1 }[event.key];
    if (next === undefined || !rows[next]) return;
    event.preventDefault();
    this.#context.select(rows[next].dataset["element"]);
  }
}
