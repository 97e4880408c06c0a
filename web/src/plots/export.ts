// SPDX-License-Identifier: Apache-2.0
// A plot as a file: the visible samples as CSV in SI units, the picture as PNG or SVG.
import type uPlot from "uplot";

export interface Caption {
  text: string;
  color: string;
  dash: number[];
}

// heads: of the columns behind the time. An empty field where a variable has no value.
export function csvOf(heads: string[], table: uPlot.AlignedData): Blob {
  const [times, ...columns] = table;
  const lines = [["time [s]", ...heads].map(fieldOf).join(",")];
  Array.from(times, (time, row) => lines.push([time, ...columns.map((column) => column[row] ?? "")].join(",")));
  return new Blob([`${lines.join("\n")}\n`], { type: "text/csv" });
}

const fieldOf = (text: string) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);

// The canvas of the plot under a line of captions.
export async function pictureOf(
  canvas: HTMLCanvasElement,
  captions: Caption[],
  background: string,
  text: string,
): Promise<Blob | null> {
  const scale = window.devicePixelRatio;
  const head = 26 * scale;
  const picture = document.createElement("canvas");
  picture.width = canvas.width;
  picture.height = canvas.height + head;
  const draw = picture.getContext("2d")!;
  draw.fillStyle = background;
  draw.fillRect(0, 0, picture.width, picture.height);
  draw.font = `${12 * scale}px system-ui, sans-serif`;
  draw.textBaseline = "middle";
  draw.lineWidth = 2.5 * scale;
  let x = 10 * scale;
  for (const caption of captions) {
    draw.strokeStyle = caption.color;
    draw.setLineDash(caption.dash.map((one) => one * scale));
    draw.beginPath();
    draw.moveTo(x, head / 2);
    draw.lineTo(x + 14 * scale, head / 2);
    draw.stroke();
    draw.fillStyle = text;
    draw.fillText(caption.text, x + 19 * scale, head / 2);
    x += 34 * scale + draw.measureText(caption.text).width;
  }
  draw.drawImage(canvas, 0, head);
  return new Promise((resolve) => picture.toBlob(resolve, "image/png"));
}
