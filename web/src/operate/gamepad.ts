// SPDX-License-Identifier: Apache-2.0
// Inputs by the axes of a gamepad, with a map: axis, dead zone, inversion for each input.
import { Emitter } from "../dom";
import type { Driver } from "./driver";

export interface AxisMap {
  axis: number; // of the gamepad; -1: none
  deadZone: number; // 0 to 0.9
  isInverted: boolean;
}
export type GamepadMap = Record<string, AxisMap>; // by input

// Axes of the standard layout; the vertical ones point down.
const usual: AxisMap[] = [
  { axis: 0, deadZone: 0.12, isInverted: false },
  { axis: 1, deadZone: 0.12, isInverted: true },
  { axis: 3, deadZone: 0.12, isInverted: true },
  { axis: 2, deadZone: 0.12, isInverted: false },
];
const none: AxisMap = { axis: -1, deadZone: 0.12, isInverted: false };

// The value of an axis behind its dead zone: 0 in it, then from 0 to the ends.
export function valueOf(raw: number, map: AxisMap): number {
  const size = Math.abs(raw);
  if (size <= map.deadZone) return 0;
  const value = (Math.sign(raw) * (Math.min(1, size) - map.deadZone)) / (1 - map.deadZone);
  return map.isInverted ? -value : value;
}

export class Gamepad {
  readonly changed = new Emitter(); // connected, or map
  #driver: Driver;
  #inputs: string[] = [];
  #map: GamepadMap = {};

  constructor(driver: Driver) {
    this.#driver = driver;
    for (const name of ["gamepadconnected", "gamepaddisconnected"])
      window.addEventListener(name, () => {
        this.#apply();
        this.changed.emit();
      });
    driver.beforeSending.on(() => this.#apply());
  }

  set inputs(inputs: string[]) {
    this.#inputs = inputs;
  }

  get map(): GamepadMap {
    return this.#map;
  }
  set map(map: GamepadMap) {
    this.#map = map;
    this.changed.emit();
  }

  mapOf(input: string): AxisMap {
    return this.#map[input] ?? usual[this.#inputs.indexOf(input)] ?? none;
  }

  setMap(input: string, change: Partial<AxisMap>): void {
    this.#map[input] = { ...this.mapOf(input), ...change };
    this.changed.emit();
  }

  get name(): string | undefined {
    return this.#pad?.id;
  }
  get axes(): readonly number[] {
    return this.#pad?.axes ?? [];
  }

  get #pad() {
    return navigator.getGamepads().find((pad) => pad?.connected) ?? undefined;
  }

  #apply(): void {
    const axes = this.axes;
    for (const input of this.#inputs) {
      const map = this.mapOf(input);
      this.#driver.demand("gamepad", input, valueOf(axes[map.axis] ?? 0, map));
    }
  }
}
