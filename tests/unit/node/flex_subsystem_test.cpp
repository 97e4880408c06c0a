// SPDX-License-Identifier: Apache-2.0
// The flex node's subsystem alone: elastic forces, strain energy, deflection and stress of given modal coordinates.
#include "flex_node/flex_subsystem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <string>

#include "build_paths.h"
#include "flex/recovery.h"

namespace slew::flex_node {
namespace flex_subsystem_test {

class Flex : public ::testing::Test {
 protected:
  static scene::Scene load(const scene::Overrides& overrides = {}) {
    return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane_flexible.yaml", overrides);
  }
  // tip bent down and aside, moving
  static coupling::FlexibleSample bent() {
    coupling::FlexibleSample sample;
    for (const double q : {-0.35, 0.12}) sample.q.push_back(q);
    for (const double u : {0.5, -1.5}) sample.u.push_back(u);
    for (int i = 0; i < 13; ++i) sample.frame.push_back(0);
    return sample;
  }
  static coupling::OwnSample see(FlexSubsystem& flex, const coupling::FlexibleSample& sample) {
    coupling::PartnerSamples partners;
    partners.flexible = &sample;
    coupling::OwnSample own;
    const Status status = flex.start(partners, own);
    EXPECT_TRUE(status.is_ok()) << status.text;
    return own;
  }
  static std::map<std::string, double> values(const FlexSubsystem& flex) {
    std::vector<double> read(flex.variables().size());
    flex.read_variables(read);
    std::map<std::string, double> named;
    for (std::size_t i = 0; i < read.size(); ++i) named[flex.variables()[i].name] = read[i];
    return named;
  }
};

TEST_F(Flex, StatesALinearLawOnceAboutTheUndeformedBody) {
  const scene::Scene scene = load();
  FlexSubsystem flex(scene);
  const coupling::ElasticSample sample = see(flex, bent()).elastic;
  EXPECT_TRUE(sample.is_constant);
  const flex::ReducedBody& body = scene.flexible_bodies[0].reduction->body;
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(sample.Q[k], 0);
    EXPECT_EQ(sample.q_ref[k], 0);
    EXPECT_EQ(sample.K[3 * k], body.K[3 * k]);
    EXPECT_DOUBLE_EQ(sample.D[3 * k], 2 * 0.005 * body.omega[k]);
  }
}

TEST_F(Flex, LinearisesAgainAboutTheMechanicsCoordinates) {
  const scene::Scene scene = load({"session.flexible=every_step"});
  FlexSubsystem flex(scene);
  const coupling::FlexibleSample at = bent();
  const coupling::ElasticSample sample = see(flex, at).elastic;
  EXPECT_FALSE(sample.is_constant);
  for (std::size_t k = 0; k < 2; ++k) {
    const double omega = scene.flexible_bodies[0].reduction->body.omega[k];
    const double force = -omega * omega * at.q[k] - 2 * 0.005 * omega * at.u[k];
    EXPECT_NEAR(sample.Q[k], force, 1e-12 * std::fabs(force));
    EXPECT_EQ(sample.q_ref[k], at.q[k]);
    EXPECT_EQ(sample.u_ref[k], at.u[k]);
  }
}

// the trapezoidal rule of the modes alone: what the mechanics would make of a free mode, and back
TEST_F(Flex, KeepsCondensedCoordinatesByTheTrapezoidalRule) {
  const scene::Scene scene =
      load({"session.flexible=condensed", "mechanics.integrator=trapezoidal", "mechanics.max_substep=1 ms"});
  FlexSubsystem flex(scene);
  coupling::FlexibleSample at = bent();
  coupling::OwnSample own = see(flex, at);
  double energy[2] = {};
  const auto energy_of = [&](std::size_t k) {
    const double omega = scene.flexible_bodies[0].reduction->body.omega[k];
    const coupling::ElasticSample& s = own.elastic;
    return 0.5 * s.u_ref[k] * s.u_ref[k] + 0.5 * omega * omega * s.q_ref[k] * s.q_ref[k];
  };
  for (std::size_t k = 0; k < 2; ++k) energy[k] = energy_of(k);
  const int steps = 1000;
  for (int n = 0; n < steps; ++n) {
    // free modes, M u' = Q
    for (std::size_t k = 0; k < 2; ++k) at.u[k] = own.elastic.u_ref[k] + 1e-3 * own.elastic.Q[k] / own.elastic.M[3 * k];
    coupling::PartnerSamples partners;
    partners.flexible = &at;
    static_cast<void>(flex.step(n, partners, {}, own));
  }
  // the rule keeps energy; what is lost is the damping's, exp(-2 zeta omega t)
  for (std::size_t k = 0; k < 2; ++k) {
    const double omega = scene.flexible_bodies[0].reduction->body.omega[k];
    EXPECT_NEAR(energy_of(k) / energy[k], std::exp(-2 * 0.005 * omega * 1e-3 * steps), 0.02) << k;
  }
}

TEST_F(Flex, CondensedGoesWithOneTrapezoidalStep) {
  const auto refusal = [](const scene::Overrides& overrides) -> std::string {
    try {
      static_cast<void>(load(overrides));
    } catch (const scene::LoadError& error) {
      return error.what();
    }
    return "";
  };
  const std::string rule = refusal({"session.flexible=condensed", "mechanics.max_substep=1 ms"});
  EXPECT_NE(rule.find("'condensed' requires the trapezoidal integrator"), std::string::npos) << rule;
  const std::string parts =
      refusal({"session.flexible=condensed", "mechanics.integrator=trapezoidal", "mechanics.max_substep=0.4 ms"});
  EXPECT_NE(parts.find("'condensed' requires one sub-step, the mechanics has 3"), std::string::npos) << parts;
}

TEST_F(Flex, AnExchangeWithoutModesIsWarnedOf) {
  const auto warnings = [](const char* modes) {
    const scene::Scene scene = load({"session.flexible=every_step", std::string("Truck_JibBoom.flex_modes=") + modes});
    return std::count_if(scene.warnings.begin(), scene.warnings.end(), [](const std::string& warning) {
      return warning.find("it has no effect: no body of the scene keeps modes") != std::string::npos;
    });
  };
  EXPECT_EQ(warnings("none"), 1);
  EXPECT_EQ(warnings("\"1;2\""), 0);
}

TEST_F(Flex, RecoversEnergyDeflectionAndStress) {
  const scene::Scene scene = load();
  FlexSubsystem flex(scene);
  const coupling::FlexibleSample at = bent();
  const coupling::OwnSample own = see(flex, at);
  const flex::Reduction& model = *scene.flexible_bodies[0].reduction;
  std::map<std::string, double> value = values(flex);
  double energy = 0;
  for (std::size_t k = 0; k < 2; ++k) energy += 0.5 * model.body.omega[k] * model.body.omega[k] * at.q[k] * at.q[k];
  EXPECT_NEAR(value["Truck_JibBoom.strain_energy"], energy, 1e-12 * energy);
  EXPECT_EQ(own.elastic.strain_energy[0], value["Truck_JibBoom.strain_energy"]);
  EXPECT_EQ(value["Truck_JibBoom.Node1.deflection.y"], 0);
  for (const flex::ReducedNode& node : model.body.nodes) {
    const std::string name = "Truck_JibBoom.Node" + std::to_string(node.id) + ".deflection.z";
    EXPECT_DOUBLE_EQ(value[name], node.phi[0][2] * at.q[0] + node.phi[1][2] * at.q[1]);
  }
  // a beam that is bent like its first mode is stressed most where it is held: M y / I of the tip force that bends it
  // so
  double worst = 0;
  for (const auto& [name, one] : value) {
    if (name.ends_with("normal_stress")) worst = std::max(worst, std::fabs(one));
  }
  EXPECT_EQ(value["Truck_JibBoom.largest_stress_element"], 1);
  EXPECT_NEAR(value["Truck_JibBoom.largest_stress"], worst, 1e-3 * worst);
  const math::Vec3 tip = flex::deflection(model.body.nodes.back(), at.q.span());
  // the first mode of a cantilever has the curvature (b L)^2 / L^2 w(L) at its root, (b L)^2 = 3.516; the corner, 0.15
  // m off in both planes, has the sum of both
  const double sum = 2e11 * 0.15 * 3.516 / (6.5 * 6.5) * (std::fabs(tip[1]) + std::fabs(tip[2]));
  EXPECT_NEAR(value["Truck_JibBoom.largest_stress"], sum, 0.01 * sum);
}

TEST_F(Flex, StressOfEveryPointIsADetail) {
  const scene::Scene scene = load();
  const FlexSubsystem flex(scene);
  for (const ElementVariable& variable : flex.variables()) {
    EXPECT_EQ(variable.is_detail, variable.name.find(".Element") != std::string::npos) << variable.name;
  }
}

TEST_F(Flex, ItsHashIsThatOfEveryBit) {
  const scene::Scene scene = load();
  FlexSubsystem flex(scene);
  coupling::FlexibleSample at = bent();
  static_cast<void>(see(flex, at));
  const std::uint64_t before = flex.state_hash();
  for (coupling::ModeArray* values : {&at.q, &at.u}) {
    for (double& value : *values) {
      const double kept = value;
      value = std::nextafter(value, 10);
      static_cast<void>(see(flex, at));
      EXPECT_NE(flex.state_hash(), before);
      value = kept;
    }
  }
  static_cast<void>(see(flex, at));
  EXPECT_EQ(flex.state_hash(), before);
}

TEST_F(Flex, RefusesAMechanicsWithOtherModes) {
  const scene::Scene scene = load();
  FlexSubsystem flex(scene);
  coupling::FlexibleSample at = bent();
  at.q.push_back(0);
  coupling::PartnerSamples partners;
  partners.flexible = &at;
  coupling::OwnSample own;
  const Status status = flex.start(partners, own);
  EXPECT_EQ(
      status.text,
      "mechanics states 3 modal coordinates, the flexible bodies have 2: the nodes run different scenes; start them "
      "with the same one");
}

TEST_F(Flex, LeavesOutBodiesWithFrozenModes) {
  const scene::Scene scene = load({"Truck_JibBoom.flex_modes=none"});
  EXPECT_FALSE(scene.has_modes());
  EXPECT_TRUE(scene.flexible_bodies.empty());
}

}  // namespace flex_subsystem_test
}  // namespace slew::flex_node
