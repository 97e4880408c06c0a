// SPDX-License-Identifier: Apache-2.0
// Icons of 16 by 16, drawn with lines.

const paths = {
  play: "M4.5 3v10l8-5z",
  pause: "M5 3v10M11 3v10",
  step: "M4 3v10l6-5zM12.5 3v10",
  reset: "M3 8a5 5 0 1 0 1.5-3.6M3 2.5v3h3",
  close: "M4 4l8 8M12 4l-8 8",
  plus: "M8 3v10M3 8h10",
  menu: "M2.5 4h11M2.5 8h11M2.5 12h11",
  theme: "M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11",
  plot: "M2.5 2.5v11h11M4.5 11l3-4 2.5 2 3.5-5",
  cursors: "M5 2v12M11 2v12M5 8h6",
  follow: "M2.5 8h9M8 4.5L11.5 8 8 11.5M13.5 3v10",
  download: "M8 2.5v7M4.5 6.5L8 10l3.5-3.5M2.5 13h11",
  image: "M2.5 3h11v10h-11zM2.5 11l3.5-3.5 2.5 2.5 2-2 3 3",
  trash: "M3 4.5h10M6.5 4.5v-2h3v2M4.5 4.5l.6 9h5.8l.6-9",
  fit: "M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10",
  gear: "M8 5.7a2.3 2.3 0 1 0 0 4.6 2.3 2.3 0 0 0 0-4.6M8 1.8v2M8 12.2v2M1.8 8h2M12.2 8h2M3.6 3.6L5 5M11 11l1.4 1.4M12.4 3.6L11 5M5 11l-1.4 1.4",
  chevron: "M6 4l4 4-4 4",
  target: "M8 2v3M8 11v3M2 8h3M11 8h3M8 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6",
  machine: "M2.5 13h11M4 13V5.5L12.5 3M12.5 3v4.5M4 9l4-4.7",
  stick: "M8 9V5.5M8 5.5a1.7 1.7 0 1 0 0-3.4 1.7 1.7 0 0 0 0 3.4M4 13.5h8c0-3-1.6-4.5-4-4.5s-4 1.5-4 4.5z",
  undo: "M3.5 6.5h6a3.5 3.5 0 0 1 0 7h-3M6.5 3.5l-3 3 3 3",
  redo: "M12.5 6.5h-6a3.5 3.5 0 0 0 0 7h3M9.5 3.5l3 3-3 3",
  copy: "M5.5 5.5h8v8h-8zM10.5 5.5v-3h-8v8h3",
  edit: "M3 13l.7-3L11 2.7l2.3 2.3L6 12.3zM9.5 4.2l2.3 2.3",
  rename: "M2.5 5.5h6M5.5 5.5v6M11.5 3v10M10 3h3M10 13h3",
  list: "M2.5 4h1M5.5 4h8M2.5 8h1M5.5 8h8M2.5 12h1M5.5 12h8",
};

export type IconName = keyof typeof paths;

export function icon(name: IconName): SVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("class", `icon icon-${name}`);
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", paths[name]);
  svg.append(path);
  return svg;
}
