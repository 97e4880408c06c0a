// SPDX-License-Identifier: Apache-2.0
// A plot as a file: the visible samples as CSV in SI units, or the picture as PNG.
import type { Samples } from "../samples";
import type { Session } from "../session";

// Rows of all times from `from` to `to` [s]; an empty field where a variable has no value.
export function csvOf(session: Session, variables: string[], from: number, to: number): Blob {
  const samples: Samples = session.samples;
  const unitOf = (name: string) => session.variables.get(name)?.unit ?? "1";
  const lines = [["time [s]", ...variables.map((name) => `${name} [${unitOf(name)}]`)].join(",")];
  const columns = variables.map((name) => samples.columns.get(name) ?? []);
  samples.times.forEach((time, row) => {
    if (time < from || time > to) return;
    lines.push([time, ...columns.map((column) => column[row] ?? "")].join(","));
  });
  return new Blob([`${lines.join("\n")}\n`], { type: "text/csv" });
}

export interface Caption {
  text: string;
  color: string;
}

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
  let x = 10 * scale;
  for (const caption of captions) {
    draw.fillStyle = caption.color;
    draw.fillRect(x, head / 2 - scale, 14 * scale, 2.5 * scale);
    draw.fillStyle = text;
    draw.fillText(caption.text, x + 19 * scale, head / 2);
    x += 34 * scale + draw.measureText(caption.text).width;
  }
  draw.drawImage(canvas, 0, head);
  return new Promise((resolve) => picture.toBlob(resolve, "image/png"));
}
