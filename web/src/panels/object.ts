// SPDX-License-Identifier: Apache-2.0
// The selected element: its variables with their present values, its live parameters as fields, and, while the scene is
// edited, its fields in the scene's text.
import type { Context } from "../context";
import { atMostEvery, h, setText } from "../dom";
import { EditForm } from "../edit/edit_form";
import type { Parameter } from "../protocol";
import { kindOf, kindOfSection } from "../signals";
import { formatNumber } from "../units";
import { panel, toolButton } from "./panel";
import { ParameterField } from "./parameter_field";

const kShowEveryMs = 100;
export const kDragType = "application/x-slewring-variable";

export class ObjectPanel {
  readonly root: HTMLElement;
  #context: Context;
  #title = h("span", {}, "Nothing selected");
  #kind = h("span", { class: "count" });
  #body = h("div", { class: "object" });
  #values: { name: string; value: Element; unit: Element }[] = [];
  #fields = new Map<string, ParameterField>();
  #stopWatching?: () => void;
  #edit = toolButton("edit", "Edit the scene", () => void this.#toggleEdit(), "Edit");
  #form?: EditForm;

  constructor(context: Context) {
    this.#context = context;
    this.root = panel("object", this.#title, [this.#kind, this.#edit], this.#body);
    const show = atMostEvery(kShowEveryMs, () => this.#showValues());
    context.session.valuesChanged.on(show);
    context.unitsChanged.on(show);
    context.selectionChanged.on(() => this.#build());
    context.session.changed.on(() => this.#build());
    context.scene.changed.on(() => this.#showScene());
    context.fieldWanted.on(({ element, key }) => {
      context.select(element);
      this.#form?.focus(key);
    });
    context.pointPicked.on((point) => {
      if (this.#form?.putPoint(point.name)) return;
      context.select(point.body);
      const message = `${point.name} is a point of ${point.body}; to use it, click into a field for a point, then on it`;
      context.session.noticed.emit({ level: 0, message });
    });
    context.session.parametersChanged.on((names) => {
      for (const name of names) this.#fields.get(name)?.take(context.session.parameters.get(name)!);
    });
    this.#build();
  }

  #build(): void {
    const { session, selected } = this.#context;
    this.#showEdit();
    this.#stopWatching?.();
    this.#stopWatching = undefined;
    this.#values = [];
    if (selected === undefined) {
      this.#fields.clear();
      this.#form = undefined;
      this.#title.textContent = "Nothing selected";
      this.#kind.textContent = "";
      const text = "Select an element in the list, or click a part in the view.";
      this.#body.replaceChildren(h("p", { class: "empty" }, text));
      return;
    }
    const variables = session.elements.get(selected) ?? [];
    const parameters = [...session.parameters.values()].filter((one) => one.name.startsWith(`${selected}.`));
    const labels = [...variables.map((v) => v.label), ...parameters.map((p) => p.name.slice(selected.length + 1))];
    this.#title.textContent = selected;
    const section = labels.length === 0 ? this.#context.scene.elements.get(selected)?.section : undefined;
    this.#kind.textContent = section === undefined ? kindOf(selected, new Set(labels)) : kindOfSection(section);
    const sections: HTMLElement[] = [];
    if (this.#form?.element !== selected || !this.#context.scene.isOpen) this.#form = undefined;
    if (this.#context.scene.elements.has(selected)) {
      this.#form ??= new EditForm(this.#context, selected);
      sections.push(this.#form.root);
    }
    if (parameters.length > 0) sections.push(this.#parameterSection(parameters));
    else this.#fields.clear();
    if (variables.length > 0) {
      const rows = variables.map((variable) => this.#valueRow(variable.name, variable.label));
      sections.push(h("section", {}, h("h3", {}, "Values"), h("table", { class: "values" }, h("tbody", {}, ...rows))));
      this.#stopWatching = session.record(selected); // a plot of it begins with what was seen here
    }
    if (sections.length === 0) sections.push(h("p", { class: "empty" }, "This element has no variables."));
    this.#body.replaceChildren(...sections);
    this.#showValues();
  }

  // The form follows the text; it comes and goes with the editing and with the element.
  #showScene(): void {
    const { scene, selected } = this.#context;
    const hasForm = selected !== undefined && scene.elements.has(selected);
    if (hasForm !== (this.#form !== undefined)) this.#build();
    else this.#form?.update();
    this.#showEdit();
  }

  #showEdit(): void {
    const { session, scene } = this.#context;
    this.#edit.hidden = session.isRecording || !session.maySteer;
    const mayEdit = session.description?.scene_file !== undefined;
    this.#edit.disabled = !mayEdit && !scene.isOpen;
    this.#edit.title = mayEdit
      ? `Edit ${session.description!.scene_file}`
      : "This window has not started the session: 'slewring window SCENE' does, and its page edits the scene";
    this.#edit.setAttribute("aria-pressed", String(scene.isOpen));
  }

  async #toggleEdit(): Promise<void> {
    const { scene } = this.#context;
    if (!scene.isOpen) await scene.open();
    else if (!scene.isChanged || confirm("Changes that are not saved are lost.")) scene.close();
  }

  // A field that the person is editing stays as it is.
  #parameterSection(parameters: Parameter[]): HTMLElement {
    const fields = new Map<string, ParameterField>();
    for (const parameter of parameters) {
      const field = this.#fields.get(parameter.name) ?? new ParameterField(this.#context.session, parameter);
      field.take(parameter);
      fields.set(parameter.name, field);
    }
    this.#fields = fields;
    return h("section", {}, h("h3", {}, "Parameters"), ...[...fields.values()].map((field) => field.root));
  }

  #valueRow(name: string, label: string): HTMLElement {
    const value = h("td", { class: "number" });
    const unit = h("td", { class: "unit" });
    const plot = toolButton("plot", `Plot ${name}`, () => this.#context.plotWanted.emit(name));
    this.#values.push({ name, value, unit });
    return h(
      "tr",
      {
        draggable: true,
        title: `${name}: drag it into a plot`,
        ondragstart: (event: DragEvent) => event.dataTransfer?.setData(kDragType, name),
        ondblclick: () => this.#context.plotWanted.emit(name),
      },
      h("td", { class: "name" }, label),
      value,
      unit,
      h("td", { class: "action" }, plot),
    );
  }

  #showValues(): void {
    for (const { name, value, unit } of this.#values) {
      const shown = this.#context.unitOf(name);
      const number = this.#context.session.values.get(name);
      setText(value, formatNumber(number === null || number === undefined ? number : number * shown.factor));
      setText(unit, shown.text);
    }
  }
}
