// SPDX-License-Identifier: Apache-2.0
// Steps of undo and redo of a text, each as the part that differs.

interface Step {
  at: number;
  before: string;
  after: string; // the parts at `at`
}
export interface HistoryState {
  past: Step[];
  future: Step[]; // the next one last
}

const kMostSteps = 200;

export class History {
  #past: Step[];
  #future: Step[];

  constructor(state: HistoryState = { past: [], future: [] }) {
    this.#past = state.past;
    this.#future = state.future;
  }

  get state(): HistoryState {
    return { past: this.#past, future: this.#future };
  }
  get mayUndo(): boolean {
    return this.#past.length > 0;
  }
  get mayRedo(): boolean {
    return this.#future.length > 0;
  }

  // extendsLast: the change belongs to the last step.
  add(before: string, after: string, extendsLast: boolean): void {
    const last = extendsLast ? this.#past.pop() : undefined;
    const base = last ? replaced(before, last, "after", "before") : before;
    if (base !== after) this.#past.push(stepOf(base, after));
    if (this.#past.length > kMostSteps) this.#past.shift();
    this.#future = [];
  }

  // The text one step back; undefined: there is none.
  before(text: string): string | undefined {
    const step = this.#past.at(-1);
    return step && replaced(text, step, "after", "before");
  }
  after(text: string): string | undefined {
    const step = this.#future.at(-1);
    return step && replaced(text, step, "before", "after");
  }

  undo(): void {
    this.#future.push(...this.#past.splice(-1));
  }
  redo(): void {
    this.#past.push(...this.#future.splice(-1));
  }
}

function replaced(text: string, step: Step, from: "before" | "after", to: "before" | "after"): string {
  return text.slice(0, step.at) + step[to] + text.slice(step.at + step[from].length);
}

// The part between what both texts begin and end with.
function stepOf(before: string, after: string): Step {
  const shorter = Math.min(before.length, after.length);
  let at = 0;
  while (at < shorter && before[at] === after[at]) ++at;
  let tail = 0;
  while (tail < shorter - at && before.at(-1 - tail) === after.at(-1 - tail)) ++tail;
  return { at, before: before.slice(at, before.length - tail), after: after.slice(at, after.length - tail) };
}
