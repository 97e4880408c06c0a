// SPDX-License-Identifier: Apache-2.0
// Named points of bodies, as marks of one size on the screen that nothing hides. They are those of the scene's text
// while it is edited, on the bodies of the session that runs.
import * as THREE from "three";
import type { NamedPoint } from "../edit/scene_file";
import type { Machine } from "./machine";

const kSize = 0.034; // of the distance from the camera
const kTexture = 64; // pixels

// A ring with a dot.
function markTexture(): THREE.Texture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = kTexture;
  const draw = canvas.getContext("2d")!;
  const circle = (radius: number) => {
    draw.beginPath();
    draw.arc(kTexture / 2, kTexture / 2, radius, 0, 2 * Math.PI);
  };
  circle(0.38 * kTexture);
  draw.fillStyle = "#fff9";
  draw.fill();
  draw.lineWidth = 0.12 * kTexture;
  draw.strokeStyle = "#fff";
  draw.stroke();
  circle(0.18 * kTexture);
  draw.fillStyle = "#fff";
  draw.fill();
  return new THREE.CanvasTexture(canvas);
}

export class PointMarks {
  #machine: Machine;
  #material = new THREE.SpriteMaterial({ map: markTexture(), depthTest: false, sizeAttenuation: false, fog: false });
  #marks: THREE.Sprite[] = [];
  #shown: NamedPoint[] = [];

  constructor(machine: Machine) {
    this.#machine = machine;
  }

  set color(color: THREE.Color) {
    this.#material.color.copy(color);
  }

  // Result: something has changed.
  show(points: NamedPoint[]): boolean {
    if (points === this.#shown) return false;
    this.#shown = points;
    for (const mark of this.#marks) mark.removeFromParent();
    // a body that the text alone has is nowhere
    this.#marks = points.filter((point) => this.#machine.hasFrame(point.body)).map((point) => {
      const mark = new THREE.Sprite(this.#material);
      mark.position.fromArray(point.position);
      mark.scale.setScalar(kSize);
      mark.renderOrder = 1;
      mark.userData["point"] = point;
      this.#machine.frame(point.body).add(mark);
      return mark;
    });
    return true;
  }

  // After a change of the machine's frames.
  showAgain(): void {
    const points = this.#shown;
    this.#shown = [];
    this.show(points);
  }

  // The nearest one that the ray meets.
  pick(ray: THREE.Raycaster): NamedPoint | undefined {
    return ray.intersectObjects(this.#marks, false)[0]?.object.userData["point"] as NamedPoint | undefined;
  }
}

export function textOf({ name, position }: NamedPoint): string {
  return `${name}  [${position.map((one) => +one.toFixed(4)).join(", ")}] m`;
}
