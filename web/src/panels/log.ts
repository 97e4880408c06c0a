// SPDX-License-Identifier: Apache-2.0
// The events of the session, newest last, and short notices for what went wrong at this page.
import type { Context } from "../context";
import { atMostEvery, h } from "../dom";
import type { LogEntry } from "../session";
import { panel, toolButton } from "./panel";

const kNoticeMs = 8000;
const kShowEveryMs = 200;
const kWarning = 3; // foxglove.Log

export class LogPanel {
  readonly root: HTMLElement;
  #context: Context;
  #list = h("ol", { class: "log", tabIndex: 0, "aria-label": "Events" });
  #shown: LogEntry | undefined; // last entry in the list

  constructor(context: Context) {
    this.#context = context;
    const clear = toolButton("trash", "Clear the list", () => {
      context.session.log.length = 0;
      this.#show();
    });
    this.root = panel("log", "Events", [clear], this.#list);
    const show = atMostEvery(kShowEveryMs, () => this.#show());
    context.session.logged.on(show);
    context.session.changed.on(show);
  }

  #show(): void {
    const { log } = this.#context.session;
    const isAtEnd = this.#list.scrollHeight - this.#list.scrollTop - this.#list.clientHeight < 30;
    const known = this.#shown === undefined ? -1 : log.lastIndexOf(this.#shown);
    if (known < 0) this.#list.replaceChildren();
    for (const entry of log.slice(known + 1)) {
      const kind = entry.level > kWarning ? "error" : entry.level === kWarning ? "warning" : "info";
      this.#list.append(
        h(
          "li",
          { class: kind },
          h("time", {}, entry.time.toFixed(2)),
          h("span", { class: "source" }, entry.source),
          h("span", {}, entry.text),
        ),
      );
    }
    while (this.#list.children.length > log.length) this.#list.firstElementChild!.remove();
    this.#shown = log.at(-1);
    if (isAtEnd) this.#list.scrollTop = this.#list.scrollHeight;
  }
}

// Notices stand above the page for some seconds; a later one of the same subject takes the place.
export function noticesOf(context: Context): HTMLElement {
  const root = h("div", { class: "notices", role: "alert" });
  context.session.noticed.on((status) => {
    const subject = status.id ?? status.message;
    const present = [...root.children].find((one) => (one as HTMLElement).dataset["subject"] === subject) as HTMLElement | undefined;
    const kind = status.level >= 2 ? "error" : status.level === 1 ? "warning" : "info";
    const notice = present ?? h("p", { class: kind, onclick: () => notice.remove() }, status.message);
    notice.textContent = status.message;
    notice.dataset["subject"] = subject;
    clearTimeout(Number(notice.dataset["timer"]));
    notice.dataset["timer"] = String(setTimeout(() => notice.remove(), kNoticeMs));
    root.append(notice);
  });
  return root;
}
