// SPDX-License-Identifier: Apache-2.0
// Elements of the page, and events between its parts.

export type Child = Node | string | null | undefined | false;
type Attributes = Record<string, unknown>;

// h("button", { class: "icon", title: "Pause", onclick: pause }, icon("pause")): attributes that are properties of the
// element are set as such, the others as attributes; undefined and false are left out.
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (name === "class") element.className = String(value);
    else if (name in element && !name.startsWith("aria")) (element as unknown as Attributes)[name] = value;
    else element.setAttribute(name, String(value));
  }
  for (const child of children) if (child) element.append(child);
  return element;
}

// Changes a text only where it differs: an unchanged one keeps its selection and costs no layout.
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

// Events of one kind. on() returns the function that ends it.
export class Emitter<T = void> {
  #listeners = new Set<(value: T) => void>();

  on(listener: (value: T) => void): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  emit(value: T): void {
    for (const listener of [...this.#listeners]) listener(value);
  }
}

// Calls an action at most once every so many milliseconds, on a frame of the browser; the last request is never lost.
export function atMostEvery(milliseconds: number, action: () => void): () => void {
  let isWaiting = false;
  let last = -Infinity;
  const run = () => {
    isWaiting = false;
    last = performance.now();
    action();
  };
  return () => {
    if (isWaiting) return;
    isWaiting = true;
    const rest = last + milliseconds - performance.now();
    if (rest > 0) setTimeout(() => requestAnimationFrame(run), rest);
    else requestAnimationFrame(run);
  };
}

// Calls `moved` with the pointer's events until it is released or lost.
export function followPointer(event: PointerEvent, moved: (event: PointerEvent) => void, ended?: () => void): void {
  const target = event.currentTarget as HTMLElement;
  target.setPointerCapture(event.pointerId);
  const end = (next: Event) => {
    if ((next as PointerEvent).pointerId !== event.pointerId) return; // another finger
    target.removeEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) target.removeEventListener(name, end);
    ended?.();
  };
  const move = (next: PointerEvent) => {
    if (next.pointerId === event.pointerId) moved(next);
  };
  target.addEventListener("pointermove", move);
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) target.addEventListener(name, end);
}

// Offers bytes as a file.
export function download(name: string, content: Blob): void {
  const link = h("a", { href: URL.createObjectURL(content), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
