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

}  // namespace

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
