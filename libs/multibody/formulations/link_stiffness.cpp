// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/link_stiffness.h"

#include <algorithm>

#include "core/index.h"
#include "multibody/forces/element_law.h"
#include "multibody/forces/stiffness_sum.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

class Adding {
 public:
  Adding(const Model& model, const Workspace& ws, StiffnessSum& sum) noexcept : model_(model), ws_(ws), sum_(sum) {}

  void add_all() noexcept {
    for (std::size_t i = 0; i < model_.lines.size(); ++i) {
      if (model_.lines[i].law.is_active) add_line(model_.lines[i], ws_.lines[i]);
    }
    for (std::size_t i = 0; i < model_.angles.size(); ++i) {
      if (model_.angles[i].law.is_active) add_angle(model_.angles[i], ws_.angles[i]);
    }
    for_each_force_kind([&](auto row) {
      for (const auto& element : elements_of(row, model_.elements)) row.add_stiffness(element, sum_);
    });
  }

 private:
  void add_line(const LineElement& line, const LineMotion& m) noexcept {
    const ChangeWeights weights = sum_.weights();
    const ElementSlopes slopes = slopes_of(line.law, m.length, m.rate, m.rate);
    const double along = weights.position * std::max(0.0, slopes.stiffness) +
                         weights.rate * std::max(0.0, slopes.end_damping + slopes.damping);
    // a pull holds the line straight
    const double pull = std::max(0.0, -force_of(line.law, m.length, m.rate, m.rate));
    const Mat3 e = outer(m.e, m.e);
    const Mat3 A = e * along + (Mat3::identity() - e) * (sum_.pull_weight() * pull / m.length);
    sum_.add_stretch(line.link1, m.P1, line.link2, m.P2, A);
  }

  void add_angle(const AngleElement& element, const AngleMotion& m) noexcept {
    const ChangeWeights weights = sum_.weights();
    // without a spring the angle is not evaluated, nor needed
    const bool is_sprung = has_spring(element.law);
    const ElementSlopes slopes =
        slopes_of(element.law, is_sprung ? m.angle : 0, is_sprung ? m.rate : 0, damper_speed(element, ws_));
    const Vec3 axis = ws_.motion[at(element.link1)].R * element.axis;
    PairMatrix A{{}, {}, outer(axis, axis) * (weights.rate * std::max(0.0, slopes.damping))};
    if (is_sprung) {
      A.ww += outer(m.n, m.n) *
              (weights.position * std::max(0.0, slopes.stiffness) + weights.rate * std::max(0.0, slopes.end_damping));
    }
    sum_.add_relative(element.link1, element.link2, ws_.motion[at(element.link2)].p, A);
  }

  const Model& model_;
  const Workspace& ws_;
  StiffnessSum& sum_;
};

}  // namespace

std::span<const LinkMotion> StiffnessSum::motion() const noexcept {
  return ws_.motion;
}

void StiffnessSum::add_points(int link_a, Vec3 s_a, int link_b, Vec3 s_b, const Mat3& A) noexcept {
  multibody::add_points(link_a, s_a, link_b, s_b, A, matrix_);
}

void StiffnessSum::add_stretch(int link1, Vec3 P1, int link2, Vec3 P2, const Mat3& A) noexcept {
  const Vec3 s1 = P1 - ws_.motion[at(link1)].p, s2 = P2 - ws_.motion[at(link2)].p;
  add_points(link1, s1, link1, s1, A);
  add_points(link2, s2, link2, s2, A);
  add_points(link1, s1, link2, s2, A * -1.0);
  add_points(link2, s2, link1, s1, A * -1.0);
}

void StiffnessSum::add_relative(int link1, int link2, Vec3 P, const PairMatrix& A) noexcept {
  multibody::add_relative(ws_, link1, link2, P, {A.vv, A.vw, A.ww}, matrix_);
}

void StiffnessSum::add_frames(const FramePair& frames, const Deflection& d, const SixBySix& slopes,
                              const Six& force) noexcept {
  add_relative(frames.link1, frames.link2, d.P2, matrix_of(d, slopes));
  const Vec3 F = d.R_W1 * Vec3(force[0], force[1], force[2]);
  add_pull(frames.link1, d.P2 - ws_.motion[at(frames.link1)].p, -F, pull_weight_, matrix_);
  add_pull(frames.link2, d.P2 - ws_.motion[at(frames.link2)].p, F, pull_weight_, matrix_);
}

void add_stiffness(const Model& model, const Workspace& ws, ChangeWeights weights, LinkMatrix& matrix,
                   Stiffness which) noexcept {
  StiffnessSum sum(ws, weights, which == Stiffness::with_pulls ? weights.position : 0, matrix);
  Adding(model, ws, sum).add_all();
}

void add_pull(int link, Vec3 s, Vec3 F, double weight, LinkMatrix& matrix) noexcept {
  const double pull = dot(F, s);
  if (link == 0 || !(pull > 0)) return;
  SpatialBlock block{};
  add_to_block((Mat3::identity() - outer(s, s) * (1 / dot(s, s))) * (weight * pull), 3, 3, block);
  matrix.add(link, link, block);
}

}  // namespace slew::multibody
