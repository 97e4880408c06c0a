// SPDX-License-Identifier: Apache-2.0
#include "contact/mass_properties.h"

#include "contact/mesh_check.h"
#include "core/check.h"

namespace slew::contact {

using math::Mat3;
using math::Vec3;

namespace {

Vec3 middle_of(const MeshDef& mesh) {
  const auto [low, high] = extent_of(mesh);
  return (low + high) * 0.5;
}

// (4), from the integrals about o
MassProperties about_centre(double volume, Vec3 first, const Mat3& second, Vec3 o, double density) {
  MassProperties out;
  out.volume = volume;
  out.mass = density * volume;
  const Vec3 r = first * (1 / volume);
  out.centre = o + r;
  const Mat3 central = second - outer(r, r) * volume;
  const double trace = central(0, 0) + central(1, 1) + central(2, 2);
  out.inertia = (Mat3::diagonal(trace, trace, trace) - central) * density;
  return out;
}

}  // namespace

MassProperties shell_properties(const MeshDef& mesh, double thickness, double density) {
  SLEW_ASSERT(density > 0 && thickness > 0 && !mesh.triangles.empty());
  const Vec3 o = middle_of(mesh);
  double area = 0;
  Vec3 first;
  Mat3 second;
  for (const auto& triangle : mesh.triangles) {
    const Vec3 a = Vec3(mesh.vertices[triangle[0]]) - o, b = Vec3(mesh.vertices[triangle[1]]) - o,
               c = Vec3(mesh.vertices[triangle[2]]) - o;
    const double own = 0.5 * norm(cross(b - a, c - a));
    const Vec3 sum = a + b + c;
    area += own;
    first += sum * (own / 3);
    second += (outer(sum, sum) + outer(a, a) + outer(b, b) + outer(c, c)) * (own / 12);
  }
  return about_centre(thickness * area, first * thickness, second * thickness, o, density);
}

MassProperties mass_properties(const MeshDef& mesh, double density) {
  SLEW_ASSERT(density > 0 && !mesh.triangles.empty());
  const Vec3 o = middle_of(mesh);
  double volume6 = 0;
  Vec3 first24;
  Mat3 second120;
  for (const auto& triangle : mesh.triangles) {
    const Vec3 a = Vec3(mesh.vertices[triangle[0]]) - o, b = Vec3(mesh.vertices[triangle[1]]) - o,
               c = Vec3(mesh.vertices[triangle[2]]) - o;
    const double det = dot(a, cross(b, c));
    const Vec3 sum = a + b + c;
    volume6 += det;
    first24 += sum * det;
    second120 += (outer(sum, sum) + outer(a, a) + outer(b, b) + outer(c, c)) * det;
  }
  MassProperties out;
  out.volume = volume6 / 6;
  out.mass = density * out.volume;
  const Vec3 r = first24 * (1 / (24 * out.volume));
  out.centre = o + r;
  // (4)
  const Mat3 about_centre = second120 * (1.0 / 120) - outer(r, r) * out.volume;
  const double trace = about_centre(0, 0) + about_centre(1, 1) + about_centre(2, 2);
  out.inertia = (Mat3::diagonal(trace, trace, trace) - about_centre) * density;
  return out;
}

}  // namespace slew::contact
