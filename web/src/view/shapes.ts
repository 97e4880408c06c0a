// SPDX-License-Identifier: Apache-2.0
// Meshes of the primitives of foxglove.SceneUpdate. Bodies without shapes come as lines from a hub to the points where
// joints and forces act: they become a beam with lugs. Cylinders get eyes and a gland.
import * as THREE from "three";

export interface Vector {
  x: number;
  y: number;
  z: number;
}
interface Pose {
  position: Vector;
  orientation: Vector & { w: number };
}
interface Color {
  r: number;
  g: number;
  b: number;
  a: number;
}
interface Solid {
  pose: Pose;
  size: Vector;
  color: Color;
}
interface Round extends Solid {
  bottom_scale: number;
  top_scale: number;
}
interface Lines {
  type: number;
  pose: Pose;
  thickness: number;
  points: Vector[];
  color: Color;
}
interface Triangles {
  pose: Pose;
  points: Vector[];
  color: Color;
  indices: number[];
}
export interface Model {
  pose: Pose;
  scale: Vector;
  color: Color;
  override_color: boolean;
  url: string;
  media_type: string;
}
export interface Entity {
  id: string;
  frame_id: string;
  cubes?: Solid[];
  spheres?: Solid[];
  cylinders?: Round[];
  lines?: Lines[];
  triangles?: Triangles[];
  models?: Model[];
}

const kMostEdgeTriangles = 4000; // of a surface whose edges are drawn
const kEdgeAngle = 30; // deg
const vector = (v: Vector) => new THREE.Vector3(v.x, v.y, v.z);

export function place(object: THREE.Object3D, pose: Pose): THREE.Object3D {
  object.position.copy(vector(pose.position));
  object.quaternion.set(pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w);
  return object;
}

export function materialOf(color: Color, metalness = 0.15, roughness = 0.62): THREE.MeshStandardMaterial {
  return new THREE.MeshStandardMaterial({
    color: new THREE.Color().setRGB(color.r, color.g, color.b, THREE.SRGBColorSpace),
    metalness,
    roughness,
    transparent: color.a < 1,
    opacity: color.a,
  });
}

function solid(geometry: THREE.BufferGeometry, material: THREE.Material): THREE.Mesh {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.castShadow = true;
  mesh.receiveShadow = true;
  return mesh;
}

const edgeMaterial = new THREE.LineBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.28 });

function withEdges(mesh: THREE.Mesh): THREE.Mesh {
  const edges = new THREE.LineSegments(new THREE.EdgesGeometry(mesh.geometry, kEdgeAngle), edgeMaterial);
  edges.raycast = () => {};
  mesh.add(edges);
  return mesh;
}

// A beam between two points whose rectangular section (height along `up`, width across) changes linearly.
function beam(
  from: THREE.Vector3,
  to: THREE.Vector3,
  up: THREE.Vector3,
  begin: [height: number, width: number],
  end: [height: number, width: number],
  material: THREE.Material,
): THREE.Mesh {
  const length = from.distanceTo(to);
  const geometry = new THREE.BoxGeometry(length, 1, 1);
  const points = geometry.getAttribute("position");
  for (let i = 0; i < points.count; ++i) {
    const [height, width] = points.getX(i) < 0 ? begin : end;
    points.setXYZ(i, points.getX(i) + length / 2, points.getY(i) * height, points.getZ(i) * width);
  }
  geometry.computeVertexNormals();
  const mesh = withEdges(solid(geometry, material));
  const x = to.clone().sub(from).normalize();
  const z = x.clone().cross(up).normalize();
  mesh.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(x, z.clone().cross(x), z));
  mesh.position.copy(from);
  return mesh;
}

// A pin across the plane of a body.
function pin(at: THREE.Vector3, across: THREE.Vector3, radius: number, length: number, material: THREE.Material) {
  const mesh = withEdges(solid(new THREE.CylinderGeometry(radius, radius, length, 24), material));
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), across);
  mesh.position.copy(at);
  return mesh;
}

// A load that hangs from its hub: a bag around its centre of mass.
function bag(hub: THREE.Vector3, center: THREE.Vector3, thickness: number, material: THREE.Material): THREE.Object3D {
  const group = new THREE.Group();
  const depth = hub.distanceTo(center);
  const radius = 0.62 * depth;
  const outline = [
    [0.001, -0.85],
    [0.62, -0.82],
    [0.92, -0.6],
    [1, -0.15],
    [0.9, 0.3],
    [0.6, 0.68],
    [0.22, 0.95],
    [0.06, 1.55],
    [0.001, 1.6],
  ].map(([r, y]) => new THREE.Vector2(r! * radius, y! * radius));
  const body = solid(new THREE.LatheGeometry(new THREE.SplineCurve(outline).getPoints(40), 32), material);
  body.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), hub.clone().sub(center).normalize());
  body.position.copy(center);
  group.add(body, pin(hub, new THREE.Vector3(0, 0, 1), thickness / 2, thickness, material));
  return group;
}

// A body by its hub and the points where something acts on it.
function framework(lines: Lines, material: THREE.Material): THREE.Object3D {
  const group = new THREE.Group();
  const points = lines.points.map(vector);
  const hub = points[0] ?? new THREE.Vector3();
  const ends = points.filter((_, i) => i % 2 === 1);
  const far = ends.reduce((best, end) => (end.distanceTo(hub) > best.distanceTo(hub) ? end : best), hub);
  const length = far.distanceTo(hub);
  const thickness = lines.thickness;
  if (length < 1e-6) {
    const ball = solid(new THREE.SphereGeometry(thickness, 24, 16), material);
    ball.position.copy(hub);
    group.add(ball);
    return group;
  }
  if (ends.slice(0, -1).every((end) => end.distanceTo(hub) < 1e-6)) return bag(hub, ends.at(-1)!, thickness, material);

  const axis = far.clone().sub(hub).normalize();
  const besideAxis = (point: THREE.Vector3) => {
    const arm = point.clone().sub(hub);
    return arm.addScaledVector(axis, -arm.dot(axis));
  };
  // the plane of the body is that of its axis and the point farthest beside it
  let up = ends.map(besideAxis).reduce((best, arm) => (arm.length() > best.length() ? arm : best), new THREE.Vector3());
  if (up.length() < 1e-3 * length) up = besideAxis(hub.clone().add(new THREE.Vector3(0, 1, 0)));
  if (up.length() < 1e-3) up = besideAxis(hub.clone().add(new THREE.Vector3(0, 0, 1)));
  up.normalize();
  const across = axis.clone().cross(up).normalize();
  const height = Math.min(3.2 * thickness, 0.4 * length);
  const width = 0.72 * height;
  group.add(beam(hub, far, up, [height, width], [0.62 * height, 0.8 * width], material));
  group.add(pin(hub, across, 0.42 * height, 1.2 * width, material));
  group.add(pin(far, across, 0.3 * height, 1.1 * width, material));
  for (const end of ends) {
    const arm = besideAxis(end);
    if (arm.length() < 0.3 * height || end === far) continue;
    const foot = end.clone().sub(arm);
    group.add(beam(foot, end, axis, [1.4 * height, 0.6 * width], [0.45 * height, 0.5 * width], material));
    group.add(pin(end, across, 0.24 * height, 0.9 * width, material));
  }
  return group;
}

// Tube or rod of a cylinder: along z of its frame from the eye.
function cylinderPart(round: Round, isRod: boolean): THREE.Object3D {
  const group = new THREE.Group();
  const radius = round.size.x / 2;
  const length = round.size.z;
  const material = isRod ? materialOf(round.color, 0.75, 0.28) : materialOf(round.color, 0.35, 0.5);
  const add = (begin: number, end: number, size: number) => {
    const mesh = solid(new THREE.CylinderGeometry(size, size, end - begin, 32), material);
    mesh.rotation.x = Math.PI / 2;
    mesh.position.z = (begin + end) / 2;
    group.add(mesh);
  };
  const eye = isRod ? 1.35 * radius : 0.85 * radius;
  add(isRod ? 0 : 0.6 * eye, length, radius);
  if (!isRod) {
    add(length - 1.1 * radius, length, 1.12 * radius); // gland
    add(0.6 * eye, 1.2 * radius, 1.08 * radius); // bottom
  }
  const ball = solid(new THREE.SphereGeometry(eye, 24, 16), material);
  group.add(ball);
  return group;
}

function surface(triangles: Triangles): THREE.Mesh {
  const geometry = new THREE.BufferGeometry();
  const points = triangles.points.flatMap((p) => [p.x, p.y, p.z]);
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  if (triangles.indices.length > 0) geometry.setIndex(triangles.indices);
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  const material = materialOf(triangles.color);
  material.side = THREE.DoubleSide;
  const mesh = solid(flat, material);
  return triangles.indices.length < 3 * kMostEdgeTriangles ? withEdges(mesh) : mesh;
}

// All but its models, which have to be fetched.
export function meshesOf(entity: Entity): THREE.Object3D {
  const group = new THREE.Group();
  for (const cube of entity.cubes ?? []) {
    const { x, y, z } = cube.size;
    group.add(place(withEdges(solid(new THREE.BoxGeometry(x, y, z), materialOf(cube.color))), cube.pose));
  }
  for (const sphere of entity.spheres ?? []) {
    const mesh = solid(new THREE.SphereGeometry(0.5, 40, 24), materialOf(sphere.color));
    mesh.scale.copy(vector(sphere.size));
    group.add(place(mesh, sphere.pose));
  }
  for (const round of entity.cylinders ?? []) {
    if (/\/(tube|rod)$/.test(entity.id)) {
      group.add(cylinderPart(round, entity.id.endsWith("/rod")));
      continue;
    }
    const geometry = new THREE.CylinderGeometry(0.5 * round.top_scale, 0.5 * round.bottom_scale, 1, 40);
    geometry.rotateX(Math.PI / 2).scale(round.size.x, round.size.y, round.size.z);
    group.add(place(withEdges(solid(geometry, materialOf(round.color))), round.pose));
  }
  for (const lines of entity.lines ?? []) group.add(place(framework(lines, materialOf(lines.color)), lines.pose));
  for (const triangles of entity.triangles ?? []) group.add(place(surface(triangles), triangles.pose));
  return group;
}
