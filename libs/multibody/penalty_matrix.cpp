// The matrix of the penalty formulations, block by block: equation (1) of body_penalty.h, and A_h of (7).
#include <algorithm>
#include <array>

#include "math/stop.h"
#include "multibody/passes.h"
#include "multibody/penalty_passes.h"
#include "multibody/spatial_block.h"

namespace slew::multibody {

using math::Vec3;

namespace {

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

std::array<double, kLinkSpeeds> spatial(Vec3 v, Vec3 w) noexcept {
  return {v[0], v[1], v[2], w[0], w[1], w[2]};
}

// Sum of weighted squares of rows between two links.
class RowBlocks {
 public:
  void add(const RowGradient& G, double weight) noexcept {
    const auto one = spatial(G.v1, G.w1), two = spatial(G.v2, G.w2);
    for (std::size_t r = 0; r < kLinkSpeeds; ++r) {
      for (std::size_t c = 0; c < kLinkSpeeds; ++c) {
        const std::size_t k = r * kLinkSpeeds + c;
        // symmetric to the bit
        own1_[k] += weight * (one[r] * one[c]);
        own2_[k] += weight * (two[r] * two[c]);
        between_[k] += weight * (one[r] * two[c]);
      }
    }
  }
  void put(int link1, int link2, math::BlockLdl& ldl) const noexcept {
    if (link1 > 0) ldl.add_diagonal(link1 - 1, own1_);
    if (link2 > 0) ldl.add_diagonal(link2 - 1, own2_);
    if (link1 > 0 && link2 > 0) ldl.add_coupling(link1 - 1, link2 - 1, between_);
  }

 private:
  SpatialBlock own1_{}, own2_{}, between_{};
};

void add_masses(const Model& model, const Workspace& ws, math::BlockLdl& ldl) noexcept {
  for (std::size_t link = 1; link < model.links.size(); ++link) {
    ldl.add_diagonal(static_cast<int>(link) - 1, inertia_block(ws.inertia[link]));
  }
  for (std::size_t i = 0; i < model.coupled.size(); ++i) {
    const LineElement& line = model.lines[at(model.coupled[i].line)];
    const LineMotion& m = ws.lines[at(model.coupled[i].line)];
    const PointMasses A = point_masses(model.coupled[i], ws.coupled[i]);
    const Vec3 s1 = m.P1 - ws.motion[at(line.link1)].p, s2 = m.P2 - ws.motion[at(line.link2)].p;
    if (line.link1 > 0) ldl.add_diagonal(line.link1 - 1, point_mass_block(A.A11, s1, s1));
    if (line.link2 > 0) ldl.add_diagonal(line.link2 - 1, point_mass_block(A.A22, s2, s2));
    if (line.link1 > 0 && line.link2 > 0) {
      ldl.add_coupling(line.link1 - 1, line.link2 - 1, point_mass_block(A.A12, s1, s2));
    }
  }
}

// h/2 C + h^2/4 K of a law along its coordinate
double implicit_mass(const ElementLaw& law, double x, double v, double h) noexcept {
  double stiffness = law.spring, damping = law.damping;
  if (law.end_spring > 0) {
    const math::StopForce stop = math::stop_force(x, v, law.min, law.max, law.end_spring, law.end_damping);
    stiffness -= stop.d_x;
    damping -= stop.d_v;
  }
  return 0.5 * h * damping + 0.25 * h * h * stiffness;
}

void add_elements(const Model& model, const Workspace& ws, double h, math::BlockLdl& ldl) noexcept {
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    const LineElement& line = model.lines[i];
    if (!line.law.is_active || line.link1 == line.link2) continue;
    const LineMotion& m = ws.lines[i];
    const Vec3 s1 = m.P1 - ws.motion[at(line.link1)].p, s2 = m.P2 - ws.motion[at(line.link2)].p;
    RowBlocks blocks;
    blocks.add({m.e, cross(s1, m.e), -m.e, cross(m.e, s2)}, implicit_mass(line.law, m.length, m.rate, h));
    blocks.put(line.link1, line.link2, ldl);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    const AngleElement& element = model.angles[i];
    if (!element.law.is_active || element.link1 == element.link2) continue;
    RowBlocks blocks;
    // the damper turns about the axis, spring and end dampers along the gradient of the angle
    ElementLaw spring = element.law;
    spring.damping = 0;
    if (spring.spring != 0 || spring.end_spring != 0) {
      const AngleMotion& m = ws.angles[i];
      blocks.add({Vec3(), -m.n, Vec3(), m.n}, implicit_mass(spring, m.angle, m.rate, h));
    }
    const Vec3 axis = ws.motion[at(element.link1)].R * element.axis;
    blocks.add({Vec3(), -axis, Vec3(), axis}, 0.5 * h * element.law.damping);
    blocks.put(element.link1, element.link2, ldl);
  }
}

// A pull T on a link at s from its origin turns the link back: T . s across s. A push would make the matrix indefinite
// and is left to the right-hand side.
void add_pull(int link, Vec3 s, Vec3 T, double h, math::BlockLdl& ldl) noexcept {
  const double stiffness = dot(T, s);
  if (link == 0 || !(stiffness > 0)) return;
  SpatialBlock block{};
  add_to_block((math::Mat3::identity() - outer(s, s) * (1 / dot(s, s))) * (0.25 * h * h * stiffness), 3, 3, block);
  ldl.add_diagonal(link - 1, block);
}

// of the link's own weight and inertia at its centre of mass, and of the multipliers: light links between heavy ones
// are strings
void add_pulls(const Model& model, const PenaltyModel& body, const Workspace& ws, double h,
               PenaltyWorkspace& pws) noexcept {
  for (std::size_t link = 1; link < model.links.size(); ++link) {
    if (!(model.links[link].mass > 0)) continue;
    const double* udot = pws.end_udot.data() + kLinkSpeeds * (link - 1);
    const LinkMotion& m = ws.motion[link];
    const Vec3 c = m.R * model.links[link].h_L * (1 / model.links[link].mass);
    const Vec3 a = Vec3(udot[0], udot[1], udot[2]) + cross({udot[3], udot[4], udot[5]}, c) + cross(m.w, cross(m.w, c));
    add_pull(static_cast<int>(link), c, (model.gravity - a) * model.links[link].mass, h, pws.ldl);
  }
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    const Constraint& constraint = body.constraints[i];
    Vec3 T;
    for (std::size_t row = at(body.first_row[i]); row < at(body.first_row[i + 1]); ++row) {
      T += pws.rows[row].G.v2 * pws.multipliers[row];
    }
    // both pulled at the point of frame 2
    const LinkMotion& link2 = ws.motion[at(constraint.link2)];
    const Vec3 s2 = link2.R * constraint.p_L2;
    add_pull(constraint.link1, link2.p + s2 - ws.motion[at(constraint.link1)].p, T, h, pws.ldl);
    add_pull(constraint.link2, s2, -T, h, pws.ldl);
  }
}

}  // namespace

bool factorize(const Model& model, const PenaltyModel& body, const Workspace& ws, PenaltyWorkspace& pws,
               double h) noexcept {
  pws.ldl.clear();
  add_masses(model, ws, pws.ldl);
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    const Constraint& constraint = body.constraints[i];
    RowBlocks blocks;
    for (std::size_t row = at(body.first_row[i]); row < at(body.first_row[i + 1]); ++row) {
      pws.factored[row] = pws.rows[row].G;
      blocks.add(pws.factored[row], body.alpha[row]);
    }
    blocks.put(constraint.link1, constraint.link2, pws.ldl);
  }
  if (h > 0) {
    add_elements(model, ws, h, pws.ldl);
    add_pulls(model, body, ws, h, pws);
  }
  return pws.ldl.factorize(0);  // there are no closing nodes
}

}  // namespace slew::multibody
