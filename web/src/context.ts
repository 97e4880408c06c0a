// SPDX-License-Identifier: Apache-2.0
// What all parts of the page share: the session, the selected element, and how things are shown.
import { Emitter } from "./dom";
import { type NamedPoint, SceneFile } from "./edit/scene_file";
import type { Session } from "./session";
import { displayUnit, type DisplayUnit, type UnitSystem } from "./units";

export type Theme = "auto" | "light" | "dark";

export class Context {
  readonly session: Session;
  readonly scene: SceneFile; // its text, where the window has it
  readonly selectionChanged = new Emitter<string | undefined>();
  readonly themeChanged = new Emitter();
  readonly unitsChanged = new Emitter();
  readonly workspaceChanged = new Emitter(); // something that a workspace keeps
  readonly fieldWanted = new Emitter<{ element: string; key: string }>(); // of the scene's text, to be edited
  readonly pointPicked = new Emitter<NamedPoint>();
  readonly plotWanted = new Emitter<string>(); // a variable, for the plot that was used last

  selected?: string;
  #theme: Theme = "auto";
  #units: UnitSystem = "engineering";
  #darkMedia = matchMedia("(prefers-color-scheme: dark)");

  constructor(session: Session) {
    this.session = session;
    this.scene = new SceneFile(session);
    this.#darkMedia.addEventListener("change", () => this.#applyTheme());
    this.#applyTheme();
  }

  select(element: string | undefined): void {
    if (element === this.selected) return;
    this.selected = element;
    this.selectionChanged.emit(element);
  }

  get theme(): Theme {
    return this.#theme;
  }
  set theme(theme: Theme) {
    this.#theme = theme;
    this.#applyTheme();
    this.workspaceChanged.emit();
  }
  get isDark(): boolean {
    return this.#theme === "dark" || (this.#theme === "auto" && this.#darkMedia.matches);
  }

  get units(): UnitSystem {
    return this.#units;
  }
  set units(units: UnitSystem) {
    this.#units = units;
    this.unitsChanged.emit();
    this.workspaceChanged.emit();
  }
  unitOf(variable: string): DisplayUnit {
    return displayUnit(this.session.variables.get(variable)?.unit ?? "1", this.#units, variable);
  }

  // A colour of the style sheet.
  color(name: string): string {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  #applyTheme(): void {
    document.documentElement.dataset["theme"] = this.isDark ? "dark" : "light";
    this.themeChanged.emit();
  }
}
