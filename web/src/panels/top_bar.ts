// SPDX-License-Identifier: Apache-2.0
// The name of the session, its time, and what runs or stops it.
import type { Context } from "../context";
import { atMostEvery, type Child, h, setText } from "../dom";
import { icon } from "../icons";
import { formatTime } from "../units";
import { toolButton } from "./panel";

const kShowEveryMs = 60;

export class TopBar {
  readonly root: HTMLElement;
  #context: Context;
  #name = h("b", { class: "session-name" });
  #mode = h("span", { class: "mode" });
  #time = h("span", { class: "time number", title: "Time of the session" });
  #step = h("span", { class: "step number", title: "Step of the session" });
  #run = toolButton("pause", "Pause", () => void this.#toggleRun(), "Pause");
  #steps = h("input", { type: "number", min: "1", value: "1", title: "Steps at once", "aria-label": "Steps at once" });
  #controls: HTMLElement;
  #saved: HTMLElement;

  constructor(context: Context, menu: Child) {
    this.#context = context;
    const { session } = context;
    const step = toolButton("step", "Compute so many steps, then stay paused", () => void this.#runSteps(), "Step");
    const reset = toolButton("reset", "Begin again from the start", () => void session.call("reset"), "Reset");
    const name = h("input", {
      type: "text",
      value: "state",
      title: "Name of the saved state",
      "aria-label": "Name of the saved state",
      spellcheck: false,
    });
    const keep = (service: string, text: string, title: string) =>
      h("button", { class: "tool", type: "button", title, onclick: () => void this.#keep(service, name.value) }, text);
    this.#saved = h(
      "div",
      { class: "saved" },
      name,
      keep("save", "Save", "Save the state of the session under this name"),
      keep("load", "Load", "Continue from the saved state of this name"),
    );
    this.#controls = h("div", { class: "controls" }, this.#run, step, this.#steps, reset);
    this.root = h(
      "header",
      { class: "top" },
      h("span", { class: "brand" }, "Slewring"),
      this.#name,
      this.#mode,
      this.#controls,
      this.#saved,
      h("span", { class: "space" }),
      this.#step,
      this.#time,
      menu,
    );
    const show = atMostEvery(kShowEveryMs, () => this.#show());
    for (const event of [session.changed, session.stateChanged, session.valuesChanged]) event.on(show);
    this.#show();
  }

  async #toggleRun(): Promise<void> {
    const { session } = this.#context;
    await session.call(session.state?.is_paused ? "resume" : "pause");
  }

  async #runSteps(): Promise<void> {
    const { session } = this.#context;
    const steps = Math.max(1, Math.round(Number(this.#steps.value) || 1));
    if (!session.state?.is_paused && !(await session.call("pause")).accepted) return;
    await session.call("step", { steps });
  }

  async #keep(service: string, name: string): Promise<void> {
    const { session } = this.#context;
    const answer = await session.call(service, { name });
    if (!answer.accepted) return;
    const text = service === "save" ? `the state of step ${answer.step} is saved as '${name}'` : `'${name}' is loaded`;
    session.noticed.emit({ level: 0, message: text });
  }

  #show(): void {
    const { session } = this.#context;
    const { isRecording, isConnected, state, description } = session;
    const isPaused = state?.is_paused ?? false;
    setText(this.#name, description ? description.session : (session.info?.name ?? ""));
    this.#name.title = description ? `scene ${description.scene}` : "";
    document.title = description ? `${description.session} – Slewring` : "Slewring";
    const mode = !isConnected ? "not connected" : isRecording ? "recording" : isPaused ? "paused" : "running";
    setText(this.#mode, mode);
    this.#mode.className = `mode is-${mode.replace(" ", "-")}`;
    this.#mode.title = session.lostReason ? `${session.lostReason}; connecting again each second` : "";
    this.#controls.hidden = isRecording || !session.maySteer;
    this.#saved.hidden = isRecording || !session.maySteer;
    const wanted = isPaused ? "Run" : "Pause";
    if (this.#run.textContent !== wanted) {
      this.#run.replaceChildren(icon(isPaused ? "play" : "pause"), h("span", {}, wanted));
      this.#run.title = wanted;
      this.#run.setAttribute("aria-label", wanted);
    }
    setText(this.#step, isRecording ? "" : `step ${state?.step ?? 0}`);
    setText(this.#time, formatTime(session.time));
  }
}
