// SPDX-License-Identifier: Apache-2.0
// The scene's text as this page edits it: its elements and problems as the window reads them, undo and redo, saving, and
// the restart of the session. Nothing is written before it is saved. A reload of the page keeps the text and its undo.
import { Emitter } from "../dom";
import type { Session } from "../session";
import { History, type HistoryState } from "./history";

export interface FieldInfo {
  key: string;
  type: string; // number, integer, boolean, text, triple, triples, table, numbers, texts, choice, rows
  doc: string;
  unit?: string;
  range?: string;
  default?: string;
  required?: boolean;
  live?: boolean;
  choices?: string[];
  reference?: string; // kinds of elements: "body", "component or force"
  read_with?: string[];
}

export interface KindInfo {
  section: string;
  type: string;
  kind?: string; // as in a reference
  doc: string;
  is_default?: boolean;
  is_single?: boolean;
  fields: FieldInfo[];
}

export interface SceneElement {
  name: string;
  section: string;
  type: string;
  line?: number;
  fields: Record<string, { text: string; line: number; column: number }>;
  given: Record<string, { text: string; place: string }>; // by a template or an included file
  place?: string; // of an element of another file or of an instance: it is not edited here
}

export interface Problem {
  file: string;
  line: number;
  column: number;
  path: string;
  what: string;
  expected: string;
  suggestion: string;
}

export interface NamedPoint {
  name: string; // Boom.tip
  body: string;
  position: [number, number, number]; // m, in the body's frame
}

interface Outline {
  elements: SceneElement[];
  points: NamedPoint[];
  problems: Problem[];
  omitted: number;
  warnings: string[];
}
interface Snapshot extends Outline {
  text: string;
}

export type Change =
  | { set: string; value: string }
  | { add: string; section: string; type: string }
  | { copy: string; to: string }
  | { rename: string; to: string }
  | { remove: string };

export interface EditAnswer {
  refusal: string; // empty: done
  notes: string[];
}

const kSameEditMs = 2000; // keys typed into one field within this time are one step of undo

const kKeptKey = "slewring.scene"; // in the storage of this tab

interface Kept {
  path: string;
  text: string;
  savedText: string;
  tag: string;
  history: HistoryState;
}

export const textOf = (problem: Problem) =>
  [
    problem.what,
    problem.expected && `expected ${problem.expected}`,
    problem.suggestion && `did you mean '${problem.suggestion}'?`,
  ]
    .filter((part) => part !== "")
    .join("; ");

export class SceneFile {
  readonly changed = new Emitter(); // any of the members below
  isOpen = false;
  isBusy = false; // a request is under way
  path = "";
  settings: string[] = [];
  kinds: KindInfo[] = [];
  elements = new Map<string, SceneElement>();
  known = new Set<string>(); // elements of the file when the session began, or the editing

  #session: Session;
  #now: Snapshot = { text: "", elements: [], points: [], problems: [], omitted: 0, warnings: [] };
  #savedText = "";
  #tag = "";
  #history = new History();
  #last = { place: "", time: 0 }; // of the last step of undo
  #queue: Promise<unknown> = Promise.resolve();
  #waiting = 0;

  constructor(session: Session) {
    this.#session = session;
    session.changed.on(() => this.#openAgain());
    window.addEventListener("pagehide", () => this.#keep());
    window.addEventListener("beforeunload", (event) => {
      if (this.isChanged) event.preventDefault();
    });
  }

  get name(): string {
    return this.path.slice(this.path.lastIndexOf("/") + 1);
  }
  get text(): string {
    return this.#now.text;
  }
  get problems(): Problem[] {
    return this.#now.problems;
  }
  get omitted(): number {
    return this.#now.omitted;
  }
  get points(): NamedPoint[] {
    return this.isOpen ? this.#now.points : [];
  }
  get isChanged(): boolean {
    return this.isOpen && this.#now.text !== this.#savedText;
  }
  get mayUndo(): boolean {
    return this.#history.mayUndo;
  }
  get mayRedo(): boolean {
    return this.#history.mayRedo;
  }

  kindOf(element: SceneElement): KindInfo | undefined {
    const ofSection = this.kinds.filter((kind) => kind.section === element.section);
    return ofSection.find((kind) => kind.type === element.type) ?? (ofSection.length === 1 ? ofSection[0] : undefined);
  }

  // Elements that a reference to these kinds may name.
  namesOf(reference: string): string[] {
    const wanted = reference.split(" or ");
    const sections = new Set(this.kinds.filter((one) => wanted.includes(one.kind ?? "")).map((one) => one.section));
    const names = [...this.elements.values()].filter((one) => sections.has(one.section)).map((one) => one.name);
    return wanted.includes("body") ? ["Ground", ...names] : names;
  }

  // Those of an element, or of one of its fields.
  problemsOf(path: string): Problem[] {
    return this.problems.filter((one) => one.path === path || one.path.startsWith(`${path}.`) || one.path.startsWith(`${path}[`));
  }

  // Reads the file. What was not saved is lost.
  async open(): Promise<boolean> {
    const answer = await this.#request("scene.json", "GET");
    if (!answer?.ok) return false;
    const file = (await answer.json()) as Outline & {
      text: string;
      tag: string;
      file: string;
      settings: string[];
      kinds: KindInfo[];
    };
    this.path = file.file;
    this.settings = file.settings;
    this.kinds = file.kinds;
    this.#savedText = file.text;
    this.#tag = file.tag;
    this.#history = new History();
    this.isOpen = true;
    this.known = new Set(file.elements.map((one) => one.name));
    this.#show(file);
    return true;
  }

  close(): void {
    this.isOpen = false;
    sessionStorage.removeItem(kKeptKey);
    this.elements = new Map();
    this.changed.emit();
  }

  // Changes are applied one after the other.
  edit(change: Change): Promise<EditAnswer> {
    return this.#enqueue(() => this.#send({ text: this.text, edit: change }, "set" in change ? change.set : ""));
  }
  replaceText(text: string): Promise<EditAnswer> {
    return this.#enqueue(() => this.#send({ text }, "text"));
  }

  undo(): void {
    void this.#enqueue(() => this.#goTo(this.#history.before(this.text), () => this.#history.undo()));
  }
  redo(): void {
    void this.#enqueue(() => this.#goTo(this.#history.after(this.text), () => this.#history.redo()));
  }

  // False: it was refused, with a notice.
  save(): Promise<boolean> {
    return this.#enqueue(async () => {
      const text = this.text;
      const answer = await this.#request("scene.yaml", "PUT", text);
      if (answer?.status !== 204) return false;
      this.#tag = answer.headers.get("ETag") ?? "";
      this.#savedText = text;
      this.#last.place = "";
      this.changed.emit();
      return true;
    });
  }

  async restart(): Promise<void> {
    if (this.isChanged && !(await this.save())) return;
    const answer = await this.#request("restart", "POST", "");
    if (!answer?.ok) return;
    this.known = new Set(this.elements.keys());
    this.#session.noticed.emit({ level: 0, message: "the session ends, and begins again with the saved scene" });
  }

  // ---- the inner ways

  #enqueue<T>(action: () => Promise<T>): Promise<T> {
    ++this.#waiting;
    this.isBusy = true;
    this.changed.emit();
    const result = this.#queue.then(action);
    this.#queue = result
      .catch(() => undefined)
      .then(() => {
        this.isBusy = --this.#waiting > 0;
        this.changed.emit();
      });
    return result;
  }

  async #send(request: object, place: string): Promise<EditAnswer> {
    const answer = await this.#request("scene.json", "POST", JSON.stringify(request));
    if (!answer?.ok) return { refusal: "the window did not take the change; nothing was changed", notes: [] };
    const edited = (await answer.json()) as Snapshot & Partial<EditAnswer>;
    if (edited.text !== this.text) {
      const isSame = place !== "" && place === this.#last.place && Date.now() - this.#last.time < kSameEditMs;
      this.#history.add(this.text, edited.text, isSame);
      this.#last = { place, time: Date.now() };
      this.#show(edited);
    }
    return { refusal: edited.refusal ?? "", notes: edited.notes ?? [] };
  }

  // Shows a text of the history when the window has read it.
  async #goTo(text: string | undefined, done: () => void): Promise<void> {
    if (text === undefined) return;
    const answer = await this.#request("scene.json", "POST", JSON.stringify({ text }));
    if (!answer?.ok) return;
    done();
    this.#last.place = "";
    this.#show((await answer.json()) as Snapshot);
  }

  // ---- a reload of the page

  #keep(): void {
    if (!this.isOpen) return;
    const { path, text } = this;
    const kept: Kept = { path, text, savedText: this.#savedText, tag: this.#tag, history: this.#history.state };
    try {
      sessionStorage.setItem(kKeptKey, JSON.stringify(kept));
    } catch {
      sessionStorage.removeItem(kKeptKey); // too large for the browser: the reload begins with the file
    }
  }

  // The text as it was before the reload. A file that has changed meanwhile is not replaced: saving is refused.
  #openAgain(): void {
    if (this.isOpen || this.#session.description?.scene_file === undefined) return;
    const text = sessionStorage.getItem(kKeptKey);
    sessionStorage.removeItem(kKeptKey);
    if (text === null) return;
    const kept = JSON.parse(text) as Kept;
    void this.open().then((isOpen) => {
      if (!isOpen) sessionStorage.setItem(kKeptKey, text); // for the next try: there was a notice
      if (!isOpen || kept.path !== this.path) return;
      this.#savedText = kept.savedText;
      this.#tag = kept.tag;
      this.#history = new History(kept.history);
      if (kept.text === this.text) this.changed.emit();
      else void this.#enqueue(() => this.#goTo(kept.text, () => undefined));
    });
  }

  #show(snapshot: Snapshot): void {
    // a text that is no YAML has no elements: those of before are shown, with the problem
    const elements = snapshot.elements.length > 0 ? snapshot.elements : this.#now.elements;
    this.#now = { ...snapshot, elements };
    this.elements = new Map(elements.map((one) => [one.name, one]));
    this.changed.emit();
  }

  // Undefined or not ok: there was a notice.
  async #request(path: string, method: string, body?: string): Promise<Response | undefined> {
    const notice = (text: string) => this.#session.noticed.emit({ level: 2, message: text.trim() });
    const headers: Record<string, string> = {};
    if (method !== "GET" && path !== "scene.json") headers["If-Match"] = this.#tag;
    try {
      const answer = await fetch(this.#session.urlOf(path), { method, headers, body, cache: "no-store" });
      if (answer.status === 422) notice("the scene has problems, which are listed; nothing was written");
      else if (!answer.ok) notice(await answer.text());
      return answer;
    } catch (error) {
      notice(`the window does not answer: ${(error as Error).message}; nothing was changed`);
      return undefined;
    }
  }
}
