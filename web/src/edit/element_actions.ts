// SPDX-License-Identifier: Apache-2.0
// Elements of the scene are added, copied, renamed and removed.
import type { Context } from "../context";
import { showNameDialog } from "./name_dialog";
import type { EditAnswer } from "./scene_file";

// A name that is free: Bag gives Bag_2.
function freeName(context: Context, name: string): string {
  const stem = name.replace(/_\d+$/, "");
  for (let i = 2; ; ++i) if (!context.scene.elements.has(`${stem}_${i}`)) return `${stem}_${i}`;
}

function list(notes: string[]): string {
  const most = 8;
  const more = notes.length > most ? ` and ${notes.length - most} more` : "";
  return notes.slice(0, most).join(", ") + more;
}

const placesOf = (notes: string[]) => (notes.length > 0 ? `: ${list(notes)}` : "");

export class ElementActions {
  #context: Context;

  constructor(context: Context) {
    this.#context = context;
  }

  add(): void {
    const { scene } = this.#context;
    showNameDialog({
      title: "Add an element",
      name: "New",
      action: "Add",
      kinds: scene.kinds.filter((kind) => !kind.is_single),
      submit: (name, kind) =>
        this.#apply(name, scene.edit({ add: name, section: kind?.section ?? "", type: kind?.type ?? "" }), () => ""),
    });
  }

  copy(element: string): void {
    const { scene } = this.#context;
    showNameDialog({
      title: `Copy ${element}`,
      name: freeName(this.#context, element),
      action: "Copy",
      submit: (name) => this.#apply(name, scene.edit({ copy: element, to: name }), () => ""),
    });
  }

  rename(element: string): void {
    const { scene } = this.#context;
    showNameDialog({
      title: `Rename ${element}`,
      name: element,
      action: "Rename",
      submit: (name) =>
        this.#apply(name, scene.edit({ rename: element, to: name }), (notes) =>
          notes.length > 0 ? `${notes.length} references follow: ${list(notes)}` : "",
        ),
    });
  }

  async remove(element: string): Promise<void> {
    const { scene, session } = this.#context;
    const { refusal, notes } = await scene.edit({ remove: element });
    if (refusal === "") {
      this.#context.select(undefined);
      session.noticed.emit({ level: 0, message: `${element} is removed from the text` });
    } else {
      session.noticed.emit({ level: 1, message: refusal + placesOf(notes) });
    }
  }

  async #apply(name: string, edit: Promise<EditAnswer>, textOf: (notes: string[]) => string): Promise<string> {
    const { refusal, notes } = await edit;
    if (refusal !== "") return refusal + placesOf(notes);
    const text = textOf(notes);
    if (text !== "") this.#context.session.noticed.emit({ level: 0, message: text });
    this.#context.select(name);
    return "";
  }
}
