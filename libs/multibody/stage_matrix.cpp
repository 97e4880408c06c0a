// The left side of an implicit stage: masses, joints, and the stiffness and damping of force elements.
#include <algorithm>
#include <cmath>
#include <set>

#include "multibody/body_block.h"
#include "multibody/element_law.h"
#include "multibody/loops.h"
#include "multibody/stage_passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

std::size_t at_index(int index) noexcept {
  return static_cast<std::size_t>(index);
}

// difference quotients over so much of 1 + |x|: the laws are linear between their corners
constexpr double kDifference = 1e-7;

// tau (D + sigma K) of a law along its coordinate; a law that pushes on is left out, the matrix stays definite
struct Slopes {
  double spring = 0, damper = 0;  // along with the rate, and of the second damper term alone
};

Slopes slopes_of(const ElementLaw& law, double x, double rate, const Stage& stage) noexcept {
  const double dx = kDifference * (1 + std::fabs(x)), dv = kDifference * (1 + std::fabs(rate));
  const double K = (force_of(law, x - dx, rate, 0) - force_of(law, x + dx, rate, 0)) / (2 * dx);
  const double D = (force_of(law, x, rate - dv, 0) - force_of(law, x, rate + dv, 0)) / (2 * dv);
  const double damping = (force_of(law, x, rate, rate - dv) - force_of(law, x, rate, rate + dv)) / (2 * dv);
  return {stage.tau * (std::max(0.0, D) + stage.sigma * std::max(0.0, K)), stage.tau * std::max(0.0, damping)};
}

void add_line(const StageContext& at, const Stage& stage, const LineElement& line, const LineMotion& m) noexcept {
  const Slopes slopes = slopes_of(line.law, m.length, m.rate, stage);
  // a pull holds the line straight
  const double pull = std::max(0.0, -force_of(line.law, m.length, m.rate, m.rate));
  const Mat3 along = outer(m.e, m.e);
  const Mat3 A = along * (slopes.spring + slopes.damper) +
                 (Mat3::identity() - along) * (stage.tau * stage.sigma * pull / m.length);
  add_pair(at.body, at.bws.ldl,
           {{line.link1, line.link2},
            {m.P1 - at.ws.motion[at_index(line.link1)].p, m.P2 - at.ws.motion[at_index(line.link2)].p},
            {{{A, A * -1.0}, {A * -1.0, A}}}});
}

void add_angle(const StageContext& at, const Stage& stage, const AngleElement& element, const AngleMotion& m) noexcept {
  // without a spring the angle is not evaluated, nor needed
  const bool has_spring = element.law.spring != 0 || element.law.end_spring != 0;
  const Slopes slopes = slopes_of(element.law, has_spring ? m.angle : 0, has_spring ? m.rate : 0, stage);
  const Vec3 axis = at.ws.motion[at_index(element.link1)].R * element.axis;
  Mat3 A = outer(axis, axis) * slopes.damper;
  if (has_spring) A += outer(m.n, m.n) * slopes.spring;
  const int links[2] = {element.link1, element.link2};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      if (links[i] == 0 || links[j] == 0 || (i != j && links[i] < links[j])) continue;
      SpatialBlock block{};
      add_to_block(A * (i == j ? 1.0 : -1.0), 3, 3, block);
      add_block(at.body, at.bws.ldl, links[i], links[j], block);
    }
  }
}

// A joint's force F at s from a link's origin turns it back when it pulls: (F . s) across s. Where it pushes nothing is
// added, the matrix stays definite.
void add_pulls(const StageContext& at, const Stage& stage) noexcept {
  for (std::size_t i = 1; i < at.body.joints.size(); ++i) {
    const Constraint& joint = at.body.joints[i];
    const double* multipliers =
        at.stages.multipliers.data() + at.bws.ldl.first_row(static_cast<int>(i) - 1) + at.body.row_offset(i);
    Vec3 F1, F2;
    for (std::size_t k = 0; k < joint.rows.size(); ++k) {
      const RowGradient& G = at.bws.rows[at_index(at.bws.first_row[i]) + k].G;
      F1 -= G.v1 * multipliers[k];
      F2 -= G.v2 * multipliers[k];
    }
    const auto add = [&](int link, Vec3 s, Vec3 F) {
      const double pull = dot(F, s);
      if (link == 0 || !(pull > 0)) return;
      SpatialBlock block{};
      add_to_block((Mat3::identity() - outer(s, s) * (1 / dot(s, s))) * (stage.tau * stage.sigma * pull), 3, 3, block);
      add_block(at.body, at.bws.ldl, link, link, block);
    };
    add(joint.link1, at.ws.motion[at_index(joint.link1)].R * joint.p_L1, F1);
    add(joint.link2, at.ws.motion[at_index(joint.link2)].R * joint.p_L2, F2);
  }
}

}  // namespace

void see_stops(const Model& model, const Workspace& ws, std::span<signed char> stops) noexcept {
  const auto side_of = [](const ElementLaw& law, double x, double rate) -> signed char {
    if (!(law.end_spring > 0)) return 0;
    const double force = math::stop_force(x, rate, law.min, law.max, law.end_spring, law.end_damping).force;
    return force > 0 ? -1 : force < 0 ? 1 : 0;
  };
  std::size_t k = 0;
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    stops[k++] = side_of(model.lines[i].law, ws.lines[i].length, ws.lines[i].rate);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    stops[k++] = side_of(model.angles[i].law, ws.angles[i].angle, ws.angles[i].rate);
  }
}

BodyModel build_stiff_body_model(const Model& model) {
  BodyModel body = build_body_model(model);
  std::set<std::pair<int, int>> coupled;
  for (const auto& [a, b] : body.pattern.couplings) coupled.insert({std::min(a, b), std::max(a, b)});
  const auto couple = [&](int link1, int link2) {
    if (link1 == 0 || link2 == 0 || link1 == link2) return;
    const std::pair<int, int> nodes(std::min(link1, link2) - 1, std::max(link1, link2) - 1);
    if (coupled.insert(nodes).second) body.pattern.couplings.push_back(nodes);
  };
  for (const LineElement& line : model.lines) couple(line.link1, line.link2);
  for (const AngleElement& angle : model.angles) couple(angle.link1, angle.link2);
  return body;
}

bool factorize_stage(const StageContext& at, const Stage& stage) noexcept {
  fill_matrix(at.model, at.body, at.ws, at.bws);
  for (std::size_t i = 0; i < at.model.lines.size(); ++i) {
    if (at.model.lines[i].law.is_active) add_line(at, stage, at.model.lines[i], at.ws.lines[i]);
  }
  for (std::size_t i = 0; i < at.model.angles.size(); ++i) {
    if (at.model.angles[i].law.is_active) add_angle(at, stage, at.model.angles[i], at.ws.angles[i]);
  }
  if (at.stages.has_multipliers) add_pulls(at, stage);
  return at.bws.ldl.factorize(kDependent);
}

}  // namespace slew::multibody
