// SPDX-License-Identifier: Apache-2.0
// Controls that go back to neutral when they are released: a slider for one input, a stick for two.
import { followPointer, h } from "../dom";
import type { Driver } from "./driver";

const kKeyStep = 0.1;

export function neutralSlider(driver: Driver, input: string): HTMLElement {
  const knob = h("i", { class: "knob" });
  const present = h("i", { class: "present" });
  const track = h(
    "div",
    {
      class: "slider",
      role: "slider",
      tabIndex: 0,
      "aria-label": input,
      "aria-valuemin": "-1",
      "aria-valuemax": "1",
      onpointerdown: (event: PointerEvent) => {
        const move = ({ clientX }: PointerEvent) => {
          const box = track.getBoundingClientRect();
          driver.demand("pointer", input, ((clientX - box.left) / box.width) * 2 - 1);
        };
        followPointer(event, move, () => driver.demand("pointer", input, 0));
        move(event);
      },
      // away from neutral only while the key is down
      onkeydown: (event: KeyboardEvent) => {
        const direction = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (direction === undefined) return;
        event.preventDefault();
        driver.demand("pointer", input, driver.value(input) + direction * kKeyStep);
      },
      onkeyup: () => driver.demand("pointer", input, 0),
      onblur: () => driver.demand("pointer", input, 0),
    },
    present,
    knob,
  );
  driver.changed.on(() => {
    const value = driver.value(input);
    knob.style.left = `${50 + 50 * value}%`;
    track.setAttribute("aria-valuenow", value.toFixed(2));
  });
  return track;
}

// The value that the session has for the input, behind the knob.
export function showPresent(track: HTMLElement, value: number): void {
  const present = track.querySelector<HTMLElement>(".present")!;
  present.style.left = `${50 + Math.min(0, 50 * value)}%`;
  present.style.width = `${Math.abs(50 * value)}%`;
}

export function digitalButton(driver: Driver, input: string): HTMLElement {
  const release = () => driver.demand("pointer", input, 0);
  const button = h(
    "button",
    {
      class: "digital",
      type: "button",
      onpointerdown: (event: PointerEvent) => {
        driver.demand("pointer", input, 1);
        followPointer(event, () => {}, release);
      },
      onkeydown: (event: KeyboardEvent) => [" ", "Enter"].includes(event.key) && driver.demand("pointer", input, 1),
      onkeyup: release,
      onblur: release,
    },
    "Hold down",
  );
  driver.changed.on(() => button.classList.toggle("is-on", driver.value(input) > 0));
  return button;
}

// across, along: inputs, along counts upwards; undefined: the axis does nothing.
export function stick(driver: Driver, across: string | undefined, along: string | undefined): HTMLElement {
  const knob = h("i", { class: "knob" });
  const demand = (x: number, y: number) => {
    if (across !== undefined) driver.demand("pointer", across, x);
    if (along !== undefined) driver.demand("pointer", along, y);
  };
  const pad = h(
    "div",
    {
      class: "stick",
      "aria-label": [across, along].filter(Boolean).join(" and "),
      onpointerdown: (event: PointerEvent) => {
        const move = ({ clientX, clientY }: PointerEvent) => {
          const box = pad.getBoundingClientRect();
          demand(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
        };
        followPointer(event, move, () => demand(0, 0));
        move(event);
      },
    },
    h("span", { class: "along" }, along ?? ""),
    h("span", { class: "across" }, across ?? ""),
    knob,
  );
  driver.changed.on(() => {
    knob.style.left = `${50 + 50 * (across === undefined ? 0 : driver.value(across))}%`;
    knob.style.top = `${50 - 50 * (along === undefined ? 0 : driver.value(along))}%`;
  });
  return pad;
}
