// SPDX-License-Identifier: Apache-2.0
// The machine in the scene: frames of /slewring/transforms with the shapes of /slewring/scene.
import * as THREE from "three";
import type { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { Session } from "../session";
import { type Entity, meshesOf, type Model, place, type Vector } from "./shapes";

interface Transform {
  parent_frame_id: string;
  child_frame_id: string;
  translation: Vector;
  rotation: Vector & { w: number };
}

// a box of the Ground this wide [m], and this flat, is the ground itself
const kGroundWidth = 15;
const kGroundFlatness = 0.05;
const kBoxCorners = 36; // of its triangles

export class Machine {
  readonly root = new THREE.Group();
  #frames = new Map<string, THREE.Group>();
  #entities = new Map<string, THREE.Object3D>();
  #loader?: Promise<GLTFLoader>;
  #groundHeight?: number; // in World; undefined: the scene has no ground
  #awaited = 0; // models that are not loaded yet
  isPosed = false;

  constructor(session: Session, changed: () => void, rebuilt: () => void) {
    session.subscribe("/slewring/transforms", (message) => {
      this.#pose((message.value as { transforms: Transform[] }).transforms);
      changed();
    });
    session.subscribe("/slewring/scene", (message) => {
      this.#build((message.value as { entities: Entity[] }).entities, session, rebuilt);
      rebuilt();
    });
  }

  get bodies(): string[] {
    return [...this.#entities.keys()].filter((id) => id !== "Ground" && !id.includes("/"));
  }

  // Meshes and edges of a body.
  solidsOf(body: string): THREE.Object3D[] {
    const solids: THREE.Object3D[] = [];
    this.#entities.get(body)?.traverse((object) => {
      if (object instanceof THREE.Mesh || object instanceof THREE.LineSegments) solids.push(object);
    });
    return solids;
  }

  hasFrame(name: string): boolean {
    return this.#frames.has(name);
  }

  frame(name: string): THREE.Group {
    let frame = this.#frames.get(name);
    if (!frame) {
      this.#frames.set(name, (frame = new THREE.Group()));
      this.root.add(frame);
    }
    return frame;
  }

  // The element of a mesh: a body, or the cylinder of a tube or rod.
  static elementOf(object: THREE.Object3D | null): string | undefined {
    for (; object; object = object.parent) {
      const id = object.userData["entity"] as string | undefined;
      if (id !== undefined) return id.replace(/\/(tube|rod)$/, "");
    }
    return undefined;
  }

  highlight(element: string | undefined, color: THREE.Color): void {
    for (const [id, entity] of this.#entities) {
      const isChosen = element !== undefined && (id === element || id.startsWith(`${element}/`));
      entity.traverse((object) => {
        const material = (object as THREE.Mesh).material;
        if (material instanceof THREE.MeshStandardMaterial) {
          material.emissive.copy(color);
          material.emissiveIntensity = isChosen ? 0.3 : 0;
        }
      });
    }
  }

  // Poses, shapes and models are there.
  get isComplete(): boolean {
    return this.isPosed && this.bodies.length > 0 && this.#awaited === 0;
  }

  // Sphere around everything but the ground and what is as wide, and the height of the ground: without one the lowest
  // point, at most 0.
  extent(): { center: THREE.Vector3; radius: number; ground: number } {
    const box = new THREE.Box3();
    this.root.updateMatrixWorld(true);
    this.#replaceGround();
    for (const [id, entity] of this.#entities) if (id !== "Ground") box.expandByObject(entity);
    for (const part of this.#groundParts()) {
      const own = new THREE.Box3().setFromObject(part);
      const size = own.getSize(new THREE.Vector3());
      if (part.visible && Math.max(size.x, size.y) < kGroundWidth) box.union(own);
    }
    if (box.isEmpty()) box.expandByPoint(new THREE.Vector3()).expandByScalar(1);
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    const ground = this.#groundHeight ?? Math.min(0, box.min.z);
    return { center: sphere.center, radius: Math.max(sphere.radius, 0.05), ground };
  }

  #pose(transforms: Transform[]): void {
    for (const { parent_frame_id, child_frame_id, translation: p, rotation: q } of transforms) {
      const frame = this.frame(child_frame_id);
      const parent = parent_frame_id === "World" ? this.root : this.frame(parent_frame_id);
      if (frame.parent !== parent) parent.add(frame);
      frame.position.set(p.x, p.y, p.z);
      frame.quaternion.set(q.x, q.y, q.z, q.w);
    }
    this.root.updateMatrixWorld(true);
    this.isPosed = true;
  }

  #build(entities: Entity[], session: Session, rebuilt: () => void): void {
    for (const entity of this.#entities.values()) {
      entity.removeFromParent();
      entity.traverse((object) => {
        if (object instanceof THREE.Mesh || object instanceof THREE.LineSegments) object.geometry.dispose();
      });
    }
    this.#entities.clear();
    for (const entity of entities) {
      const object = new THREE.Group();
      object.add(meshesOf(entity));
      object.userData["entity"] = entity.id;
      this.frame(entity.frame_id).add(object);
      this.#entities.set(entity.id, object);
      for (const model of entity.models ?? []) {
        this.#awaited += 1;
        this.#load(model, session)
          .then(
            (mesh) => object.add(mesh),
            (error) =>
              session.noticed.emit({ level: 1, message: `the mesh ${model.url} is not shown: ${String(error)}` }),
          )
          .finally(() => {
            this.#awaited -= 1;
            rebuilt();
          });
      }
    }
  }

  // The Ground's primitives and models.
  #groundParts(): THREE.Object3D[] {
    const [primitives, ...models] = this.#entities.get("Ground")?.children ?? [];
    return [...(primitives?.children ?? []), ...models];
  }

  // The page has a ground of its own: it takes the place and the height of the scene's.
  #replaceGround(): void {
    this.#groundHeight = undefined;
    for (const part of this.#groundParts()) {
      let corners = 0;
      part.traverse((object) => {
        if (object instanceof THREE.Mesh) corners += object.geometry.getAttribute("position").count;
      });
      const isBox = corners > 0 && corners <= kBoxCorners;
      const box = new THREE.Box3().setFromObject(part);
      const size = box.getSize(new THREE.Vector3());
      const width = Math.min(size.x, size.y);
      if (!isBox || width < kGroundWidth || size.z > kGroundFlatness * width) continue;
      part.visible = false;
      this.#groundHeight = box.max.z;
    }
  }

  async #load(model: Model, session: Session): Promise<THREE.Object3D> {
    // the loader is large, and most scenes have no model
    this.#loader ??= import("three/addons/loaders/GLTFLoader.js").then((module) => new module.GLTFLoader());
    const loader = await this.#loader;
    const { scene } = await loader.loadAsync(session.urlOf(model.url));
    // as Foxglove does: y of the file, which is up, becomes z
    scene.rotation.x = Math.PI / 2;
    const placed = new THREE.Group().add(scene);
    placed.scale.set(model.scale.x, model.scale.y, model.scale.z);
    place(placed, model.pose);
    scene.traverse((object) => {
      if (!(object instanceof THREE.Mesh)) return;
      object.castShadow = true;
      object.receiveShadow = true;
      object.material = (object.material as THREE.Material).clone();
      if (model.override_color && object.material instanceof THREE.MeshStandardMaterial)
        object.material.color.setRGB(model.color.r, model.color.g, model.color.b, THREE.SRGBColorSpace);
    });
    return placed;
  }
}
