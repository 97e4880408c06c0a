// SPDX-License-Identifier: Apache-2.0
// The samples of curves over time: of a live session what has come so far; of a recording, and of those beside it, all
// that it has, read in the resolution of the picture.
import uPlot from "uplot";
import { Emitter } from "../dom";
import { type Column, lowerBound } from "../samples";
import type { Session } from "../session";
import type { ServiceAnswer } from "../protocol";

export interface CurveId {
  name: string; // of the variable
  recording: number; // of the window; 0: the session's own
}

// A part of a curve as the window sent it.
interface Part {
  from: number;
  to: number; // s
  isThinned: boolean;
  times: number[];
  values: Column;
}
interface CurvesAnswer extends ServiceAnswer {
  samples: number;
  curves: { name: string; times: number[]; values: Column }[];
}

const kRequestAfterMs = 40; // names and ranges of this time make one request
const kRetryAfterMs = 2000; // when the window did not answer
const kMostNames = 32; // of a request
const kMostValues = 4000; // of a curve in a picture
const kMostExact = 200_000; // of a curve in a file
const kCoarsest = 4; // a thinned part serves ranges of its length down to this fraction

const nothing: Part = { from: 0, to: 0, isThinned: false, times: [], values: [] };

export class CurveStore {
  readonly changed = new Emitter(); // parts have come
  #session: Session;
  #parts = new Map<string, Part[]>(); // by recording and name: the whole curve, and the range that was zoomed last
  #wanted = new Map<number, Set<string>>(); // names by recording
  #range: [number, number] = [0, 0]; // of what is wanted
  #timer?: ReturnType<typeof setTimeout>;
  #isReading = false;
  #notBefore = 0; // ms, of the next request
  showsBeside = true; // curves of the other recordings too

  constructor(session: Session) {
    this.#session = session;
    session.restarted.on(() => this.#parts.clear());
  }

  // Recordings whose curves are shown.
  get shown(): number[] {
    const count = this.showsBeside ? (this.#session.description?.recordings?.length ?? 1) : 1;
    return Array.from({ length: Math.max(1, count) }, (_, i) => i);
  }
  nameOf(recording: number): string {
    return this.#session.description?.recordings?.[recording] ?? "";
  }

  // Rows that reach the borders of the range or lie behind them, of several curves over common times.
  table(curves: CurveId[], from: number, to: number): uPlot.AlignedData {
    if (curves.length === 0) return [[]];
    if (!this.#session.isRecording) {
      const { samples } = this.#session;
      const [first, last] = samples.rows(from, to);
      const columns = curves.map((curve) => (samples.columns.get(curve.name) ?? []).slice(first, last));
      return [samples.times.slice(first, last), ...columns];
    }
    return aligned(curves.map((curve) => cut(this.#part(curve, from, to), from, to)));
  }

  // The last value at or before a time.
  valueAt(curve: CurveId, time: number): { time: number; value: number } | undefined {
    if (!this.#session.isRecording) return this.#session.samples.valueAt(curve.name, time);
    const part = this.#part(curve, time, time);
    let row = lowerBound(part.times, time);
    if (part.times[row] !== time) --row;
    for (; row >= 0; --row) {
      const value = part.values[row];
      if (typeof value === "number") return { time: part.times[row]!, value };
    }
    return undefined;
  }

  // The picture shows the least and the largest values of a curve, not every sample.
  isThinned(curve: CurveId, from: number, to: number): boolean {
    return this.#session.isRecording && this.#part(curve, from, to).isThinned;
  }

  // Every sample of the range, for a file. Throws an error with the reason when there are too many.
  async exactTable(curves: CurveId[], from: number, to: number): Promise<uPlot.AlignedData> {
    const { isRecording, samples } = this.#session;
    if (!isRecording) {
      const [first, last] = [lowerBound(samples.times, from), lowerBound(samples.times, to + 1e-12)];
      const columns = curves.map((curve) => (samples.columns.get(curve.name) ?? []).slice(first, last));
      return [samples.times.slice(first, last), ...columns];
    }
    const parts = new Map<string, Part>();
    for (const recording of new Set(curves.map((curve) => curve.recording))) {
      const names = curves.filter((curve) => curve.recording === recording).map((curve) => curve.name);
      for (const [name, part] of await this.#read(recording, names, from, to, kMostExact)) {
        if (part.isThinned)
          throw new Error(`the range has more than ${kMostExact} samples: zoom in, or use 'slewring export'`);
        parts.set(keyOf({ recording, name }), part);
      }
    }
    return aligned(curves.map((curve) => parts.get(keyOf(curve)) ?? nothing));
  }

  // The part that serves the range best; a better one is requested.
  #part(curve: CurveId, from: number, to: number): Part {
    const whole = this.#session.info?.range;
    const parts = this.#parts.get(keyOf(curve)) ?? [];
    const covering = parts.filter((part) => part.from <= Math.max(from, whole?.from ?? 0) && part.to >= Math.min(to, whole?.to ?? to));
    const fine = covering.find((part) => !part.isThinned || part.to - part.from <= kCoarsest * (to - from));
    if (!fine && to > from) this.#want(curve, from, to);
    return fine ?? covering.at(-1) ?? parts[0] ?? nothing;
  }

  #want({ name, recording }: CurveId, from: number, to: number): void {
    let names = this.#wanted.get(recording);
    if (!names) this.#wanted.set(recording, (names = new Set()));
    names.add(name);
    this.#range = [from, to];
    if (!this.#isReading && performance.now() >= this.#notBefore) this.#timer ??= setTimeout(() => void this.#readWanted(), kRequestAfterMs);
  }

  async #readWanted(): Promise<void> {
    this.#timer = undefined;
    const [from, to] = this.#range;
    const wanted = [...this.#wanted];
    const whole = this.#session.info?.range;
    this.#wanted.clear();
    if (!whole) return;
    this.#isReading = true;
    try {
      for (const [recording, names] of wanted) await this.#readParts(recording, [...names], from, to, whole);
    } catch {
      this.#notBefore = performance.now() + kRetryAfterMs; // there was a notice; what is drawn next requests again
    }
    this.#isReading = false;
    if (this.#wanted.size > 0) this.#timer ??= setTimeout(() => void this.#readWanted(), kRequestAfterMs);
  }

  // The whole curves first, then a range with margins, so that moving it needs nothing new.
  async #readParts(recording: number, names: string[], from: number, to: number, whole: { from: number; to: number }): Promise<void> {
    const isFirst = names.some((name) => !this.#parts.has(keyOf({ name, recording })));
    const margin = isFirst ? Infinity : (to - from) / 2;
    const range = [Math.max(whole.from, from - margin), Math.min(whole.to, to + margin)] as const;
    const read = await this.#read(recording, names, ...range, kMostValues);
    for (const name of names) {
      const part = read.get(name) ?? { ...nothing, from: range[0], to: range[1] }; // the recording has no such variable
      const key = keyOf({ name, recording });
      this.#parts.set(key, isFirst ? [part] : [this.#parts.get(key)![0]!, part]);
    }
    this.changed.emit();
  }

  // Throws an error with the reason of a refusal.
  async #read(recording: number, names: string[], from: number, to: number, most: number): Promise<Map<string, Part>> {
    const parts = new Map<string, Part>();
    for (let i = 0; i < names.length; i += kMostNames) {
      const request = { recording, names: names.slice(i, i + kMostNames), from, to, most };
      const answer = await this.#session.call<CurvesAnswer>("curves", request);
      if (!answer.accepted) throw new Error(answer.reason);
      for (const { name, times, values } of answer.curves)
        parts.set(name, { from, to, isThinned: answer.samples > 1, times, values });
    }
    return parts;
  }
}

const keyOf = (curve: CurveId) => `${curve.recording}/${curve.name}`;

// From the last sample before the range to the first one behind it.
function cut(part: Part, from: number, to: number): Part {
  const first = Math.max(0, lowerBound(part.times, from) - 1);
  const last = lowerBound(part.times, to) + 1;
  return { ...part, times: part.times.slice(first, last), values: part.values.slice(first, last) };
}

// Curves of their own times over the times of all; undefined where a curve has no sample.
function aligned(parts: Part[]): uPlot.AlignedData {
  const isCommon = parts.every((part) => part.times.length === parts[0]!.times.length && part.times.every((t, i) => t === parts[0]!.times[i]));
  if (isCommon) return [parts[0]!.times, ...parts.map((part) => part.values)];
  return uPlot.join(parts.map((part) => [part.times, part.values]));
}
