// SPDX-License-Identifier: Apache-2.0
// Force elements between two places of one flexible body, or between one place and a body at another: the frame of a
// body with free modes is a link of its own, which its joints close onto the nodes. Such an element couples nodes that
// no joint couples.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/properties/multibody/random_modes.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace inner_elements_test {

using namespace testing;
using slew::testing::for_each_seed;
using slew::testing::seeds;

enum class Kind { line, angle, bushing, beam, rope, cylinder };
constexpr Kind kKinds[] = {Kind::line, Kind::angle, Kind::bushing, Kind::beam, Kind::rope, Kind::cylinder};

// A beam B on a joint at its node 1, a body P on a joint at its node 12, and elements of a kind over the nodes 7 and 3:
// one within B, one from B to P.
class RandomBeam {
 public:
  RandomBeam(unsigned seed, bool is_free) : random_(seed) {
    std::vector<MassPoint> points;
    ModalBody modes = random_modes(random_, {0.2, 0.1, -0.3}, points);
    if (is_free) {
      modes.root = -1;
      for (std::vector<math::Vec3>* shape : {&modes.nodes[0].shift, &modes.nodes[0].turn}) {
        for (math::Vec3& v : *shape) v = vector(0.4);
      }
    }
    for (const ModalNode& node : modes.nodes) places_.push_back(node.position);
    def_.flexible_bodies.push_back({.body = "B",
                                    .modes = std::make_shared<ModalBody>(modes),
                                    .relative_damping = {0.02},
                                    .start = std::vector<double>(modes.modes())});
    def_.bodies = {{.name = "B", .type = BodyType::flexible},
                   {.name = "P",
                    .position = places_[3].array(),
                    .mass = 2,
                    .center_of_mass = vector(0.3).array(),
                    .inertia = {0.5, 0.6, 0.7}}};
    constexpr JointType kTypes[] = {JointType::revolute,  JointType::universal,   JointType::spherical,
                                    JointType::prismatic, JointType::cylindrical, JointType::fixed};
    const auto pick = [&] { return kTypes[random_() % 6]; };
    def_.joints = {{.name = "J",
                    .type = pick(),
                    .point1 = places_[0].array(),
                    .orientation1 = {number(3), 0, 0},
                    .body2 = "B",
                    .point2 = places_[0].array()},
                   {.name = "K", .type = pick(), .body1 = "B", .point1 = places_[3].array(), .body2 = "P"}};
    def_.joints[0].orientation2 = def_.joints[0].orientation1;
    for (JointDef& joint : def_.joints) {
      // its axes are at a right angle
      if (joint.type != JointType::universal) continue;
      joint.orientation2[0] += std::numbers::pi / 2;
    }
  }

  // stretch: of the ropes at the start [m]; all other elements are unloaded
  [[nodiscard]] MechanicsDef with(Kind kind, double stiffness, double stretch) const {
    MechanicsDef def = def_;
    add(kind, {"Inner", "B.Node3", places_[2] - places_[1]}, stiffness, def);
    add(kind, {"Outer", "P", places_[3] - places_[1]}, stiffness, def);
    const Mechanism at_start(def);
    for (TranslationalForceDef& line : def.translational_forces) {
      line.free_length = at_start.value(line.name + ".length");
    }
    for (RopeDef& rope : def.ropes) rope.free_length = at_start.value(rope.name + ".length") - stretch;
    return def;
  }

 private:
  // An element from node 7 to another body, whose origin is at `away` from the node at the start.
  struct Place {
    std::string name, other;
    math::Vec3 away;
  };

  double number(double size) { return std::uniform_real_distribution<double>(-size, size)(random_); }
  math::Vec3 vector(double size) { return {number(size), number(size), number(size)}; }

  static void add(Kind kind, const Place& place, double stiffness, MechanicsDef& def) {
    const double damping = 1e-2 * stiffness;
    const Triple all{stiffness, stiffness, stiffness}, damped{damping, damping, damping};
    switch (kind) {
      case Kind::line:
      case Kind::cylinder:
        def.translational_forces.push_back({.name = place.name, .body1 = "B.Node7", .body2 = place.other});
        def.translational_forces.back().spring_constant = stiffness;
        def.translational_forces.back().damping_constant = damping;
        if (kind == Kind::line) return;
        def.force_dummies.push_back({place.name + "_Tube", place.name, 1, 0.6, {-0.2, 0, 0}, {0.01, 0.1, 0.1}});
        def.force_dummies.push_back({place.name + "_Piston", place.name, 2, 0.4, {0.2, 0, 0}, {0.01, 0.1, 0.1}});
        return;
      case Kind::angle:
        def.rotational_forces.push_back({.name = place.name, .body1 = "B.Node7", .body2 = place.other});
        def.rotational_forces.back().damping_constant = damping;
        return;
      case Kind::bushing:
        def.bushings.push_back({.name = place.name,
                                .frames = {.body1 = "B.Node7", .body2 = place.other, .point2 = (-place.away).array()},
                                .stiffness = all,
                                .rotational_stiffness = all,
                                .damping = damped});
        return;
      case Kind::beam:
        def.beams.push_back(
            {.name = place.name,
             .frames = {.body1 = "B.Node7", .body2 = place.other, .point2 = (math::Vec3{1, 0, 0} - place.away).array()},
             .length = 1,
             .youngs_modulus = stiffness,
             .area = 1,
             .second_moment_y = 0.01,
             .second_moment_z = 0.01,
             .torsion_constant = 0.02,
             .damping_time = 1e-2});
        return;
      case Kind::rope:
        def.ropes.push_back({.name = place.name,
                             .bodies = {"Ground", "B.Node7", place.other},
                             .points = {{4, 3, 5}, {}, {}},
                             .free_length = 1,
                             .stiffness = stiffness,
                             // below what its spring carries, the limit of a rope's damper
                             .damping_constant = 1e-3 * damping});
        return;
    }
  }

  std::mt19937 random_;
  MechanicsDef def_;
  std::vector<math::Vec3> places_;  // of the nodes 1, 7, 3, 12
};

std::vector<double> state_after(MechanicsDef def, Formulation formulation, Integrator integrator, double h, int steps) {
  def.formulation = formulation;
  def.integrator = integrator;
  Formulated mechanism(def);
  for (int i = 0; i < steps; ++i) {
    EXPECT_TRUE(mechanism.try_run(h, h)) << "step " << i;
    EXPECT_EQ(mechanism.dynamics.parts(), 1) << "step " << i;
    if (::testing::Test::HasFailure()) break;
  }
  std::vector<double> all = mechanism.state.q;
  all.insert(all.end(), mechanism.state.u.begin(), mechanism.state.u.end());
  return all;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::fmax(largest, std::fabs(a[i] - b[i]));
  return largest;
}

class InnerElements : public ::testing::TestWithParam<std::tuple<bool, Kind>> {
 protected:
  template <typename Claim>
  static void for_each_beam(double stiffness, double stretch, Claim claim) {
    for_each_seed(seeds({{1, 24}}, 4), [&](unsigned seed) {
      claim(RandomBeam(seed, std::get<0>(GetParam())).with(std::get<1>(GetParam()), stiffness, stretch));
    });
  }
};

constexpr Integrator kImplicit[] = {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2};
constexpr Formulation kStaged[] = {Formulation::recursive, Formulation::lagrange};

// By halves of the step: the error of each implicit rule falls to a quarter, in no part of a step.
TEST_P(InnerElements, LeaveTheRulesTheirOrder) {
  for_each_beam(100, 0.1, [](const MechanicsDef& def) {
    const std::vector<double> exact = state_after(def, Formulation::recursive, Integrator::rk4, 2.5e-4, 80);
    for (const Formulation formulation : kStaged) {
      for (const Integrator rule : kImplicit) {
        SCOPED_TRACE(name_of(formulation) + " " + name_of(rule));
        const double coarse = difference(state_after(def, formulation, rule, 2e-3, 10), exact);
        const double fine = difference(state_after(def, formulation, rule, 1e-3, 20), exact);
        EXPECT_NEAR(std::log2(coarse / fine), 2, 0.35) << coarse << " and " << fine;
      }
    }
  });
}

constexpr int kMostCorrections = 3;  // of a stage

// Newton's matrix has the derivatives of an element that dominates: few corrections, not those of a wrong block.
TEST_P(InnerElements, StandInTheMatrixOfTheStage) {
  for_each_beam(1e7, 1e-4, [](MechanicsDef def) {
    for (const Formulation formulation : kStaged) {
      for (const Integrator rule : kImplicit) {
        SCOPED_TRACE(name_of(formulation) + " " + name_of(rule));
        def.formulation = formulation;
        def.integrator = rule;
        Formulated mechanism(def);
        EXPECT_TRUE(mechanism.try_run(1e-4, 1e-4));
        EXPECT_EQ(mechanism.dynamics.parts(), 1);
        EXPECT_LE(mechanism.dynamics.iterations(),
                  rule == Integrator::sdirk2 ? 2 * kMostCorrections : kMostCorrections);
      }
    }
  });
}

// The explicit rule of body coordinates has the same matrix without stiffness; cylinders couple the nodes by masses.
TEST_P(InnerElements, MoveTheSameInBodyCoordinates) {
  for_each_beam(100, 0.1, [](const MechanicsDef& def) {
    const std::vector<double> exact = state_after(def, Formulation::recursive, Integrator::rk4, 1e-4, 20);
    const std::vector<double> found = state_after(def, Formulation::lagrange, Integrator::rk4, 1e-4, 20);
    EXPECT_LT(difference(found, exact), 1e-8);
  });
}

std::string name_in(const ::testing::TestParamInfo<std::tuple<bool, Kind>>& tested) {
  constexpr const char* kNames[] = {"line", "angle", "bushing", "beam", "rope", "cylinder"};
  const auto [is_free, kind] = tested.param;
  return std::string(is_free ? "free_" : "clamped_") + kNames[static_cast<int>(kind)];
}

INSTANTIATE_TEST_SUITE_P(Of, InnerElements, ::testing::Combine(::testing::Bool(), ::testing::ValuesIn(kKinds)),
                         name_in);

}  // namespace inner_elements_test
}  // namespace slew::multibody
