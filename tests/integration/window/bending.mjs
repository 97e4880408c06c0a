// SPDX-License-Identifier: Apache-2.0
// Meshes of bodies that bend (web/src/view/bending.ts), bundled as bending_parts.mjs, against displacements by hand.
import { bend, holdsOf } from "./bending_parts.mjs";

class Vector {
  constructor(x, y, z) {
    Object.assign(this, { x, y, z });
  }
  distanceToSquared(o) {
    return (this.x - o.x) ** 2 + (this.y - o.y) ** 2 + (this.z - o.z) ** 2;
  }
  clone() {
    return new Vector(this.x, this.y, this.z);
  }
  sub(o) {
    return new Vector(this.x - o.x, this.y - o.y, this.z - o.z);
  }
  dot(o) {
    return this.x * o.x + this.y * o.y + this.z * o.z;
  }
}

function require(condition, text) {
  if (!condition) throw new Error(text);
}

// A beam along x of 4 m with a node each metre, bent by w = x^2 / 100 along y; its mesh stands 0.2 m beside the nodes.
const nodes = Array.from({ length: 5 }, (_, i) => new Vector(i, 0, 0));
const deflections = nodes.map(({ x }) => new Vector(0, x ** 2 / 100, 0));
const points = [];
for (const x of [-0.5, 0, 0.25, 1, 1.5, 2.75, 4, 4.5]) points.push(x, 0.2, -0.1);
const bent = new Float32Array(points.length);
bend(points, holdsOf(points, nodes), deflections, bent);
// between two nodes the chord of the parabola, beyond the ends the last node
const expected = [0, 0, 0.0025, 0.01, 0.025, 0.0775, 0.16, 0.16];
expected.forEach((deflection, i) => {
  const moved = [0, 1, 2].map((axis) => bent[3 * i + axis] - points[3 * i + axis]);
  require(
    Math.abs(moved[0]) < 1e-6 && Math.abs(moved[1] - deflection) < 1e-6 && Math.abs(moved[2]) < 1e-6,
    `at x = ${points[3 * i]} m the mesh has moved by ${moved}, not by ${deflection} m along y`,
  );
});
console.log(`${expected.length} points of a mesh follow five nodes`);
