// SPDX-License-Identifier: Apache-2.0
// The values that came so far of the recorded elements: one column a variable over common times.
//
// Values of a session come in the order of time; those of a recording also go back. A time that is there already keeps
// its row. Beyond kMostRows the oldest tenth is dropped.
const kMostRows = 100_000; // 25 min at 60 a second

// Index of the first time that is not before `time`.
export function lowerBound(times: readonly number[], time: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

export type Column = (number | null)[]; // null: no value of this variable at this time

export class Samples {
  readonly times: number[] = [];
  readonly columns = new Map<string, Column>();

  // All variables of an element.
  remove(element: string): void {
    for (const name of this.columns.keys()) if (name.startsWith(`${element}.`)) this.columns.delete(name);
  }

  put(time: number, values: Iterable<[string, number | null]>): void {
    let row = this.times.length - 1;
    if (row < 0 || this.times[row]! !== time) {
      row = row < 0 || this.times[row]! < time ? row + 1 : lowerBound(this.times, time);
      if (this.times[row] !== time) {
        this.times.splice(row, 0, time);
        for (const column of this.columns.values()) column.splice(row, 0, null);
      }
    }
    for (const [name, value] of values) {
      let column = this.columns.get(name);
      if (!column) this.columns.set(name, (column = new Array<null>(this.times.length).fill(null)));
      column[row] = value;
    }
    if (this.times.length > kMostRows) {
      this.times.splice(0, kMostRows / 10);
      for (const column of this.columns.values()) column.splice(0, kMostRows / 10);
    }
  }

  clear(): void {
    this.times.length = 0;
    for (const column of this.columns.values()) column.length = 0;
  }

  // Rows from the last one before `from` to the first one after `to`, so that lines reach the borders.
  rows(from: number, to: number): [number, number] {
    const first = Math.max(0, lowerBound(this.times, from) - 1);
    let last = lowerBound(this.times, to);
    if (last < this.times.length) ++last;
    return [first, last];
  }

  // The last value at or before a time.
  valueAt(variable: string, time: number): { time: number; value: number } | undefined {
    const column = this.columns.get(variable);
    if (!column) return undefined;
    let row = lowerBound(this.times, time);
    if (this.times[row] !== time) --row;
    for (; row >= 0; --row) {
      const value = column[row];
      if (value !== null && value !== undefined) return { time: this.times[row]!, value };
    }
    return undefined;
  }
}
