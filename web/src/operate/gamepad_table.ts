// SPDX-License-Identifier: Apache-2.0
// The map of a gamepad as a table: for each input its axis, dead zone and direction, with the present value.
import { h, setText } from "../dom";
import { type Gamepad, valueOf } from "./gamepad";

const kAxes = 8; // offered while no gamepad is connected
const kShowEveryMs = 80;

export function gamepadTable(gamepad: Gamepad, inputs: string[]): HTMLElement {
  const name = h("p", { class: "help" });
  const rows = inputs.map((input) => {
    const axis = h("select", { "aria-label": `Axis of ${input}` });
    const deadZone = h("input", {
      type: "number",
      min: "0",
      max: "0.9",
      step: "0.01",
      "aria-label": `Dead zone of ${input}`,
    });
    const inverted = h("input", { type: "checkbox", "aria-label": `Invert ${input}` });
    const value = h("td", { class: "number" });
    axis.onchange = () => gamepad.setMap(input, { axis: Number(axis.value) });
    deadZone.onchange = () => {
      const wanted = Number(deadZone.value);
      gamepad.setMap(input, { deadZone: Math.min(0.9, Math.max(0, Number.isFinite(wanted) ? wanted : 0)) });
    };
    inverted.onchange = () => gamepad.setMap(input, { isInverted: inverted.checked });
    const cells = [axis, deadZone, inverted].map((entry) => h("td", {}, entry));
    return { input, axis, deadZone, inverted, value, root: h("tr", {}, h("td", {}, input), ...cells, value) };
  });

  const showMap = () => {
    const count = Math.max(kAxes, gamepad.axes.length);
    for (const row of rows) {
      const map = gamepad.mapOf(row.input);
      if (row.axis.options.length !== count + 1) {
        const options = Array.from({ length: count }, (_, i) => h("option", { value: String(i) }, `axis ${i}`));
        row.axis.replaceChildren(h("option", { value: "-1" }, "none"), ...options);
      }
      row.axis.value = String(map.axis);
      row.deadZone.value = String(map.deadZone);
      row.inverted.checked = map.isInverted;
    }
    name.textContent = gamepad.name ?? "No gamepad. Connect one and press a button of it.";
  };
  gamepad.changed.on(showMap);
  showMap();

  const table = h(
    "table",
    {},
    h("thead", {}, h("tr", {}, ...["Input", "Axis", "Dead zone", "Invert", "Value"].map((text) => h("th", {}, text)))),
    h("tbody", {}, ...rows.map((row) => row.root)),
  );
  setInterval(() => {
    if (table.offsetParent === null) return;
    for (const row of rows) {
      const map = gamepad.mapOf(row.input);
      setText(row.value, valueOf(gamepad.axes[map.axis] ?? 0, map).toFixed(2));
    }
  }, kShowEveryMs);
  return h("div", {}, name, table);
}
