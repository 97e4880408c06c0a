// SPDX-License-Identifier: Apache-2.0
// The selected element as it stands in the scene's text: its fields, and what can be done with it.
import type { Context } from "../context";
import { h } from "../dom";
import { FieldEditor } from "./field_editor";
import { type FieldInfo, type KindInfo, type SceneElement, textOf } from "./scene_file";

export class EditForm {
  readonly root = h("section", { class: "scene-form" });
  readonly element: string;
  #context: Context;
  #editors: FieldEditor[] = [];
  #problems = h("div", { class: "note is-bad" });
  #last?: FieldEditor; // that was used last
  #shape = ""; // of the form: what it was built for

  constructor(context: Context, element: string) {
    this.#context = context;
    this.element = element;
    this.update();
  }

  // After a change of the scene.
  update(): void {
    const { scene } = this.#context;
    const element = scene.elements.get(this.element);
    if (!element) {
      this.root.replaceChildren(h("p", { class: "empty" }, "The text of the scene has no such element."));
      this.#shape = "";
      return;
    }
    const kind = scene.kindOf(element);
    const shape = [element.section, element.type, element.place].join();
    if (shape !== this.#shape) this.#build(element, kind);
    this.#shape = shape;
    for (const editor of this.#editors) editor.take(element);
    // those of fields stand there
    const keys = new Set(this.#editors.map((editor) => editor.key));
    const others = scene
      .problemsOf(element.name)
      .filter((one) => !keys.has(one.path.slice(element.name.length + 1).split(/[.[]/)[0]!));
    this.#problems.replaceChildren(...others.map((one) => h("p", {}, textOf(one))));
  }

  focus(key: string): void {
    const editor = this.#editors.find((one) => one.key === key);
    editor?.root.closest("details")?.setAttribute("open", "");
    editor?.focus();
  }

  // Puts the name of a point into the field that was used last. False: that one takes no point.
  putPoint(name: string): boolean {
    if (!this.#last?.takesPoint) return false;
    this.#last.put(name);
    return true;
  }

  #build(element: SceneElement, kind: KindInfo | undefined): void {
    this.#editors = [];
    this.#last = undefined;
    if (element.place) {
      const rows = Object.entries(element.given).map(([key, { text, place }]) =>
        h("tr", { title: place }, h("td", {}, key), h("td", { class: "written" }, text)),
      );
      this.root.replaceChildren(
        h("h3", {}, "Scene"),
        h("p", { class: "help" }, `From ${element.place}: it is changed there, not in this page.`),
        h("table", { class: "given-fields" }, h("tbody", {}, ...rows)),
      );
      return;
    }
    const infos = this.#fieldsOf(element, kind);
    const isFirst = (info: FieldInfo) =>
      info.required === true || info.key in element.fields || info.key in element.given || info.key === "type";
    const rowOf = (info: FieldInfo) => {
      const editor = new FieldEditor(this.#context.scene, element, info);
      this.#editors.push(editor);
      editor.root.addEventListener("focusin", () => (this.#last = editor));
      return editor.root;
    };
    const first = infos.filter(isFirst).map(rowOf);
    const more = infos.filter((info) => !isFirst(info)).map(rowOf);
    const parts = [
      h("h3", {}, "Scene", element.line !== undefined && h("span", { class: "count" }, `line ${element.line}`)),
      kind && h("p", { class: "help" }, kind.doc),
      this.#problems,
      ...first,
      more.length > 0 && h("details", {}, h("summary", {}, `${more.length} more fields`), ...more),
    ];
    this.root.replaceChildren(...parts.filter((part): part is HTMLElement => Boolean(part)));
  }

  // By the table of its kind, then what else the text has.
  #fieldsOf(element: SceneElement, kind: KindInfo | undefined): FieldInfo[] {
    const { scene } = this.#context;
    const types = scene.kinds.filter((one) => one.section === element.section).map((one) => one.type);
    const infos = [...(kind?.fields ?? [])];
    if (types.some((type) => type !== "")) {
      const usual = scene.kinds.find((one) => one.section === element.section && one.is_default)?.type;
      infos.unshift({ key: "type", type: "choice", doc: "", choices: types, default: usual, required: !usual });
    }
    const known = new Set(infos.map((info) => info.key));
    for (const key of Object.keys(element.fields)) if (!known.has(key)) infos.push({ key, type: "text", doc: "" });
    return infos;
  }
}
