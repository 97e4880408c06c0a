// SPDX-License-Identifier: Apache-2.0
// A recording on a slider: play, pause, speed, and its events as marks.
import type { Context } from "../context";
import { atMostEvery, h, setText } from "../dom";
import { icon } from "../icons";
import type { ServiceAnswer } from "../protocol";
import { formatTime } from "../units";
import { toolButton } from "./panel";

const kShowEveryMs = 40;
const kStepSeconds = 0.1; // of the arrow keys
const speeds = [0.1, 0.25, 0.5, 1, 2, 4, 10];

export class PlaybackBar {
  readonly root: HTMLElement;
  #context: Context;
  #play = toolButton("play", "Play", () => this.#toggle());
  #slider = h("input", { type: "range", min: "0", max: "1", step: "0.001", "aria-label": "Time of the recording" });
  #speed = h("select", { title: "Speed over real time", "aria-label": "Speed" });
  #end = h("span", { class: "number" });
  #takeOver = h(
    "button",
    { type: "button", title: "Start a live session that goes on from this time", onclick: () => void this.#goLive() },
    "Take over",
  );
  #isDragging = false;

  constructor(context: Context) {
    this.#context = context;
    const { session } = context;
    for (const speed of speeds) this.#speed.append(h("option", { value: String(speed) }, `${speed} ×`));
    this.#speed.value = "1";
    this.#speed.onchange = () => session.controlPlayback({ speed: Number(this.#speed.value) });
    const seek = atMostEvery(kShowEveryMs, () => session.controlPlayback({ seek: Number(this.#slider.value) }));
    this.#slider.oninput = seek;
    this.#slider.onpointerdown = () => (this.#isDragging = true);
    this.#slider.onpointerup = this.#slider.onpointercancel = () => (this.#isDragging = false);
    this.#slider.onkeydown = (event) => {
      const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (direction === undefined) return;
      event.preventDefault();
      this.#slider.value = String(Number(this.#slider.value) + direction * kStepSeconds * (event.shiftKey ? 10 : 1));
      seek();
    };
    this.root = h(
      "footer",
      { class: "playback", hidden: true },
      this.#play,
      this.#slider,
      this.#end,
      this.#speed,
      this.#takeOver,
    );
    const show = atMostEvery(kShowEveryMs, () => this.#show());
    for (const event of [session.changed, session.valuesChanged, session.playbackChanged]) event.on(show);
  }

  #toggle(): void {
    const { session } = this.#context;
    const { status } = session.playback;
    if (status === "ended") session.controlPlayback({ isPlaying: true, seek: session.info?.range?.from ?? 0 });
    else session.controlPlayback({ isPlaying: status !== "playing" });
  }

  // The steps up to this time are computed again, which takes a while.
  async #goLive(): Promise<void> {
    const { session } = this.#context;
    this.#takeOver.disabled = true;
    session.noticed.emit({ level: 0, message: "the recorded steps up to this time are computed again" });
    const answer = await session.call<ServiceAnswer & { page: string }>("take_over", { time: session.time });
    this.#takeOver.disabled = false;
    if (answer.accepted && answer.page) location.assign(answer.page);
  }

  #show(): void {
    const { session } = this.#context;
    const range = session.info?.range;
    this.root.hidden = range === undefined;
    if (!range) return;
    this.#takeOver.hidden = !session.protocol.services.has("take_over");
    this.#slider.min = String(range.from);
    this.#slider.max = String(range.to);
    if (!this.#isDragging) this.#slider.value = String(session.time);
    setText(this.#end, `${formatTime(session.time)} of ${formatTime(range.to)}`);
    const wanted = session.playback.status === "playing" ? "Pause" : "Play";
    if (this.#play.title !== wanted) {
      this.#play.replaceChildren(icon(wanted === "Play" ? "play" : "pause"));
      this.#play.title = wanted;
      this.#play.setAttribute("aria-label", wanted);
    }
    const speed = String(+session.playback.speed.toFixed(3));
    if (document.activeElement !== this.#speed && speeds.map(String).includes(speed)) this.#speed.value = speed;
  }
}
