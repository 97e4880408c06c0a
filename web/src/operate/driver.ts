// SPDX-License-Identifier: Apache-2.0
// The values that this page sends to the inputs, and the holders of the inputs.
//
// Each source (pointer, keyboard, gamepad, a table of recorded values) has a demand for an input; the one farthest from
// neutral counts. An input is leased when it first leaves neutral. While it is away from neutral, and for kTailMs after,
// its value is sent every kSendEveryMs. A page that is hidden or suspended sends nothing more: the window then puts the
// input to neutral.
import { Emitter } from "../dom";
import type { Session } from "../session";

const kSendEveryMs = 30; // the window goes to neutral after 150 ms
const kTailMs = 400; // neutral is sent for so long, so that the last value cannot be a lost one

export type Source = "pointer" | "keyboard" | "gamepad" | "table";
export type Lease = "free" | "requested" | "mine" | "other";

interface Driven {
  demands: Map<Source, number>;
  lease: Lease;
  sendUntil: number; // ms, monotonic
  isConfirmed: boolean; // the session's state has shown this page as the holder
  wasRefused: boolean; // not requested again before the input was at neutral
}

export class Driver {
  readonly changed = new Emitter(); // leases or values
  readonly beforeSending = new Emitter(); // sources renew their demands
  #session: Session;
  #inputs = new Map<string, Driven>();
  #ownName?: string; // of this page in leases
  #timer?: ReturnType<typeof setInterval>;

  constructor(session: Session) {
    this.#session = session;
    session.changed.on(() => this.#takeInputs());
    session.stateChanged.on(() => this.#takeHolders());
    session.restarted.on(() => this.#forgetLeases()); // a reset frees all inputs
    document.addEventListener("visibilitychange", () => (document.hidden ? this.#stop() : this.#start()));
    // freeze and resume are events of the document that do not bubble
    for (const name of ["pagehide", "freeze"]) window.addEventListener(name, () => this.#stop(), { capture: true });
    for (const name of ["pageshow", "resume"]) window.addEventListener(name, () => this.#start(), { capture: true });
    this.#start();
  }

  lease(input: string): Lease {
    return this.#inputs.get(input)?.lease ?? "free";
  }
  holder(input: string): string {
    return this.#session.state?.holders[input] ?? "";
  }
  value(input: string): number {
    const demands = this.#inputs.get(input)?.demands.values() ?? [];
    return [...demands].reduce((best, demand) => (Math.abs(demand) > Math.abs(best) ? demand : best), 0);
  }

  // value: -1 to 1; 0 is neutral.
  demand(source: Source, input: string, value: number): void {
    const driven = this.#inputs.get(input);
    const limited = Math.min(1, Math.max(-1, value));
    if (!driven || driven.demands.get(source) === limited) return;
    driven.demands.set(source, limited);
    this.changed.emit();
  }

  neutralize(): void {
    for (const driven of this.#inputs.values()) driven.demands.clear();
    this.changed.emit();
  }

  async acquire(input: string, takeOver: boolean): Promise<void> {
    const driven = this.#inputs.get(input);
    if (!driven || driven.lease === "mine" || driven.lease === "requested") return;
    driven.lease = "requested";
    this.changed.emit();
    const answer = await this.#session.call("lease", { input, take_over: takeOver });
    driven.lease = answer.accepted ? "mine" : "free";
    driven.isConfirmed = false;
    driven.wasRefused = !answer.accepted;
    this.changed.emit(); // the state of the session, which is older, follows
  }

  async release(input: string): Promise<void> {
    const driven = this.#inputs.get(input);
    if (!driven) return;
    driven.demands.clear();
    driven.sendUntil = 0;
    await this.#session.call("release", { input });
    driven.lease = "free";
    this.changed.emit();
  }

  #takeInputs(): void {
    if (!this.#session.isConnected) {
      this.#forgetLeases();
      this.#ownName = undefined;
    }
    for (const { name, is_lockstep } of this.#session.description?.inputs ?? []) {
      if (!is_lockstep && !this.#inputs.has(name))
        this.#inputs.set(name, {
          demands: new Map(),
          lease: "free",
          sendUntil: 0,
          isConfirmed: false,
          wasRefused: false,
        });
    }
    this.changed.emit();
  }

  #forgetLeases(): void {
    for (const driven of this.#inputs.values()) driven.lease = "free";
    this.neutralize();
  }

  #takeHolders(): void {
    for (const [input, driven] of this.#inputs) {
      const holder = this.holder(input);
      if (driven.lease === "mine" && holder !== "") this.#ownName ??= holder;
      if (driven.lease === "requested") continue;
      if (holder !== "") {
        driven.lease = holder === this.#ownName ? "mine" : "other";
        driven.isConfirmed = driven.lease === "mine";
      } else if (driven.lease === "other" || driven.isConfirmed) {
        driven.lease = "free"; // else the state is older than the answer to the request
        driven.isConfirmed = false;
      }
    }
    this.changed.emit();
  }

  #start(): void {
    this.#timer ??= setInterval(() => this.#send(), kSendEveryMs);
  }

  #stop(): void {
    clearInterval(this.#timer);
    this.#timer = undefined;
    for (const driven of this.#inputs.values()) driven.sendUntil = 0;
    this.neutralize();
  }

  #send(): void {
    this.beforeSending.emit();
    const now = performance.now();
    for (const [input, driven] of this.#inputs) {
      const value = this.value(input);
      if (value === 0) driven.wasRefused = false;
      else if (driven.lease === "free" && !driven.wasRefused) void this.acquire(input, false);
      if (driven.lease !== "mine") continue;
      if (value !== 0) driven.sendUntil = now + kTailMs;
      if (now < driven.sendUntil) this.#session.publishInput(input, value);
    }
  }
}
