// SPDX-License-Identifier: Apache-2.0
// Inputs by keys: while the keyboard is switched on and no field has the focus. With Ctrl, Alt or the system's key they
// are commands of the browser.
import { Emitter } from "../dom";
import type { Driver } from "./driver";

// pairs for the first inputs: more, less
const pairs = [
  ["KeyD", "KeyA"],
  ["KeyW", "KeyS"],
  ["ArrowUp", "ArrowDown"],
  ["ArrowRight", "ArrowLeft"],
  ["KeyE", "KeyQ"],
  ["KeyR", "KeyF"],
] as const;
const texts: Record<string, string> = { ArrowUp: "↑", ArrowDown: "↓", ArrowRight: "→", ArrowLeft: "←" };
const textOf = (code: string) => texts[code] ?? code.replace("Key", "");

export class Keyboard {
  readonly changed = new Emitter();
  #driver: Driver;
  #isOn = false;
  #inputs: string[] = [];
  #down = new Set<string>();

  constructor(driver: Driver) {
    this.#driver = driver;
    window.addEventListener("keydown", (event) => this.#take(event, true));
    window.addEventListener("keyup", (event) => this.#take(event, false));
    // keys that are released elsewhere are never seen
    window.addEventListener("blur", () => this.#releaseAll());
    window.addEventListener("focusin", () => this.#isTyping() && this.#releaseAll());
  }

  get isOn(): boolean {
    return this.#isOn;
  }
  set isOn(isOn: boolean) {
    this.#isOn = isOn;
    this.#releaseAll();
    this.changed.emit();
  }

  set inputs(inputs: string[]) {
    this.#inputs = inputs;
  }

  // The keys of an input for the person: more, less.
  keysOf(input: string): [string, string] | undefined {
    const pair = pairs[this.#inputs.indexOf(input)];
    return pair && [textOf(pair[0]), textOf(pair[1])];
  }

  #isTyping(): boolean {
    return document.activeElement?.matches("input:not([type=range]), select, textarea") ?? false;
  }

  #take(event: KeyboardEvent, isDown: boolean): void {
    if (!this.#isOn) return;
    if (isDown) {
      // not all browsers report the release of a key during a command: every input goes to neutral
      if (event.ctrlKey || event.metaKey || event.altKey) return this.#releaseAll();
      if (event.defaultPrevented || this.#isTyping()) return;
    }
    const at = pairs.findIndex((pair) => (pair as readonly string[]).includes(event.code));
    if (at < 0 || at >= this.#inputs.length) return;
    event.preventDefault();
    event.stopPropagation();
    if (isDown) this.#down.add(event.code);
    else this.#down.delete(event.code);
    this.#apply(at);
  }

  #apply(at: number): void {
    const [more, less] = pairs[at]!;
    this.#driver.demand("keyboard", this.#inputs[at]!, Number(this.#down.has(more)) - Number(this.#down.has(less)));
  }

  #releaseAll(): void {
    this.#down.clear();
    this.#inputs.forEach((_, at) => at < pairs.length && this.#apply(at));
  }
}
