// SPDX-License-Identifier: Apache-2.0
// What a person arranged, as JSON with a version.
import type { GamepadMap } from "./operate/gamepad";
import type { Theme } from "./context";
import type { Center } from "./layout";
import type { PlotsState } from "./plots/plots_panel";
import type { UnitSystem } from "./units";
import type { ViewState } from "./view/view_panel";

export const kVersion = 1;
const kMostBytes = 1 << 20;

export interface Workspace {
  version: number;
  theme: Theme;
  units: UnitSystem;
  layout: Record<string, number>; // sizes [px] by name
  closedGroups: string[];
  center?: Center; // the view without it
  view: ViewState;
  plots: PlotsState;
  gamepad: GamepadMap;
}

const isObject = (value: unknown): value is Record<string, unknown> =>
  typeof value === "object" && value !== null && !Array.isArray(value);
const isNumber = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);
const isTexts = (value: unknown): value is string[] =>
  Array.isArray(value) && value.every((one) => typeof one === "string");
const isPoint = (value: unknown) => Array.isArray(value) && value.length === 3 && value.every(isNumber);

function isView(view: unknown): boolean {
  if (!isObject(view) || typeof view["follow"] !== "string") return false;
  const camera = view["camera"];
  const isCamera =
    camera === undefined || (isObject(camera) && isPoint(camera["position"]) && isPoint(camera["target"]));
  return isCamera && ["auto", "high", "low"].includes(view["graphics"] as string);
}

function isPlots(plots: unknown): boolean {
  if (!isObject(plots)) return false;
  const { length, plots: list } = plots;
  return (length === null || (isNumber(length) && length > 0)) && Array.isArray(list) && list.every(isTexts);
}

function isMap(map: unknown): boolean {
  return (
    isObject(map) &&
    Object.values(map).every(
      (one) =>
        isObject(one) && isNumber(one["axis"]) && isNumber(one["deadZone"]) && typeof one["isInverted"] === "boolean",
    )
  );
}

// Throws an error with the reason when the text is no workspace of this version.
export function parseWorkspace(text: string): Workspace {
  if (text.length > kMostBytes) throw new Error("the file has more than 1 MiB");
  let json: unknown;
  try {
    json = JSON.parse(text);
  } catch {
    throw new Error("the file is not JSON");
  }
  if (!isObject(json) || json["version"] !== kVersion)
    throw new Error(`the file is not a workspace of version ${kVersion}`);
  const parts: [string, boolean][] = [
    ["theme", ["auto", "light", "dark"].includes(json["theme"] as string)],
    ["units", ["engineering", "si"].includes(json["units"] as string)],
    ["layout", isObject(json["layout"]) && Object.values(json["layout"]).every(isNumber)],
    ["closedGroups", isTexts(json["closedGroups"])],
    ["center", json["center"] === undefined || ["view", "circuit"].includes(json["center"] as string)],
    ["view", isView(json["view"])],
    ["plots", isPlots(json["plots"])],
    ["gamepad", isMap(json["gamepad"])],
  ];
  for (const [name, isRight] of parts) if (!isRight) throw new Error(`its part '${name}' is missing or damaged`);
  return json as unknown as Workspace;
}
