// SPDX-License-Identifier: Apache-2.0
// The time that all plots show: the last so many seconds, or a range that stands still while samples go on.
import { Emitter } from "../dom";
import type { Session } from "../session";

const kShortest = 1e-3; // s

export class TimeAxis {
  readonly changed = new Emitter();
  #session: Session;
  #length = 10; // s; Infinity: everything
  #fixed?: [number, number];

  constructor(session: Session) {
    this.#session = session;
    session.restarted.on(() => this.follow());
  }

  get range(): [number, number] {
    if (this.#fixed) return this.#fixed;
    const { info, samples, time } = this.#session;
    if (Number.isFinite(this.#length)) return [time - this.#length, time];
    const [from, to] = info?.range ? [info.range.from, info.range.to] : [samples.times[0] ?? time, time];
    return [from, Math.max(to, from + kShortest)];
  }

  get length(): number {
    return this.#length;
  }
  set length(length: number) {
    this.#length = length;
    this.follow();
  }

  get isFollowing(): boolean {
    return this.#fixed === undefined;
  }

  follow(): void {
    this.#fixed = undefined;
    this.changed.emit();
  }

  hold(): void {
    this.#fixed = [...this.range];
    this.changed.emit();
  }

  show(from: number, to: number): void {
    if (to - from < kShortest) return;
    this.#fixed = [from, to];
    this.changed.emit();
  }

  // factor: new length over the present one; around a time.
  zoom(factor: number, around: number): void {
    const [from, to] = this.range;
    this.show(around + (from - around) * factor, around + (to - around) * factor);
  }

  move(part: number): void {
    const [from, to] = this.range;
    const way = part * (to - from);
    this.show(from + way, to + way);
  }
}
