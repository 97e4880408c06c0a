// SPDX-License-Identifier: Apache-2.0
// The inputs of the machine: the holder and the value of each, and the controls of this page.
import type { Context } from "../context";
import { atMostEvery, download, h, setText } from "../dom";
import { panel, toolButton } from "../panels/panel";
import type { InputInfo } from "../session";
import { formatNumber } from "../units";
import { Driver } from "./driver";
import { Gamepad, type GamepadMap } from "./gamepad";
import { gamepadTable } from "./gamepad_table";
import { csvOf, InputRecord, parseInputs } from "./input_record";
import { Keyboard } from "./keyboard";
import { digitalButton, neutralSlider, showPresent, stick } from "./stick";

const kShowEveryMs = 60;

interface Row {
  input: InputInfo;
  track: HTMLElement;
  value: Element;
  holder: HTMLElement;
  button: HTMLButtonElement;
}

export class OperatePanel {
  readonly root: HTMLElement;
  readonly gamepad: Gamepad;
  #context: Context;
  #driver: Driver;
  #keyboard: Keyboard;
  #record: InputRecord;
  #driven: string[] = []; // names of the inputs that this page may drive
  #rows: Row[] = [];
  #stopWatching: (() => void)[] = []; // of the inputs in the list
  #list = h("div", { class: "inputs" });
  #sticks = h("div", { class: "sticks", hidden: true });
  #map = h("div", { class: "map", hidden: true });
  #keys = toolButton("list", "Operate by the keyboard", () => (this.#keyboard.isOn = !this.#keyboard.isOn), "Keys");
  #pads = toolButton("stick", "Sticks on the screen", () => this.#toggle(this.#sticks, this.#pads), "Sticks");
  #gear = toolButton("gear", "Axes of the gamepad", () => this.#toggle(this.#map, this.#gear));
  #recordTool = h("button", { type: "button", onclick: () => this.#toggleRecord() });
  #playTool = h("button", { type: "button", onclick: () => this.#togglePlay() });
  #recordNote = h("span", { class: "number", role: "status" });
  #file = h("input", { type: "file", accept: ".csv,text/csv", hidden: true, onchange: () => void this.#play() });
  #tables = h("div", { class: "tables" }, this.#recordTool, this.#playTool, this.#recordNote, this.#file);
  #names = ""; // of the inputs in the list

  constructor(context: Context) {
    this.#context = context;
    const { session } = context;
    this.#driver = new Driver(session);
    this.#keyboard = new Keyboard(this.#driver);
    this.#keys.classList.add("keys");
    this.gamepad = new Gamepad(this.#driver);
    this.root = panel("operate", "Operate", [this.#keys, this.#pads, this.#gear], this.#sticks, this.#list, this.#tables, this.#map);
    this.#record = new InputRecord(session, this.#driver);
    this.#record.changed.on(() => this.#showRecord());
    const show = atMostEvery(kShowEveryMs, () => this.#show());
    session.changed.on(() => this.#build());
    session.valuesChanged.on(show);
    this.#driver.changed.on(show);
    this.#keyboard.changed.on(() => {
      this.#keys.classList.toggle("is-on", this.#keyboard.isOn);
      this.#keys.setAttribute("aria-pressed", String(this.#keyboard.isOn));
    });
    this.gamepad.changed.on(() => context.workspaceChanged.emit());
    this.#build();
    this.#showRecord();
  }

  get map(): GamepadMap {
    return this.gamepad.map;
  }
  set map(map: GamepadMap) {
    this.gamepad.map = map;
  }

  // A touch screen begins with the sticks.
  showSticks(): void {
    if (this.#sticks.hidden) this.#toggle(this.#sticks, this.#pads);
  }

  #toggle(part: HTMLElement, button: HTMLElement): void {
    part.hidden = !part.hidden;
    button.classList.toggle("is-on", !part.hidden);
    button.setAttribute("aria-pressed", String(!part.hidden));
  }

  #build(): void {
    const { session } = this.#context;
    const inputs = session.description?.inputs ?? [];
    const names = JSON.stringify([session.maySteer, session.isRecording, inputs]);
    if (names === this.#names) return;
    this.#names = names;
    for (const stop of this.#stopWatching.splice(0)) stop();
    this.#rows = [];
    this.#list.replaceChildren();
    const driven = session.maySteer ? inputs.filter((input) => !input.is_lockstep) : [];
    const analog = driven.filter((input) => !input.is_digital).map((input) => input.name);
    this.#driven = driven.map((input) => input.name);
    this.#tables.hidden = driven.length === 0;
    this.#keyboard.inputs = analog;
    this.gamepad.inputs = analog;
    this.#sticks.replaceChildren(
      ...(analog.length > 0 ? [stick(this.#driver, analog[0], analog[1])] : []),
      ...(analog.length > 2 ? [stick(this.#driver, analog[3], analog[2])] : []),
    );
    this.#map.replaceChildren(gamepadTable(this.gamepad, analog));
    for (const tool of [this.#keys, this.#pads, this.#gear]) tool.hidden = analog.length === 0;
    if (inputs.length === 0) this.#list.append(h("p", { class: "empty" }, "This machine has no inputs."));
    for (const input of inputs) this.#addRow(input);
  }

  #addRow(input: InputInfo): void {
    const { session } = this.#context;
    const { name } = input;
    const isDriven = session.maySteer && !input.is_lockstep;
    const keys = isDriven ? this.#keyboard.keysOf(name) : undefined;
    const value = h("span", { class: "number" });
    const holder = h("span", { class: "holder" });
    const button = h("button", { type: "button", onclick: () => void this.#changeLease(name) });
    const track = !isDriven
      ? h("div", { class: "slider is-passive" }, h("i", { class: "present" }))
      : input.is_digital
        ? digitalButton(this.#driver, name)
        : neutralSlider(this.#driver, name);
    this.#rows.push({ input, track, value, holder, button });
    this.#list.append(
      h(
        "div",
        { class: "input", "data-input": name },
        h("b", {}, name),
        value,
        h("div", { class: "control" }, keys && h("kbd", {}, keys[1]), track, keys && h("kbd", {}, keys[0])),
        !session.isRecording && holder,
        isDriven && button,
      ),
    );
    this.#stopWatching.push(session.watch(name));
  }

  async #changeLease(input: string): Promise<void> {
    const lease = this.#driver.lease(input);
    if (lease === "mine") await this.#driver.release(input);
    else await this.#driver.acquire(input, lease === "other");
  }

  // ---- the inputs as a table

  #toggleRecord(): void {
    if (!this.#record.isRecording) return this.#record.startRecording(this.#driven);
    const table = this.#record.stopRecording();
    if (table) download(`${this.#context.session.description?.scene ?? "session"}-input.csv`, csvOf(table));
  }

  #togglePlay(): void {
    if (this.#record.isPlaying) this.#record.stopPlaying();
    else this.#file.click();
  }

  async #play(): Promise<void> {
    const chosen = this.#file.files?.[0];
    if (!chosen) return;
    try {
      this.#record.play(parseInputs(await chosen.text(), this.#driven));
    } catch (error) {
      const message = `${chosen.name} was not played: ${(error as Error).message}`;
      this.#context.session.noticed.emit({ level: 2, message });
    }
    this.#file.value = "";
  }

  #showRecord(): void {
    const { isRecording, isPlaying, seconds, end } = this.#record;
    setText(this.#recordTool, isRecording ? "Stop and save" : "Record input");
    setText(this.#playTool, isPlaying ? "Stop" : "Play input");
    this.#recordTool.title = isRecording
      ? "End the recording and save it as a table of `slewring run --input`"
      : "Record the inputs from now on, whoever moves them";
    this.#playTool.title = isPlaying ? "End the playback; the inputs go to neutral" : "Play a recorded table from now on";
    this.#recordTool.disabled = isPlaying;
    this.#playTool.disabled = isRecording;
    this.#tables.classList.toggle("is-on", isRecording || isPlaying);
    const state = `${seconds.toFixed(1)} ${isPlaying ? `of ${end.toFixed(1)} ` : ""}s`;
    setText(this.#recordNote, isRecording || isPlaying ? state : "");
  }

  #show(): void {
    const { session } = this.#context;
    this.#showRecord();
    for (const { input, track, value, holder, button } of this.#rows) {
      const present = session.values.get(`${input.name}.raw`) ?? 0;
      setText(value, formatNumber(Math.round(present * 1000) / 1000));
      if (track.classList.contains("slider")) showPresent(track, present);
      const lease = this.#driver.lease(input.name);
      const name = this.#driver.holder(input.name);
      holder.className = `holder is-${lease}`;
      setText(
        holder,
        lease === "mine"
          ? "held by this page"
          : name !== ""
            ? `held by ${name}`
            : lease === "requested"
              ? "requested"
              : "free",
      );
      if (input.is_lockstep) setText(holder, "held by a controller in lockstep");
      setText(button, lease === "mine" ? "Release" : lease === "other" ? "Take over" : "Take");
    }
  }
}
