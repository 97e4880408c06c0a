// SPDX-License-Identifier: Apache-2.0
// The whole text of the scene with the numbers of its lines; lines with problems are marked.
import type { Context } from "../context";
import { h } from "../dom";
import { textOf } from "./scene_file";

const kTypedAfterMs = 600;

export class TextView {
  readonly root: HTMLElement;
  #context: Context;
  #numbers = h("div", { class: "line-numbers", "aria-hidden": "true" });
  #input = h("textarea", { class: "scene-text", spellcheck: false, "aria-label": "Text of the scene", wrap: "off" });
  #timer?: ReturnType<typeof setTimeout>;

  constructor(context: Context) {
    this.#context = context;
    this.root = h("div", { class: "text-view" }, this.#numbers, this.#input);
    this.#input.onscroll = () => (this.#numbers.scrollTop = this.#input.scrollTop);
    this.#input.oninput = () => {
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => void this.#send(), kTypedAfterMs);
      this.#showNumbers();
    };
    this.#input.onblur = () => void this.#send();
    context.scene.changed.on(() => this.#show());
  }

  showLine(line: number): void {
    this.#show();
    const lines = this.#input.value.split("\n");
    const begin = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    this.#input.focus();
    this.#input.setSelectionRange(begin, begin + (lines[line - 1]?.length ?? 0));
    // after the browser's own way to the selection
    this.#input.scrollTop = Math.max(0, (line - 4) * (this.#input.scrollHeight / lines.length));
    this.#input.scrollLeft = 0;
  }

  async #send(): Promise<void> {
    clearTimeout(this.#timer);
    // a text area has line feeds alone
    const text = this.#context.scene.text.includes("\r\n") ? this.#input.value.replace(/\n/g, "\r\n") : this.#input.value;
    if (text !== this.#context.scene.text) await this.#context.scene.replaceText(text);
  }

  #show(): void {
    if (!this.root.isConnected || this.root.hidden) return;
    const text = this.#context.scene.text.replace(/\r\n/g, "\n");
    if (document.activeElement !== this.#input && this.#input.value !== text) this.#input.value = text;
    this.#showNumbers();
  }

  #showNumbers(): void {
    const { problems, name } = this.#context.scene;
    const faults = new Map(problems.filter((one) => one.file.endsWith(name)).map((one) => [one.line, textOf(one)]));
    const count = this.#input.value.split("\n").length;
    const rows = Array.from({ length: count }, (_, i) =>
      h("div", { class: faults.has(i + 1) && "is-bad", title: faults.get(i + 1) }, String(i + 1)),
    );
    this.#numbers.replaceChildren(...rows);
    this.#numbers.scrollTop = this.#input.scrollTop;
  }
}
