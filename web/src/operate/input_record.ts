// SPDX-License-Identifier: Apache-2.0
// The operator's inputs as a table over time, which the page records and plays: the format of `slewring run --input`.
// Time 0 is the begin of the recording; played, that of the playback.
import { Emitter } from "../dom";
import { lowerBound } from "../samples";
import type { Session } from "../session";
import type { Driver } from "./driver";

export interface InputTable {
  names: string[];
  times: number[]; // s, ascending
  rows: number[][]; // by time and name, -1 to 1
}

const kMostRows = 1_000_000;

export function csvOf(table: InputTable): Blob {
  const lines = table.times.map((time, i) => [+time.toFixed(6), ...table.rows[i]!].join(","));
  return new Blob([`${[["time", ...table.names].join(","), ...lines].join("\n")}\n`], { type: "text/csv" });
}

// Throws an error with the reason when the text is no table of these inputs.
export function parseInputs(text: string, inputs: string[]): InputTable {
  const [head = "", ...lines] = text.split(/\r?\n/).filter((line) => line.trim() !== "");
  const columns = head.split(",").map((column) => column.trim());
  const names = columns.slice(1);
  if (!/^time( \[s\])?$/.test(columns[0] ?? "")) throw new Error("its first column is not 'time'");
  if (names.length === 0) throw new Error("it has no input");
  const unknown = names.find((name) => !inputs.includes(name));
  if (unknown !== undefined) throw new Error(`this session has no input '${unknown}' that a page may drive`);
  if (lines.length === 0) throw new Error("it has no row");
  if (lines.length > kMostRows) throw new Error(`it has more than ${kMostRows} rows`);
  const table: InputTable = { names, times: [], rows: [] };
  lines.forEach((line, i) => {
    const fields = line.split(",");
    const [time, ...row] = fields.map((field) => (field.trim() === "" ? NaN : Number(field)));
    const isRight = fields.length === columns.length && [time, ...row].every(Number.isFinite) && row.every((value) => Math.abs(value) <= 1);
    if (!isRight) throw new Error(`line ${i + 2} is not a time and ${names.length} values from -1 to 1`);
    if (time! < 0 || (table.times.at(-1) ?? 0) > time!) throw new Error(`the time in line ${i + 2} falls or is negative`);
    table.times.push(time!);
    table.rows.push(row);
  });
  return table;
}

// The values at a time, on straight lines between the rows; of two rows at one time the second counts from then on.
// Before the first row neutral.
export function valuesAt(table: InputTable, time: number): number[] {
  let next = lowerBound(table.times, time);
  while (table.times[next] === time) ++next;
  const [after, before] = [table.rows[next], table.rows[next - 1]];
  if (!before) return table.names.map(() => 0);
  if (!after) return before;
  const part = (time - table.times[next - 1]!) / (table.times[next]! - table.times[next - 1]!);
  return before.map((value, i) => value + part * (after[i]! - value));
}

export class InputRecord {
  readonly changed = new Emitter();
  #session: Session;
  #driver: Driver;
  #stop: (() => void)[] = [];
  #begin = 0; // s, of the recording or the playback in the session
  #recorded?: InputTable;
  #played?: InputTable;

  constructor(session: Session, driver: Driver) {
    this.#session = session;
    this.#driver = driver;
    driver.beforeSending.on(() => this.#apply());
    session.restarted.on(() => this.#beginAgain());
    session.changed.on(() => {
      if (!session.isConnected) this.stopPlaying();
    });
  }

  get isRecording(): boolean {
    return this.#recorded !== undefined;
  }
  get isPlaying(): boolean {
    return this.#played !== undefined;
  }
  get seconds(): number {
    return Math.max(0, this.#session.time - this.#begin);
  }
  get end(): number {
    return this.#played?.times.at(-1) ?? 0;
  }

  startRecording(names: string[]): void {
    this.#begin = this.#session.time;
    this.#recorded = { names, times: [], rows: [] };
    for (const name of names) this.#stop.push(this.#session.watch(name));
    this.#stop.push(this.#session.valuesChanged.on(() => this.#takeRow()));
    this.changed.emit();
  }

  stopRecording(): InputTable | undefined {
    for (const stop of this.#stop.splice(0)) stop();
    const table = this.#recorded;
    this.#recorded = undefined;
    this.changed.emit();
    return table;
  }

  play(table: InputTable): void {
    this.#begin = this.#session.time;
    this.#played = table;
    this.changed.emit();
  }

  stopPlaying(): void {
    if (!this.#played) return;
    for (const name of this.#played.names) this.#driver.demand("table", name, 0);
    this.#played = undefined;
    this.changed.emit();
  }

  // After a reset, a recording or playback that is on begins with the session.
  #beginAgain(): void {
    this.#begin = 0;
    if (this.#recorded) this.#recorded = { ...this.#recorded, times: [], rows: [] };
  }

  #takeRow(): void {
    const { times, rows, names } = this.#recorded!;
    const time = this.#session.time - this.#begin;
    if (time < 0 || (times.at(-1) ?? -1) >= time || times.length >= kMostRows) return;
    times.push(time);
    rows.push(names.map((name) => this.#session.values.get(`${name}.raw`) ?? 0));
  }

  #apply(): void {
    if (!this.#played) return;
    const time = this.#session.time - this.#begin;
    if (time > this.end) return this.stopPlaying();
    valuesAt(this.#played, time).forEach((value, i) => this.#driver.demand("table", this.#played!.names[i]!, value));
  }
}
