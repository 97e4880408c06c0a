// SPDX-License-Identifier: Apache-2.0
// Where workspaces are kept: in a file of the window, /workspace.json, which all browsers share; and in this browser for
// each scene, where the window has no such file or may not write it.
import type { Session } from "./session";
import { parseWorkspace, type Workspace } from "./workspace";

const kPath = "workspace.json";
const keyOf = (scene: string) => `slewring.workspace.${scene}`;

export class WorkspaceStore {
  #session: Session;
  #tag: string | null = null; // of the file as this page has it
  #isShared = true; // until the window refuses

  constructor(session: Session) {
    this.#session = session;
  }

  async load(scene: string): Promise<Workspace | undefined> {
    try {
      const answer = await fetch(this.#session.urlOf(kPath), { cache: "no-store" });
      if (answer.ok) {
        this.#tag = answer.headers.get("ETag");
        return parseWorkspace(await answer.text());
      }
    } catch {
      // no connection, or a file of another version: this browser may have one
    }
    try {
      const text = localStorage.getItem(keyOf(scene));
      return text === null ? undefined : parseWorkspace(text);
    } catch {
      return undefined; // of another version, or no storage: the page begins as for a new scene
    }
  }

  async save(scene: string, workspace: Workspace): Promise<void> {
    const body = JSON.stringify(workspace);
    try {
      localStorage.setItem(keyOf(scene), body);
    } catch {
      // a browser that keeps nothing
    }
    if (!this.#isShared || !this.#session.isConnected) return;
    const headers: Record<string, string> = { "Content-Type": "application/json" };
    if (this.#tag !== null) headers["If-Match"] = this.#tag;
    try {
      const answer = await fetch(this.#session.urlOf(kPath), { method: "PUT", headers, body });
      if (answer.ok) this.#tag = answer.headers.get("ETag");
      else this.#isShared = false;
      if (answer.status === 412 || answer.status === 428) this.#reportConflict();
    } catch {
      // no connection: the next change is saved
    }
  }

  // Forgets it in this browser; the file is replaced by the next change.
  forget(scene: string): void {
    try {
      localStorage.removeItem(keyOf(scene));
    } catch {
      // nothing was kept
    }
  }

  #reportConflict(): void {
    const message =
      "another page has changed the workspace; what this page arranges is kept in this browser only; " +
      "load the page again to take that of the other";
    this.#session.noticed.emit({ level: 1, message });
  }
}
