// SPDX-License-Identifier: Apache-2.0
// The menu of the page: how things are shown, and the workspace as a file.
import type { Context, Theme } from "../context";
import { h } from "../dom";
import { icon } from "../icons";
import type { UnitSystem } from "../units";

export interface WorkspaceActions {
  save: () => void; // as a file
  open: (text: string) => void;
  reset: () => void;
}

function choice<T extends string>(name: string, options: [T, string][], value: () => T, set: (value: T) => void) {
  const select = h(
    "select",
    { "aria-label": name, onchange: () => set(select.value as T) },
    ...options.map(([key, text]) => h("option", { value: key }, text)),
  );
  const show = () => (select.value = value());
  show();
  return { root: h("label", {}, name, select), show };
}

export function menuOf(context: Context, actions: WorkspaceActions): HTMLElement {
  const file = h("input", {
    type: "file",
    accept: ".json,application/json",
    hidden: true,
    onchange: async () => {
      const chosen = file.files?.[0];
      file.value = "";
      if (chosen) actions.open(await chosen.text());
    },
  });
  const themes: [Theme, string][] = [
    ["auto", "as the system"],
    ["light", "light"],
    ["dark", "dark"],
  ];
  const units: [UnitSystem, string][] = [
    ["engineering", "bar, l/min, deg, kN"],
    ["si", "SI"],
  ];
  const theme = choice(
    "Theme",
    themes,
    () => context.theme,
    (value) => (context.theme = value),
  );
  const unit = choice(
    "Units of values",
    units,
    () => context.units,
    (value) => (context.units = value),
  );
  context.themeChanged.on(theme.show);
  context.unitsChanged.on(unit.show);
  const item = (text: string, action: () => void) =>
    h(
      "button",
      {
        type: "button",
        onclick: () => {
          action();
          menu.open = false;
        },
      },
      text,
    );
  const menu = h(
    "details",
    { class: "menu" },
    h("summary", { title: "Menu", "aria-label": "Menu" }, icon("menu")),
    h(
      "div",
      { class: "menu-body" },
      theme.root,
      unit.root,
      h("hr"),
      item("Save the workspace as a file", actions.save),
      item("Open a workspace file", () => file.click()),
      item("Reset the workspace", actions.reset),
      file,
      h("hr"),
      h("p", { class: "help" }, "The workspace (panels, camera, plots, theme, gamepad) is kept for each scene."),
    ),
  );
  document.addEventListener("pointerdown", (event) => {
    if (!menu.contains(event.target as Node)) menu.open = false;
  });
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape") menu.open = false;
  });
  return menu;
}
