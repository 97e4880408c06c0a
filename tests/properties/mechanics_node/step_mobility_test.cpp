// SPDX-License-Identifier: Apache-2.0
// A second mass on a spring behind the port of a mechanism: its part in the published mobility.
//
//   oil spring K, lambda -- port -- m1 -- k_s -- m2,   omega = sqrt(K / m1),   Omega = omega H,   d = 2 zeta omega m1
//   on m1
//
// The mechanics is the subsystem of the nodes; the oil is level two in exact steps of its own, with the mobility that
// the mechanics publishes, or with that of the instant in its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/formulations/dynamics.h"
#include "scene/scene.h"

namespace slew::mechanics_node {
namespace step_mobility_test {

constexpr double kOmega = 100, kMass = 2, kOil = kMass * kOmega * kOmega;  // rad/s, kg, N/m
constexpr double kZeta = 0.01;
constexpr double kStart = 2;          // m, of the port at rest
constexpr double kStartSpeed = 1e-8;  // m/s, of m1: far from the port's length however it grows below kGrown
constexpr double kGrown = 1e6;        // of the first amplitude

struct Case {
  double m2 = 10, spring = 10;  // of m1 and of K
  double lambda = 0.1;          // of omega
};

scene::Scene scene_of(const Case& of, double H) {
  scene::Scene scene;
  scene.session.step = H;
  multibody::MechanicsDef& def = scene.mechanics;
  def.gravity = {};
  // 0.3 rad of what moves m1 against m2 with m2 held, a fifth of it of what moves both
  def.max_substep = 0.3 / std::sqrt(of.spring * kOil / kMass * (1 + 1 / of.m2));
  def.bodies = {{.name = "M1", .position = {kStart, 0, 0}, .mass = kMass, .inertia = {1, 1, 1}},
                {.name = "M2", .position = {kStart + 1, 0, 0}, .mass = of.m2 * kMass, .inertia = {1, 1, 1}}};
  const Triple along = {0, M_PI / 2, 0};  // z of the joints along x
  for (const char* name : {"M1", "M2"}) {
    const double x = std::string(name) == "M1" ? kStart : kStart + 1;
    def.joints.push_back({.name = std::string("Slide") + name,
                          .type = multibody::JointType::prismatic,
                          .body1 = "Ground",
                          .point1 = {x, 0, 0},
                          .orientation1 = along,
                          .body2 = name,
                          .orientation2 = along});
  }
  def.translational_forces = {
      {.name = "Rod", .body1 = "M1", .body2 = "Ground", .damping_constant = 2 * kZeta * kOmega * kMass},
      {.name = "Spring", .body1 = "M2", .body2 = "M1", .spring_constant = of.spring * kOil, .free_length = 1}};
  scene::PortDef port;
  port.name = "Cylinder";
  port.force = "Rod";
  port.line_force.stroke_max = 10;
  scene.ports = {port};
  return scene;
}

enum class Mobility { published, of_the_instant };

class Coupled {
 public:
  Coupled(const Case& of, double Omega, Mobility mobility)
      : case_(of), H_(Omega / kOmega), mobility_(mobility), scene_(scene_of(of, H_)), mechanics_(scene_) {
    multibody::State& start = mechanics_.mutable_state();
    start.u[0] = kStartSpeed;
    EXPECT_TRUE(mechanics_.first_sample(sample_));
    actuators_.F = actuators_.F_dot = actuators_.D = actuators_.friction_scale = one(0);
    oil_ = {0, sample_.mechanism.x[0], sample_.mechanism.v[0]};
    publish_oil();
    EXPECT_TRUE(mechanics_.start({nullptr, &actuators_}, sample_).is_ok());
  }

  void step() {
    coupling::OwnSample next;
    const coupling::MechanismSample now = sample_.mechanism;
    const StepReport report = mechanics_.step(n_++, {nullptr, &actuators_}, {}, next);
    EXPECT_FALSE(report.has(StepFlag::not_converged));
    double a_free = now.a_free[0], W = now.W[0];
    if (mobility_ == Mobility::of_the_instant) W = 1 / kMass, a_free = a_free_now_;
    move_oil(now.x[0], now.v[0], a_free, W);
    sample_ = next;
    publish_oil();
  }

  // of all that swings [N s/sqrt(kg)]
  [[nodiscard]] double amplitude() const {
    const multibody::State& s = mechanics_.state();
    const double F = oil_[0] - kOil * (sample_.mechanism.x[0] - oil_[1]);
    const double stretch = s.q[1] - s.q[0];
    return std::sqrt(kMass * (s.u[0] * s.u[0] + case_.m2 * s.u[1] * s.u[1]) + case_.spring * kOil * stretch * stretch +
                     F * F / kOil);
  }

  [[nodiscard]] const coupling::MechanismSample& sample() const { return sample_.mechanism; }

 private:
  static coupling::PortArray one(double value) {
    coupling::PortArray array;
    array.push_back(value);
    return array;
  }

  void publish_oil() {
    const double lambda = case_.lambda * kOmega;
    actuators_.F = one(oil_[0]);
    actuators_.F_dot = one(-kOil * oil_[2] - lambda * oil_[0]);
    actuators_.K = one(kOil);
    actuators_.lambda = one(lambda);
    actuators_.x_ref = one(oil_[1]);
    actuators_.v_ref = one(oil_[2]);
    multibody::Workspace ws(mechanics_.model());
    multibody::evaluate(mechanics_.model(), mechanics_.state(), ws);
    a_free_now_ = multibody::row_free_accelerations(ws)[0];
  }

  // F' = -K v - lambda F, v' = a_free + W F, by Runge-Kutta in steps far below their periods
  void move_oil(double x, double v, double a_free, double W) {
    oil_ = {oil_[0] - kOil * (x - oil_[1]), x, v};
    const double lambda = case_.lambda * kOmega;
    const auto rate = [&](const std::array<double, 3>& y) {
      return std::array<double, 3>{-kOil * y[2] - lambda * y[0], y[2], a_free + W * y[0]};
    };
    const int steps = static_cast<int>(std::ceil(H_ * (10 * kOmega + 5 * lambda))) + 1;
    const double h = H_ / steps;
    const auto moved = [](std::array<double, 3> y, double by, const std::array<double, 3>& k) {
      for (std::size_t i = 0; i < 3; ++i) y[i] += by * k[i];
      return y;
    };
    for (int i = 0; i < steps; ++i) {
      const auto k1 = rate(oil_), k2 = rate(moved(oil_, h / 2, k1)), k3 = rate(moved(oil_, h / 2, k2)),
                 k4 = rate(moved(oil_, h, k3));
      for (std::size_t j = 0; j < 3; ++j) oil_[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
  }

  Case case_;
  double H_;
  Mobility mobility_;
  scene::Scene scene_;
  MechanicsSubsystem mechanics_;
  coupling::OwnSample sample_;
  coupling::ActuatorSample actuators_;
  std::array<double, 3> oil_{};  // F, x, v
  double a_free_now_ = 0;
  StepIndex n_ = 0;
};

// growth of the amplitude per exchange over the second half of a run
double growth(const Case& of, double Omega, Mobility mobility, int exchanges = 160) {
  Coupled pair(of, Omega, mobility);
  double early = 0, late = 0;
  for (int i = 0; i < exchanges; ++i) {
    pair.step();
    (2 * i < exchanges ? early : late) = std::max(2 * i < exchanges ? early : late, pair.amplitude());
    if (!(pair.amplitude() < kGrown * std::sqrt(kMass) * kStartSpeed)) return 2;
  }
  return std::pow(late / early, 2.0 / exchanges);
}

constexpr Case kCases[] = {{10, 10, 0.1}, {10, 100, 0.1}, {100, 1000, 0.1}, {10, 10, 1},
                           {10, 100, 1},  {100, 1000, 1}, {10, 10, 10},     {10, 100, 10}};

class StepMobilityOf : public ::testing::TestWithParam<Case> {};

TEST_P(StepMobilityOf, HasNoLimitWithAMassOnASpringBehindThePort) {
  for (const double Omega : {1.5, 3.3, 8.0, 20.0, 50.0}) {
    EXPECT_LT(growth(GetParam(), Omega, Mobility::published), 1.0005) << "Omega " << Omega;
  }
}

TEST_P(StepMobilityOf, IsNeededThere) {
  double worst = 0;
  for (const double Omega : {2.0, 5.0, 15.0, 30.0}) {
    worst = std::max(worst, growth(GetParam(), Omega, Mobility::of_the_instant));
  }
  EXPECT_GT(worst, 1.1);
}

INSTANTIATE_TEST_SUITE_P(, StepMobilityOf, ::testing::ValuesIn(kCases), [](const auto& tested) {
  std::ostringstream name;
  name << "m2_" << tested.param.m2 << "_spring_" << tested.param.spring << "_lambda_"
       << (tested.param.lambda < 1   ? "below_1"
           : tested.param.lambda > 1 ? "above_1"
                                     : "1");
  return name.str();
});

TEST(StepMobility, IsTheInstantsWhereTheSpringIsSlow) {
  const Case slow{10, 0.01, 0.1};
  const Coupled pair(slow, 0.5, Mobility::published);
  EXPECT_EQ(pair.sample().W_kind, coupling::MobilityKind::instant);
  EXPECT_DOUBLE_EQ(pair.sample().W[0], 1 / kMass);
}

TEST(StepMobility, IsThatOfBothMassesWhereTheSpringIsFast) {
  const Case fast{10, 1e5, 0.1};
  const Coupled pair(fast, 0.5, Mobility::published);
  EXPECT_EQ(pair.sample().W_kind, coupling::MobilityKind::step);
  EXPECT_NEAR(pair.sample().W[0], 1 / (11 * kMass), 1e-3 / kMass);
}

}  // namespace step_mobility_test
}  // namespace slew::mechanics_node
