// SPDX-License-Identifier: Apache-2.0
// One field of an element as it stands in the scene's text, with unit, range and meaning. What is typed changes the text
// after a moment; problems are shown below.
import { h, setText } from "../dom";
import { type FieldInfo, type SceneElement, type SceneFile, textOf } from "./scene_file";

type Input = HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement;

const kTypedAfterMs = 400;
const kLongText = 34; // characters that one line of the panel holds
const kMostLines = 8;
let lastList = 0;

export class FieldEditor {
  readonly root: HTMLElement;
  readonly key: string;
  #scene: SceneFile;
  #path: string;
  #info: FieldInfo;
  #input: Input;
  #note = h("div", { class: "note", role: "status" });
  #given = h("span", { class: "given" });
  #names?: HTMLDataListElement;
  #timer?: ReturnType<typeof setTimeout>;
  #shown: string; // the text that the scene has
  #sent: string; // the text that was sent last, or that the scene has
  #refusal = "";

  constructor(scene: SceneFile, element: SceneElement, info: FieldInfo) {
    this.#scene = scene;
    this.#info = info;
    this.key = info.key;
    this.#path = `${element.name}.${info.key}`;
    this.#shown = this.#sent = element.fields[info.key]?.text ?? "";
    this.#input = this.#inputOf(this.#sent);
    this.#input.id = `scene-${this.#path}`;
    this.#input.onkeydown = (event) => this.#takeKey(event as KeyboardEvent);
    const help = [info.unit, info.range, info.doc, ...(info.read_with ?? []).map((one) => `read with ${one}`)];
    this.root = h(
      "div",
      { class: "scene-field", "data-field": info.key },
      h(
        "label",
        { htmlFor: this.#input.id },
        info.key,
        info.required && h("span", { class: "mark", title: "required" }, "*"),
        info.live && h("span", { class: "live", title: "may also be changed while the session runs" }, "live"),
        this.#given,
      ),
      this.#input,
      this.#names,
      h("p", { class: "help" }, help.filter((text) => text).join("; ")),
      this.#note,
    );
    this.take(element);
  }

  // The element after a change; what the person is typing stays.
  take(element: SceneElement): void {
    const text = element.fields[this.key]?.text ?? "";
    if (text !== this.#shown) {
      const isTyping = document.activeElement === this.#input && this.#input.value.trim() !== this.#shown;
      this.#shown = text;
      if (!isTyping) {
        this.#input.value = text;
        this.#sent = text;
        this.#refusal = "";
      }
    }
    const given = element.given[this.key];
    setText(this.#given, given && text === "" ? `${given.text} from ${given.place}` : "");
    const names = this.#names ? this.#scene.namesOf(this.#info.reference!) : [];
    this.#names?.replaceChildren(...names.map((name) => h("option", { value: name })));
    this.#showProblems();
  }

  // The name of a point may stand here.
  get takesPoint(): boolean {
    return (this.#info.type === "triple" && this.#info.unit === "m") || /^frame[12]?$/.test(this.key);
  }

  put(value: string): void {
    this.#input.value = value;
    void this.#send();
  }

  focus(): void {
    this.#input.focus();
    this.#input.scrollIntoView({ block: "center" });
  }

  #showProblems(): void {
    const lines = this.#refusal === "" ? this.#scene.problemsOf(this.#path).map(textOf) : [this.#refusal];
    const setting = this.#scene.settings.find((one) => one.startsWith(`${this.#path}=`));
    this.root.classList.toggle("is-bad", lines.length > 0);
    this.#input.setAttribute("aria-invalid", String(lines.length > 0));
    if (setting) lines.push(`the window was started with --set ${setting}, which holds over this value`);
    this.#note.replaceChildren(...lines.map((line) => h("p", {}, line)));
  }

  #inputOf(text: string): Input {
    const { type, choices, default: usual, reference, required } = this.#info;
    const options = type === "boolean" ? ["true", "false"] : choices;
    if (options && (text === "" || options.includes(text))) {
      const none = h("option", { value: "" }, usual ? `${usual} (default)` : "");
      return h(
        "select",
        { value: text, onchange: () => this.#send() },
        (!required || text === "") && none,
        ...options.map((one) => h("option", { value: one, selected: one === text }, one)),
      );
    }
    const isLong = text.includes("\n") || text.length > kLongText || ["table", "triples", "rows"].includes(type);
    const common = { value: text, spellcheck: false, oninput: () => this.#wait(), onblur: () => this.#send() };
    const placeholder = usual !== undefined && usual.length <= kLongText ? usual : "";
    if (isLong) {
      const lines = Math.min(kMostLines, Math.max(2, text.split("\n").length, Math.ceil(text.length / kLongText)));
      return h("textarea", { ...common, rows: lines, placeholder });
    }
    const input = h("input", { ...common, type: "text", autocomplete: "off", placeholder });
    if (reference) {
      this.#names = h("datalist", { id: `names-${++lastList}` });
      input.setAttribute("list", this.#names.id);
    }
    return input;
  }

  #wait(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#send(), kTypedAfterMs);
  }

  async #send(): Promise<void> {
    clearTimeout(this.#timer);
    const value = this.#input.value.trim();
    if (value === this.#sent) return;
    this.#sent = value;
    const { refusal } = await this.#scene.edit({ set: this.#path, value });
    if (this.#input.value.trim() !== value) return; // it was typed on
    this.#refusal = refusal;
    this.#showProblems();
  }

  #takeKey(event: KeyboardEvent): void {
    if (event.key === "Enter" && !(this.#input instanceof HTMLTextAreaElement)) void this.#send();
    if (event.key !== "Escape") return;
    clearTimeout(this.#timer);
    this.#refusal = "";
    this.#sent = this.#shown;
    this.#input.value = this.#shown;
    this.#showProblems();
  }
}
