// SPDX-License-Identifier: Apache-2.0
// The elements of the machine by their kind, with a filter over the names of elements, variables and parameters.
import type { Context } from "../context";
import { h } from "../dom";
import { ElementActions } from "../edit/element_actions";
import { icon } from "../icons";
import { type Kind, kindOf, kindOfSection, kinds } from "../signals";
import { panel, toolButton } from "./panel";

interface Row {
  element: string;
  isNew: boolean; // the session does not have it
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
  #actions: ElementActions;
  #tools: { button: HTMLButtonElement; needsElement: boolean }[];

  constructor(context: Context) {
    this.#context = context;
    this.#actions = new ElementActions(context);
    this.#tools = [
      { button: toolButton("plus", "Add an element (Insert)", () => this.#actions.add()), needsElement: false },
      { button: toolButton("copy", "Copy the element", () => this.#run("copy")), needsElement: true },
      { button: toolButton("rename", "Rename the element (F2)", () => this.#run("rename")), needsElement: true },
      { button: toolButton("trash", "Remove the element (Delete)", () => this.#run("remove")), needsElement: true },
    ];
    const tools = [this.#count, ...this.#tools.map((tool) => tool.button)];
    this.root = panel("tree", "Machine", tools, h("div", { class: "bar" }, this.#filter), this.#list);
    this.#filter.oninput = () => this.#show();
    this.#list.onkeydown = (event) => this.#takeKey(event);
    context.session.changed.on(() => this.#collect());
    let shown = context.scene.elements; // each reading of the text makes others
    context.scene.changed.on(() => {
      if (shown === context.scene.elements) return;
      shown = context.scene.elements;
      this.#collect();
    });
    context.selectionChanged.on(() => this.#mark());
    this.#mark();
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
    const { scene } = this.#context;
    const sectionOf = new Map<string, string>(); // of elements that the scene alone has
    for (const [element, { section }] of scene.elements) {
      if (labels.has(element)) continue;
      labels.set(element, new Set());
      sectionOf.set(element, section);
    }
    this.#groups.clear();
    for (const kind of kinds) this.#groups.set(kind, []);
    for (const [element, names] of labels) {
      const section = sectionOf.get(element);
      const isNew = section !== undefined && !scene.known.has(element);
      this.#groups.get(section === undefined ? kindOf(element, names) : kindOfSection(section))!.push({
        element,
        isNew,
        names: [element, ...[...names].map((name) => `${element}.${name}`)].join("\n").toLowerCase(),
      });
    }
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
    this.#count.textContent = count > 0 ? (this.#context.scene.isOpen ? String(count) : `${count} elements`) : "";
    this.#mark();
  }

  #rowOf(row: Row): HTMLElement {
    return h(
      "div",
      {
        class: ["row", row.isNew && "is-new", this.#context.scene.problemsOf(row.element).length > 0 && "is-bad"]
          .filter(Boolean)
          .join(" "),
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

  // The selected element, where the text of the scene has it.
  get #own(): string | undefined {
    const { scene, selected } = this.#context;
    const element = selected === undefined ? undefined : scene.elements.get(selected);
    return element && !element.place && element.name !== element.section ? selected : undefined;
  }

  #run(action: "copy" | "rename" | "remove"): void {
    const own = this.#own;
    if (own !== undefined) void this.#actions[action](own);
  }

  #mark(): void {
    for (const { button, needsElement } of this.#tools) {
      button.hidden = !this.#context.scene.isOpen;
      button.disabled = needsElement && this.#own === undefined;
    }
    for (const row of this.#list.querySelectorAll<HTMLElement>(".row")) {
      const isSelected = row.dataset["element"] === this.#context.selected;
      row.setAttribute("aria-selected", String(isSelected));
      if (isSelected) row.scrollIntoView({ block: "nearest" });
    }
  }

  #takeKey(event: KeyboardEvent): void {
    if (this.#context.scene.isOpen) {
      if (event.key === "Insert") return this.#actions.add();
      if (event.key === "F2") return this.#run("rename");
      if (event.key === "Delete") return this.#run("remove");
    }
    const rows = [...this.#list.querySelectorAll<HTMLElement>(".row")];
    const at = rows.findIndex((row) => row.dataset["element"] === this.#context.selected);
    const next = { ArrowDown: at + 1, ArrowUp: at < 0 ? 0 : at - 1, Home: 0, End: rows.length - 1 }[event.key];
    if (next === undefined || !rows[next]) return;
    event.preventDefault();
    this.#context.select(rows[next].dataset["element"]);
  }
}
