// SPDX-License-Identifier: Apache-2.0
// A plot as SVG: the curves of the visible window with an axis for each unit, in black on white, for documents.
import type uPlot from "uplot";
import type { Caption } from "./export";

export interface SvgCurve extends Caption {
  unit: string; // curves of one unit share an axis
  range: [number, number]; // of values that are shown
  factor: number; // shown value over the table's
}

const kWidth = 800;
const kHeight = 360; // of the picture
const kSide = 64; // for an axis
const kFoot = 34;
const kLine = 18; // of the captions
const kTicks = 6;

const escaped = (text: string) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/"/g, "&quot;");
const short = (value: number) => String(+value.toFixed(1));

// About so many round values between two.
export function ticksOf(from: number, to: number, count: number): number[] {
  const rough = (to - from) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= rough * 0.999) ?? 10 * power;
  const first = Math.ceil(from / step - 1e-9);
  const ticks: number[] = [];
  for (let i = first; i * step <= to + 1e-9 * step; ++i) ticks.push(+(i * step).toPrecision(12));
  return ticks;
}

// table: times, and a column for each curve.
export function svgOf(curves: SvgCurve[], table: uPlot.AlignedData, [from, to]: [number, number]): string {
  const units = [...new Set(curves.map((curve) => curve.unit))];
  const head = 10 + kLine * curves.length;
  const [left, right] = [kSide, kWidth - (units.length > 1 ? kSide * (units.length - 1) : 16)];
  const [top, bottom] = [head + 6, head + 6 + kHeight - kFoot];
  const x = (time: number) => left + ((time - from) / (to - from)) * (right - left);
  const yOf = ([low, high]: [number, number]) => (value: number) => bottom - ((value - low) / (high - low)) * (bottom - top);
  const text = (px: number, py: number, content: string, more = "") => `<text x="${short(px)}" y="${short(py)}"${more}>${escaped(content)}</text>`;
  const line = (x1: number, y1: number, x2: number, y2: number, kind: string) =>
    `<line x1="${short(x1)}" y1="${short(y1)}" x2="${short(x2)}" y2="${short(y2)}" class="${kind}"/>`;
  const parts: string[] = [];
  for (const time of ticksOf(from, to, 8))
    parts.push(line(x(time), top, x(time), bottom, "grid"), text(x(time), bottom + 15, `${time} s`, ' text-anchor="middle"'));
  units.forEach((unit, i) => {
    const { range } = curves.find((curve) => curve.unit === unit)!;
    const y = yOf(range);
    const at = i === 0 ? left : right + (i - 1) * kSide;
    const anchor = i === 0 ? ' text-anchor="end"' : "";
    const way = i === 0 ? -5 : 5;
    for (const value of ticksOf(...range, kTicks)) {
      if (i === 0) parts.push(line(left, y(value), right, y(value), "grid"));
      parts.push(text(at + way, y(value) + 4, String(value), anchor));
    }
    if (unit) parts.push(text(at + way, top - 5, unit, anchor));
    parts.push(line(at, top, at, bottom, "axis"));
  });
  parts.push(line(left, bottom, right, bottom, "axis"));
  curves.forEach((curve, i) => {
    const y = yOf(curve.range);
    const at = 10 + kLine * i + 9;
    const dash = curve.dash.length > 0 ? ` stroke-dasharray="${curve.dash.join(" ")}"` : "";
    const style = ` fill="none" stroke="${curve.color}" stroke-width="1.5"${dash}`;
    parts.push(`<path d="M${left} ${at}h22"${style}/>`, text(left + 28, at + 4, curve.text));
    parts.push(`<path clip-path="url(#area)" d="${pathOf(table[0], table[i + 1]!, (t) => x(t), (value) => y(value * curve.factor))}"${style}/>`);
  });
  const height = bottom + kFoot;
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${kWidth}" height="${height}" viewBox="0 0 ${kWidth} ${height}">`,
    "<style>text{font:12px sans-serif}.grid{stroke:#ddd}.axis{stroke:#000}</style>",
    `<clipPath id="area"><rect x="${left}" y="${top}" width="${right - left}" height="${bottom - top}"/></clipPath>`,
    `<rect width="${kWidth}" height="${height}" fill="#fff"/>`,
    ...parts,
    "</svg>\n",
  ].join("\n");
}

// A null parts the curve; undefined is a time of another curve.
function pathOf(times: ArrayLike<number>, values: ArrayLike<number | null | undefined>, x: (time: number) => number, y: (value: number) => number): string {
  let path = "";
  let isOpen = false;
  for (let i = 0; i < times.length; ++i) {
    const value = values[i];
    if (value === undefined) continue;
    if (value !== null) path += `${isOpen ? "L" : "M"}${short(x(times[i]!))} ${short(y(value))}`;
    isOpen = value !== null;
  }
  return path;
}
