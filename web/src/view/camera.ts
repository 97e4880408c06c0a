// SPDX-License-Identifier: Apache-2.0
// The camera: orbit by the pointer, presets, and following a body.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Stage } from "./stage";

// direction from the machine to the camera, in World
export const presets = {
  iso: new THREE.Vector3(0.75, -1, 0.55),
  front: new THREE.Vector3(0, -1, 0),
  side: new THREE.Vector3(1, 0, 0),
  top: new THREE.Vector3(0, -0.0001, 1),
} as const;
export type Preset = keyof typeof presets;

export interface CameraState {
  position: [number, number, number];
  target: [number, number, number];
}

export class Camera {
  readonly controls: OrbitControls;
  #stage: Stage;
  #followed?: THREE.Object3D;
  #last = new THREE.Vector3(); // place of the followed body

  constructor(stage: Stage) {
    this.#stage = stage;
    this.controls = new OrbitControls(stage.camera, stage.canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = 0.98 * Math.PI;
    this.controls.addEventListener("change", () => stage.draw());
  }

  look(preset: Preset, middle: THREE.Vector3, radius: number): void {
    const { camera } = this.#stage;
    const half = (camera.fov / 2) * (Math.PI / 180);
    const narrow = Math.atan(Math.tan(half) * Math.min(1, camera.aspect));
    const distance = (0.85 * radius) / Math.sin(narrow);
    this.controls.target.copy(middle);
    camera.position.copy(middle).addScaledVector(presets[preset].clone().normalize(), distance);
    this.controls.update();
  }

  follow(object: THREE.Object3D | undefined): void {
    this.#followed = object;
    object?.getWorldPosition(this.#last);
  }

  // After each change of poses.
  keepUp(): void {
    if (!this.#followed) return;
    const place = this.#followed.getWorldPosition(new THREE.Vector3());
    const way = place.clone().sub(this.#last);
    this.#last.copy(place);
    this.#stage.camera.position.add(way);
    this.controls.target.add(way);
    this.controls.update();
  }

  get state(): CameraState {
    return { position: this.#stage.camera.position.toArray(), target: this.controls.target.toArray() };
  }
  set state(state: CameraState) {
    this.#stage.camera.position.fromArray(state.position);
    this.controls.target.fromArray(state.target);
    this.controls.update();
  }
}
