// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/link_matrix.h"

#include <algorithm>

#include "core/index.h"

namespace slew::multibody {

using math::Vec3;

void add_points(int link_a, Vec3 s_a, int link_b, Vec3 s_b, const math::Mat3& A, LinkMatrix& matrix) noexcept {
  // the two blocks between two links are transposes of each other
  if (link_a == 0 || link_b == 0 || link_a < link_b) return;
  matrix.add(link_a, link_b, point_mass_block(A, s_a, s_b));
}

void add_masses(const Model& model, const Workspace& ws, LinkMatrix& matrix) noexcept {
  for (std::size_t link = 1; link < model.links.size(); ++link) {
    matrix.add(static_cast<int>(link), static_cast<int>(link), inertia_block(ws.inertia[link]));
  }
  for (std::size_t i = 0; i < model.coupled.size(); ++i) {
    const LineElement& line = model.lines[at(model.coupled[i].line)];
    const LineMotion& m = ws.lines[at(model.coupled[i].line)];
    const PointMasses A = point_masses(model.coupled[i], ws.coupled[i]);
    const Vec3 s1 = m.P1 - ws.motion[at(line.link1)].p, s2 = m.P2 - ws.motion[at(line.link2)].p;
    add_points(line.link1, s1, line.link1, s1, A.A11, matrix);
    add_points(line.link1, s1, line.link2, s2, A.A12, matrix);
    add_points(line.link2, s2, line.link1, s1, A.A12, matrix);
    add_points(line.link2, s2, line.link2, s2, A.A22, matrix);
  }
}

void add_relative(const Workspace& ws, int link1, int link2, Vec3 P, const RelativeMatrix& A,
                  LinkMatrix& matrix) noexcept {
  if (link1 == link2) return;
  const Vec3 s1 = P - ws.motion[at(link1)].p, s2 = P - ws.motion[at(link2)].p;
  if (link1 > 0) matrix.add(link1, link1, relative_block(A, s1, s1));
  if (link2 > 0) matrix.add(link2, link2, relative_block(A, s2, s2));
  if (link1 == 0 || link2 == 0) return;
  const bool is_first_later = link1 > link2;
  SpatialBlock between = is_first_later ? relative_block(A, s1, s2) : relative_block(A, s2, s1);
  for (double& x : between) x = -x;
  matrix.add(std::max(link1, link2), std::min(link1, link2), between);
}

}  // namespace slew::multibody
