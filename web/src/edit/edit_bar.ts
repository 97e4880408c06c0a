// SPDX-License-Identifier: Apache-2.0
// The scene that is edited: its file and state, undo, problems, text, saving and restart.
import type { Context } from "../context";
import { h, setText } from "../dom";
import { toolButton } from "../panels/panel";
import { textOf } from "./scene_file";
import { TextView } from "./text_view";

export class EditBar {
  readonly root: HTMLElement;
  #context: Context;
  #name = h("b", { class: "session-name" });
  #state = h("span", { class: "count", role: "status" });
  #undo = toolButton("undo", "Undo (Ctrl+Z)", () => this.#context.scene.undo());
  #redo = toolButton("redo", "Redo (Ctrl+Shift+Z)", () => this.#context.scene.redo());
  #problems = h("button", { class: "tool problem-count", type: "button", onclick: () => this.#toggle("problems") });
  #text = h("button", { class: "tool", type: "button", onclick: () => this.#toggle("text") }, "Text");
  #save = h("button", { type: "button", title: "Write the scene's file (Ctrl+S)", onclick: () => this.#context.scene.save() }, "Save");
  #restart = h(
    "button",
    {
      class: "primary",
      type: "button",
      title: "Save, end the session, and begin again with this scene",
      onclick: () => void this.#context.scene.restart(),
    },
    "Restart",
  );
  #list = h("div", { class: "problem-list" });
  #view: TextView;
  #shown: "problems" | "text" | undefined;

  constructor(context: Context) {
    this.#context = context;
    this.#view = new TextView(context);
    const end = toolButton("close", "End the editing", () => this.#close());
    end.classList.add("end-edit");
    this.root = h(
      "section",
      { class: "edit", "aria-label": "Scene", hidden: true },
      h(
        "div",
        { class: "edit-bar" },
        this.#name,
        this.#state,
        h("span", { class: "space" }),
        this.#undo,
        this.#redo,
        this.#problems,
        this.#text,
        this.#save,
        this.#restart,
        end,
      ),
      this.#list,
      this.#view.root,
    );
    context.scene.changed.on(() => this.#show());
    document.addEventListener("keydown", (event) => this.#takeKey(event));
    this.#show();
  }

  #close(): void {
    const { scene } = this.#context;
    if (!scene.isChanged || confirm("Changes that are not saved are lost.")) scene.close();
  }

  #toggle(what: "problems" | "text"): void {
    this.#shown = this.#shown === what ? undefined : what;
    this.#show();
    const { scene, selected } = this.#context;
    if (this.#shown === "text") this.#view.showLine(scene.elements.get(selected ?? "")?.line ?? 1);
  }

  #show(): void {
    const { scene } = this.#context;
    this.root.hidden = !scene.isOpen;
    if (!scene.isOpen) return;
    const count = scene.problems.length + scene.omitted;
    setText(this.#name, scene.name);
    this.#name.title = scene.path;
    setText(this.#state, scene.isBusy ? "checking" : scene.isChanged ? "not saved" : "saved");
    setText(this.#problems, count === 0 ? "No problems" : count === 1 ? "1 problem" : `${count} problems`);
    this.#problems.classList.toggle("is-bad", count > 0);
    this.#problems.setAttribute("aria-pressed", String(this.#shown === "problems"));
    this.#text.setAttribute("aria-pressed", String(this.#shown === "text"));
    this.#undo.disabled = !scene.mayUndo;
    this.#redo.disabled = !scene.mayRedo;
    this.#save.disabled = !scene.isChanged || count > 0;
    this.#restart.disabled = count > 0;
    this.#list.hidden = this.#shown !== "problems";
    this.#view.root.hidden = this.#shown !== "text";
    if (!this.#list.hidden) this.#showProblems();
  }

  #showProblems(): void {
    const { scene } = this.#context;
    const rows = scene.problems.map((problem) => {
      const element = problem.path.split(/[.[]/)[0] ?? "";
      const isField = scene.elements.has(element);
      const isHere = problem.file.endsWith(scene.name) && problem.line > 0;
      const go = () => {
        if (isField) this.#context.fieldWanted.emit({ element, key: problem.path.slice(element.length + 1).split(/[.[]/)[0] ?? "" });
        else if (isHere) {
          this.#shown = "text";
          this.#show();
          this.#view.showLine(problem.line);
        }
      };
      return h(
        "button",
        { type: "button", class: "problem", onclick: go, disabled: !isField && !isHere },
        h("span", { class: "place" }, problem.line > 0 ? `${isHere ? "line " : `${problem.file}:`}${problem.line}` : problem.file),
        problem.path && h("b", {}, problem.path),
        h("span", {}, textOf(problem)),
      );
    });
    const more = scene.omitted > 0 && h("p", { class: "help" }, `and ${scene.omitted} more`);
    this.#list.replaceChildren(...(rows.length > 0 ? rows : [h("p", { class: "empty" }, "The scene has no problems.")]));
    if (more) this.#list.append(more);
  }

  // In the text itself the browser's own undo counts.
  #takeKey(event: KeyboardEvent): void {
    const { scene } = this.#context;
    if (!scene.isOpen || !(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const isText = (event.target as HTMLElement).classList?.contains("scene-text");
    if (key === "s") void (scene.isChanged && scene.problems.length === 0 && scene.save());
    else if (key === "z" && !isText) event.shiftKey ? scene.redo() : scene.undo();
    else if (key === "y" && !isText) scene.redo();
    else return;
    event.preventDefault();
  }
}
