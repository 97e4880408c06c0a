// SPDX-License-Identifier: Apache-2.0
// A live parameter as a field: its value with unit, range and meaning; Update sends it, and the answer of the session
// is shown: the step from which the value holds, or the reason of a refusal.
import { h } from "../dom";
import type { Parameter } from "../protocol";
import type { Session } from "../session";

const kDigits = 9;

export class ParameterField {
  readonly root: HTMLElement;
  #session: Session;
  #parameter: Parameter;
  #input: HTMLInputElement | HTMLSelectElement;
  #update = h("button", { class: "update", type: "submit", disabled: true }, "Update");
  #note = h("p", { class: "note", role: "status" });
  #isWaiting = false;

  constructor(session: Session, parameter: Parameter) {
    this.#session = session;
    this.#parameter = parameter;
    const label = parameter.name.slice(parameter.name.indexOf(".") + 1);
    const id = `parameter-${parameter.name}`;
    const unit = parameter.unit === "1" ? "" : parameter.unit;
    this.#input = parameter.choices
      ? h("select", { id }, ...parameter.choices.map((choice) => h("option", { value: choice }, choice)))
      : h("input", { id, type: "text", inputMode: "decimal", spellcheck: false, autocomplete: "off" });
    this.#input.oninput = () => this.#compare();
    this.#input.onkeydown = (event) => {
      if (event.key !== "Escape") return;
      this.#showValue();
      this.#compare();
    };
    const help = [parameter.doc, parameter.choices ? "" : parameter.range].filter((text) => text !== "").join("; ");
    this.root = h(
      "form",
      {
        class: "parameter",
        onsubmit: (event: Event) => {
          event.preventDefault();
          void this.#send();
        },
      },
      h("label", { htmlFor: id }, label),
      h("div", { class: "entry" }, this.#input, h("span", { class: "unit" }, unit), this.#update),
      help !== "" && h("p", { class: "help" }, help),
      this.#note,
    );
    this.#showValue();
  }

  // A new value from the session; what the person is typing stays.
  take(parameter: Parameter): void {
    const isEdited = this.#isEdited;
    const isOther = parameter.value !== this.#parameter.value; // changed by another client
    this.#parameter = parameter;
    if (!isEdited) this.#showValue();
    if (isOther && !this.#isWaiting) {
      this.root.classList.remove("is-refused");
      this.#note.textContent = parameter.step === undefined ? "changed" : `holds from step ${parameter.step}`;
    }
    this.#compare();
  }

  // What the field shows of the value: a number with up to kDigits digits.
  get #text(): string {
    const { value } = this.#parameter;
    return typeof value === "number" ? String(Number(value.toPrecision(kDigits))) : value;
  }

  get #isEdited(): boolean {
    return this.#input.value.trim() !== this.#text;
  }

  #showValue(): void {
    this.#input.value = this.#text;
  }

  #compare(): void {
    this.#update.disabled = this.#isWaiting || !this.#isEdited || !this.#session.maySteer;
    this.root.classList.toggle("is-edited", this.#isEdited);
  }

  async #send(): Promise<void> {
    const text = this.#input.value.trim();
    if (this.#isWaiting || text === "") return;
    const number = Number(text);
    this.#isWaiting = true;
    this.#compare();
    this.root.classList.remove("is-refused");
    this.#note.textContent = "waiting for the session";
    const { parameter, problem } = await this.#session.setParameter(
      this.#parameter.name,
      this.#parameter.choices || !Number.isFinite(number) ? text : number,
    );
    this.#isWaiting = false;
    this.root.classList.toggle("is-refused", problem !== undefined);
    if (problem === undefined) {
      if (parameter) this.#parameter = parameter;
      this.#showValue();
      this.#note.textContent = parameter?.step === undefined ? "updated" : `holds from step ${parameter.step}`;
    } else {
      this.#note.textContent = problem.replace(`${this.#parameter.name}: `, "");
    }
    this.#compare();
  }
}
