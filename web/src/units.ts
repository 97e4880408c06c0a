// SPDX-License-Identifier: Apache-2.0
// Values as texts. Inside the page all values are SI; the units in which they are shown are the user's choice.

export type UnitSystem = "engineering" | "si";

export interface DisplayUnit {
  factor: number; // shown value over the SI value
  text: string;
}

const engineering: Record<string, DisplayUnit> = {
  Pa: { factor: 1e-5, text: "bar" },
  rad: { factor: 180 / Math.PI, text: "deg" },
  "rad/s": { factor: 180 / Math.PI, text: "deg/s" },
  "m3/s": { factor: 60_000, text: "l/min" },
  m3: { factor: 1000, text: "l" },
  N: { factor: 1e-3, text: "kN" },
  "N m": { factor: 1e-3, text: "kN m" },
  W: { factor: 1e-3, text: "kW" },
  J: { factor: 1e-3, text: "kJ" },
};

const rpm: DisplayUnit = { factor: 30 / Math.PI, text: "rpm" };

// The speed of a shaft has a unit of its own, by the name of its variable, as in libs/core/display.cpp.
export function displayUnit(unit: string, system: UnitSystem, variable: string): DisplayUnit {
  const text = unit === "1" ? "" : unit;
  if (system === "si") return { factor: 1, text };
  if (unit === "rad/s" && /\.speed(_setting)?$/.test(variable)) return rpm;
  return engineering[unit] ?? { factor: 1, text };
}

// Five digits, of a width that stays while the value moves.
export function formatNumber(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e6 || size < 1e-4) return value.toExponential(3);
  const digits = Math.min(6, Math.max(0, 4 - Math.floor(Math.log10(size))));
  return value.toFixed(digits);
}

export function formatTime(seconds: number): string {
  return `${seconds.toFixed(3)} s`;
}
