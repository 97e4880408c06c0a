// SPDX-License-Identifier: Apache-2.0
#include "coupling/indicator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace slew::coupling {
namespace indicator_test {

const PortLevels kTwo(Level::two, {{"Port"}});

struct Pair {
  MechanismSample mechanism;
  ActuatorSample actuators;
};

Pair one_port() {
  Pair pair;
  resize(pair.mechanism, 1);
  resize(pair.actuators, 1);
  pair.actuators.F[0] = 1e5;
  pair.actuators.K[0] = 1e8;
  pair.mechanism.F_used[0] = 1e5;
  pair.mechanism.W[0] = 1e-3;
  return pair;
}

TEST(Indicator, PerfectAgreementIsGreen) {
  Indicator indicator(1, milliseconds(1));
  Pair pair = one_port();
  pair.mechanism.work[0] = pair.actuators.work[0] = 1.0;
  for (int i = 0; i < 2000; ++i) indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
  EXPECT_EQ(indicator.port(0).eta, 0.0);
  EXPECT_EQ(lamp_of(indicator.port(0)), Lamp::green);
}

TEST(Indicator, VolumeCorrectionIsNotAnError) {
  // hydraulics behind by e_x: its work differs by F e_x - K e_x^2 / 2, which the correction gives back
  Indicator indicator(1, milliseconds(1));
  Pair pair = one_port();
  const double e_x = 1e-5;
  pair.mechanism.x[0] = e_x;
  pair.mechanism.F_used[0] = 1e5 - 1e8 * e_x;
  pair.mechanism.work[0] = 10;
  pair.actuators.work[0] = 10 - (1e5 * e_x - 0.5 * 1e8 * e_x * e_x);
  indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
  EXPECT_NEAR(indicator.port(0).e_x, e_x, 1e-18);
  EXPECT_NEAR(indicator.port(0).e_F, 0, 1e-9);
  EXPECT_NEAR(indicator.port(0).dE_star, 0, 1e-12);
}

TEST(Indicator, EnergyThatTheCouplingCreatesRaisesTheAlarmAfterItsTime) {
  Indicator indicator(1, milliseconds(1));
  Pair pair = one_port();
  pair.mechanism.work[0] = 10;
  pair.actuators.work[0] = 10 - 0.5;
  int steps = 0;
  while (!indicator.creates_energy() && steps < 1000) {
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    ++steps;
  }
  EXPECT_EQ(steps, 200);
  EXPECT_EQ(lamp_of(indicator.port(0)), Lamp::red);
}

TEST(Indicator, OneJumpHoweverLargeIsNoDivergence) {
  Indicator indicator(1, milliseconds(5));
  Pair pair = one_port();
  for (int i = 0; i < 600; ++i) {
    pair.mechanism.work[0] = 1;
    pair.actuators.work[0] = i == 300 ? -500 : 1;
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    ASSERT_FALSE(indicator.diverges(0)) << i;
  }
}

TEST(Indicator, DisagreementInHalfOfTheLastSecondIsDivergenceOfEitherSign) {
  for (const double sign : {-1.0, 1.0}) {
    Indicator indicator(1, milliseconds(1));
    Pair pair = one_port();
    pair.mechanism.work[0] = 10;
    int steps = 0;
    while (!indicator.diverges(0) && steps < 2000) {
      pair.actuators.work[0] = 10 + 2 * sign;
      indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
      ++steps;
    }
    EXPECT_EQ(steps, 501);  // ten full buckets, seen when the next one begins
  }
}

TEST(Indicator, DisagreementBeyondAllThatThePortDidIsDivergenceAtOnce) {
  Indicator indicator(1, milliseconds(5));
  Pair pair = one_port();
  int steps = 0;
  for (; steps < 20 && !indicator.diverges(0); ++steps) {
    pair.actuators.work[0] = steps % 2 == 0 ? 30 : -30;  // F^2/2K is 50 J
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
  }
  EXPECT_EQ(steps, 7);
}

// 500 kg that are pushed from rest: the port's force and work are next to nothing, its motion is not
TEST(Indicator, APortWithoutForceThatBeginsToMoveDoesNotDiverge) {
  for (const double W : {1.0 / 500, 0.0}) {
    Indicator indicator(1, milliseconds(1));
    Pair pair = one_port();
    pair.actuators.F[0] = pair.mechanism.F_used[0] = 0;
    pair.mechanism.W[0] = W;
    for (int i = 0; i < 300; ++i) indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    pair.mechanism.v[0] = 2.6e-3;
    pair.actuators.work[0] = 1e-6;  // of 1.7e-3 J
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    EXPECT_GT(indicator.own_residual(0), 100);
    EXPECT_FALSE(indicator.diverges(0)) << W;
    // as much as the motion's own energy is no rounding
    pair.actuators.work[0] = 1e-2;
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    EXPECT_EQ(indicator.diverges(0), W > 0);
  }
}

// K = 1e7 N/m, 1500 kg at 0.1 m/s: of their 7.5 J half at least is in the motion or in the largest force so far
TEST(Indicator, ALampOfTheFirstStepsHasTheScaleOfTheWholeSwing) {
  for (const PortLevel level : {PortLevel::tlm, PortLevel::hold}) {
    const PortLevels levels(Level::two, {{"Port", level}});
    Indicator indicator(1, milliseconds(1));
    Pair pair = one_port();
    pair.mechanism.W[0] = 1.0 / 1500;
    const double omega = std::sqrt(1e7 / 1500), H = 1e-3;
    double most = 0;
    for (int i = 1; i <= 40; ++i) {
      pair.actuators.F[0] = pair.mechanism.F_used[0] = -1e7 * 0.1 / omega * std::sin(omega * i * H);
      pair.mechanism.v[0] = 0.1 * std::cos(omega * i * H);
      pair.actuators.work[0] = 0.01;
      indicator.update(pair.mechanism, pair.actuators, PortArray{1e7}, levels);
      most = std::max(most, indicator.port(0).eta / i);
    }
    EXPECT_GE(most, 0.01 / 7.5);
    EXPECT_LE(most, 0.01 / 3.7);
  }
}

TEST(Indicator, ASwingThatGrowsTenfoldInEveryBucketIsDivergence) {
  Indicator indicator(1, milliseconds(5));
  Pair pair = one_port();
  double force = 1e3;
  int buckets = 0;
  for (; buckets < 20 && !indicator.diverges(0); ++buckets, force *= 10) {
    for (int i = 0; i < 10; ++i) {
      pair.actuators.F[0] = pair.mechanism.F_used[0] = force;
      pair.actuators.work[0] = (i % 2 == 0 ? 0.05 : -0.05) * force * force / 1e8;
      indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    }
  }
  EXPECT_LE(buckets, 11);
}

TEST(Indicator, CouplingFrequencyUsesTheFullMobility) {
  PortMatrix W;
  for (const double w : {3e-5, -2.9e-5, -2.9e-5, 3e-5}) W.push_back(w);
  const PortArray K{1.5e8, 1.5e8};
  // eigenvalues of W K: 5.9e-5 K and 0.1e-5 K
  EXPECT_NEAR(coupling_frequency(W, K, 1e-3), 1e-3 * std::sqrt(5.9e-5 * 1.5e8), 2e-3 * 0.094);
}

TEST(Indicator, CouplingFrequencySeesEveryPartOfTheMachine) {
  // two boom ports and one that does not touch them, with the largest entry of its own
  PortMatrix W;
  for (const double w : {3e-5, -2.9e-5, 0.0, -2.9e-5, 3e-5, 0.0, 0.0, 0.0, 3.2e-5}) W.push_back(w);
  const PortArray K{1.5e8, 1.5e8, 1.5e8};
  EXPECT_NEAR(coupling_frequency(W, K, 1e-3), 1e-3 * std::sqrt(5.9e-5 * 1.5e8), 1e-6);
  // and the other way round
  W[8] = 7e-5;
  EXPECT_NEAR(coupling_frequency(W, K, 1e-3), 1e-3 * std::sqrt(7e-5 * 1.5e8), 1e-6);
}

TEST(Indicator, CouplingFrequencyHasTwoDigitsWhateverTheSecondEigenvalue) {
  // two ports whose matrix has the eigenvalues 1 and `second`, turned by 0.3 rad
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (const double second : {0.0, 0.5, 0.9, 0.95, 0.99, 1.0}) {
    PortMatrix W;
    for (const double w :
         {c * c + second * s * s, c * s * (1 - second), c * s * (1 - second), s * s + second * c * c}) {
      W.push_back(w);
    }
    EXPECT_NEAR(coupling_frequency(W, PortArray{1.0, 1.0}, 1), 1, 5e-3) << second;
  }
  PortMatrix nothing;
  for (int i = 0; i < 4; ++i) nothing.push_back(0);
  EXPECT_EQ(coupling_frequency(nothing, PortArray{1.0, 1.0}, 1), 0);
}

TEST(Indicator, CouplingFrequencyUsesTheStiffnessBetweenPorts) {
  // one volume, areas 1 and s, K = k [1 s; s s^2]
  const double k = 1.5e8, w = 3e-5;
  for (const double s : {1.0, -1.0, 0.5}) {
    const PortArray K{k, k * s * s};
    PortMatrix between, alone, together;
    for (const double x : {0.0, k * s, k * s, 0.0}) between.push_back(x);
    for (const double x : {w, 0.0, 0.0, w}) alone.push_back(x);
    for (const double x : {w, w, w, w}) together.push_back(x);
    EXPECT_NEAR(coupling_frequency(alone, K, 1e-3, between), 1e-3 * std::sqrt(k * w * (1 + s * s)), 1e-9) << s;
    // the areas add where the ports move together: no oil is compressed with s = -1
    EXPECT_NEAR(coupling_frequency(together, K, 1e-3, between), 1e-3 * std::sqrt(k * w) * (1 + s), 1e-9) << s;
  }
}

TEST(Indicator, AnIdlePortIsGreen) {
  // an actuator that carries nothing: forces and energies of rounding
  Indicator indicator(1, milliseconds(1));
  Pair pair = one_port();
  pair.actuators.F[0] = 1e-11;
  pair.mechanism.F_used[0] = 1.1e-11;
  pair.actuators.work[0] = 3e-31;
  for (int i = 0; i < 2000; ++i) indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
  EXPECT_EQ(lamp_of(indicator.port(0)), Lamp::green);
}

TEST(Indicator, ForgetsAnErrorAfterItsWindow) {
  for (const double step : {1e-3, 5e-3, 20e-3}) {
    const SimDuration H = milliseconds(static_cast<std::int64_t>(step * 1e3));
    Indicator indicator(1, H);
    Pair pair = one_port();
    pair.mechanism.work[0] = 10;
    pair.actuators.work[0] = 10 + 0.5;
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
    pair.actuators.work[0] = 10;
    int steps = 1;
    while (indicator.own_residual(0) > 0 && steps < 100000) {
      indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
      ++steps;
    }
    // the step that forgets it begins the bucket after its window
    const double window = (steps - 1) * step;
    EXPECT_GE(window, 1.0 - 1e-9) << step;
    EXPECT_LE(window, 1.2 + 1e-9) << step;
  }
}

// A heavy port and one with a hundredth of its force and work; the light one's sides differ by 1e-3 of its own work.
TEST(Indicator, ALightPortIsJudgedByTheMachineAndAHeldOneByItself) {
  for (const PortLevel level : {PortLevel::two, PortLevel::hold}) {
    const PortLevels levels(Level::two, {{"Heavy"}, {"Light", level}});
    Indicator indicator(2, milliseconds(1));
    MechanismSample mechanism;
    ActuatorSample actuators;
    resize(mechanism, 2);
    resize(actuators, 2);
    const PortArray stiffness{1e8, 1e8};
    actuators.F[0] = mechanism.F_used[0] = 1e5, actuators.F[1] = mechanism.F_used[1] = 1e3;
    actuators.K = stiffness;
    mechanism.work[0] = actuators.work[0] = 10, mechanism.work[1] = 0.1, actuators.work[1] = 0.1001;
    for (int i = 0; i < 2000; ++i) indicator.update(mechanism, actuators, stiffness, levels);
    EXPECT_NEAR(indicator.own_residual(1), 1e-3, 1e-9);
    // of 20 buckets 17 count
    EXPECT_NEAR(indicator.port(1).eta, level == PortLevel::two ? 1e-5 * 17 / 20 : 1e-3,
                level == PortLevel::two ? 1e-6 : 1e-9);
    EXPECT_EQ(lamp_of(indicator.port(1)), level == PortLevel::two ? Lamp::green : Lamp::amber);
  }
}

TEST(Indicator, ThreeJumpsInASecondLeaveTheLampAndFourDoNot) {
  for (const int jumps : {3, 4}) {
    Indicator indicator(1, milliseconds(1));
    Pair pair = one_port();
    pair.mechanism.work[0] = 1;
    double most = 0;
    for (int i = 0; i < 3000; ++i) {
      const bool is_jump = i >= 1000 && i < 2000 && i % 150 == 0 && i < 1000 + 150 * jumps;
      pair.actuators.work[0] = is_jump ? 101 : 1;
      indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
      most = std::max(most, indicator.port(0).eta);
    }
    EXPECT_NEAR(most, jumps == 3 ? 0 : 0.1, 0.01) << jumps;
  }
}

TEST(Indicator, OfNoNumberIsRed) {
  Indicator indicator(1, milliseconds(1));
  Pair pair = one_port();
  pair.actuators.work[0] = std::nan("");
  indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
  EXPECT_EQ(lamp_of(indicator.port(0)), Lamp::red);
}

TEST(Indicator, GoesOnFromItsSavedStateWithTheSameNumbers) {
  Indicator first(1, milliseconds(5)), second(1, milliseconds(5));
  Pair pair = one_port();
  const auto update = [&](Indicator& indicator, int i) {
    pair.mechanism.work[0] = 1;
    pair.actuators.work[0] = 1 + 0.01 * ((i * 7919) % 13);
    indicator.update(pair.mechanism, pair.actuators, pair.actuators.K, kTwo);
  };
  for (int i = 0; i < 333; ++i) update(first, i);
  std::vector<std::byte> bytes;
  const StateFormat format{};
  StateWriter writer(bytes, format);
  first.save(writer);
  writer.finish();
  StateReader reader(bytes, format);
  second.load(reader);
  for (int i = 333; i < 700; ++i) {
    update(first, i);
    update(second, i);
    ASSERT_EQ(first.port(0).eta, second.port(0).eta) << i;
  }
}

}  // namespace indicator_test
}  // namespace slew::coupling
