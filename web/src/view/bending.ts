// SPDX-License-Identifier: Apache-2.0
// Bodies that bend: every point of their meshes moves with the two nodes of the body that are nearest to it, by its place
// on the line between them. Sections are moved, not turned; without exaggeration, so that what hangs on the body fits.
import * as THREE from "three";
import { TessellateModifier } from "three/addons/modifiers/TessellateModifier.js";
import type { BentBody, Session } from "../session";
import type { Machine } from "./machine";

const kStill = 1e-6; // m; smaller changes of a deflection are not drawn
const kMostSplits = 8; // of an edge into halves

// For each point (x, y, z after each other) the two nodes nearest to it, and the part of the second.
export interface Holds {
  first: Uint32Array;
  second: Uint32Array;
  part: Float32Array; // 0 to 1
}

export function holdsOf(points: ArrayLike<number>, nodes: THREE.Vector3[]): Holds {
  const count = points.length / 3;
  const holds = { first: new Uint32Array(count), second: new Uint32Array(count), part: new Float32Array(count) };
  const point = new THREE.Vector3();
  for (let i = 0; i < count; ++i) {
    point.set(points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!);
    let [first, second] = [0, 0];
    let [least, next] = [Infinity, Infinity];
    nodes.forEach((node, k) => {
      const distance = node.distanceToSquared(point);
      if (distance < least) [second, next, first, least] = [first, least, k, distance];
      else if (distance < next) [second, next] = [k, distance];
    });
    const [a, b] = [nodes[first]!, nodes[second]!];
    const length = a.distanceToSquared(b);
    const along = length > 0 ? point.clone().sub(a).dot(b.clone().sub(a)) / length : 0;
    holds.first[i] = first;
    holds.second[i] = second;
    holds.part[i] = Math.min(1, Math.max(0, along));
  }
  return holds;
}

// rest: points without deflection; deflections: of the nodes, in the axes of the points.
export function bend(rest: ArrayLike<number>, holds: Holds, deflections: THREE.Vector3[], bent: Float32Array): void {
  for (let i = 0; i < holds.part.length; ++i) {
    const [a, b, t] = [deflections[holds.first[i]!]!, deflections[holds.second[i]!]!, holds.part[i]!];
    bent[3 * i] = rest[3 * i]! + a.x + t * (b.x - a.x);
    bent[3 * i + 1] = rest[3 * i + 1]! + a.y + t * (b.y - a.y);
    bent[3 * i + 2] = rest[3 * i + 2]! + a.z + t * (b.z - a.z);
  }
}

interface Solid {
  geometry: THREE.BufferGeometry;
  rest: Float32Array;
  holds: Holds;
  ofBody: THREE.Matrix3; // from axes of the body to those of the geometry
}
interface Bent {
  names: string[][]; // variables of x, y, z by node
  shown: THREE.Vector3[]; // deflections that the meshes have
  solids: Solid[];
}

export class Bending {
  #session: Session;
  #machine: Machine;
  #bodies: Bent[] = [];
  #stop: (() => void)[] = [];
  #known?: BentBody[];

  constructor(session: Session, machine: Machine) {
    this.#session = session;
    this.#machine = machine;
    session.changed.on(() => {
      if (session.description?.bending !== this.#known) this.rebuild();
    });
  }

  // After a change of the session or of the meshes.
  rebuild(): void {
    for (const stop of this.#stop.splice(0)) stop();
    this.#known = this.#session.description?.bending;
    this.#bodies = (this.#known ?? []).map((body) => this.#take(body));
    for (const { body } of this.#known ?? []) this.#stop.push(this.#session.watch(body));
    this.update();
  }

  // Before a picture is drawn.
  update(): void {
    const { values } = this.#session;
    for (const { names, shown, solids } of this.#bodies) {
      const deflections = names.map((three) => new THREE.Vector3(...three.map((name) => values.get(name) ?? 0)));
      if (deflections.every((one, i) => one.distanceTo(shown[i]!) < kStill)) continue;
      shown.splice(0, shown.length, ...deflections);
      for (const { geometry, rest, holds, ofBody } of solids) {
        const position = geometry.getAttribute("position") as THREE.BufferAttribute;
        bend(rest, holds, deflections.map((one) => one.clone().applyMatrix3(ofBody)), position.array as Float32Array);
        position.needsUpdate = true;
      }
    }
  }

  #take({ body, nodes }: BentBody): Bent {
    const places = nodes.map((node) => new THREE.Vector3(...node.position));
    return {
      names: nodes.map(({ id }) => ["x", "y", "z"].map((axis) => `${body}.Node${id}.deflection.${axis}`)),
      shown: nodes.map(() => new THREE.Vector3()),
      solids: this.#machine.solidsOf(body).map((object) => this.#solidOf(object as THREE.Mesh, body, places)),
    };
  }

  // Positions become numbers of their own, in the place of what the geometry shares or packs; edges that are longer than
  // from one node to the next are split.
  #solidOf(object: THREE.Mesh, body: string, places: THREE.Vector3[]): Solid {
    object.updateWorldMatrix(true, false);
    const toBody = this.#machine.frame(body).matrixWorld.clone().invert().multiply(object.matrixWorld);
    if (!object.geometry.userData["rest"]) {
      const extent = new THREE.Box3().setFromPoints(places).getSize(new THREE.Vector3()).length();
      const longest = extent / Math.max(1, places.length - 1) / toBody.getMaxScaleOnAxis();
      const whole = object.geometry;
      object.geometry = object instanceof THREE.LineSegments ? splitLines(whole, longest) : splitFaces(whole, longest);
      whole.dispose();
    }
    const { geometry } = object;
    const packed = geometry.getAttribute("position");
    const kept = geometry.userData["rest"] as Float32Array | undefined; // before it was bent the first time
    const rest = kept ?? new Float32Array(3 * packed.count);
    if (!kept) {
      for (let i = 0; i < packed.count; ++i) rest.set([packed.getX(i), packed.getY(i), packed.getZ(i)], 3 * i);
      geometry.userData["rest"] = rest;
      geometry.setAttribute("position", new THREE.BufferAttribute(rest.slice(), 3));
    } else {
      (packed.array as Float32Array).set(rest);
    }
    const inBody = new Float32Array(rest.length);
    const point = new THREE.Vector3();
    for (let i = 0; i < rest.length; i += 3) point.fromArray(rest, i).applyMatrix4(toBody).toArray(inBody, i);
    return { geometry, rest, holds: holdsOf(inBody, places), ofBody: new THREE.Matrix3().setFromMatrix4(toBody).invert() };
  }
}

function splitFaces(geometry: THREE.BufferGeometry, longest: number): THREE.BufferGeometry {
  return longest > 0 ? new TessellateModifier(longest, kMostSplits).modify(geometry) : geometry.clone();
}

function splitLines(geometry: THREE.BufferGeometry, longest: number): THREE.BufferGeometry {
  const points = geometry.getAttribute("position");
  const [a, b] = [new THREE.Vector3(), new THREE.Vector3()];
  const split: THREE.Vector3[] = [];
  for (let i = 0; i + 1 < points.count; i += 2) {
    a.fromBufferAttribute(points, i);
    b.fromBufferAttribute(points, i + 1);
    const parts = longest > 0 ? Math.min(2 ** kMostSplits, Math.max(1, Math.ceil(a.distanceTo(b) / longest))) : 1;
    for (let k = 0; k < parts; ++k) split.push(a.clone().lerp(b, k / parts), a.clone().lerp(b, (k + 1) / parts));
  }
  return new THREE.BufferGeometry().setFromPoints(split);
}
