// SPDX-License-Identifier: Apache-2.0
// A panel: a head with a title and its tools, and a body.
import { type Child, h } from "../dom";
import { icon, type IconName } from "../icons";

export function panel(name: string, title: Child, tools: Child[], ...body: Child[]): HTMLElement {
  return h(
    "section",
    { class: `panel panel-${name}`, "aria-label": typeof title === "string" ? title : name },
    h("header", {}, h("h2", {}, title), h("div", { class: "tools" }, ...tools)),
    ...body,
  );
}

export function toolButton(name: IconName, title: string, onclick: () => void, text?: string): HTMLButtonElement {
  return h(
    "button",
    { class: "tool", type: "button", title, "aria-label": title, onclick },
    icon(name),
    text && h("span", {}, text),
  );
}
