// SPDX-License-Identifier: Apache-2.0
// Cases C06 and E03: the hydraulic crane with two degrees of freedom, as a monolith, in co-simulation, and in the
// coupling of the published benchmark code. Reference: crane2dof_scenario0.csv, an independent solution; tolerances of
// the case: stroke 1e-4 m, pressures 0.5 %.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "build_paths.h"
#include "hydraulics/circuit_integrator.h"
#include "tests/validation/coupling/coupled_run.h"
#include "tests/validation/multibody/csv_table.h"

namespace slew::coupling::test {
namespace two_dof_crane_test {

constexpr double kDuration = 10;            // s
constexpr double kStart = 0.5 - 0.442 / 2;  // m, element length at stroke zero
constexpr SimDuration kMillisecond = milliseconds(1);
const SimTime kEnd = {10'000'000'000};

scene::Scene load(const scene::Overrides& overrides = {}) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/two_dof_crane.yaml", overrides);
}

// Spool signal over time; the points of the scene's script.
double signal(double t) {
  if (t < 6) return 0.1 * std::clamp((t - 2) / 1e-3, 0.0, 1.0);
  return 0.1 - 0.3 * std::clamp((t - 6) / 2e-3, 0.0, 1.0);
}

// time, stroke, theta, p_1 (of port B), p_2 (of port A), force with the friction
enum Column { kTime, kS, kTheta1, kTheta2, kOmega1, kOmega2, kP1, kP2, kForce };

const std::vector<std::vector<double>>& table() {
  static const auto rows = multibody::testing::read_table("crane2dof_scenario0.csv");
  return rows;
}

struct Deviation {
  double s = 0;         // m, largest
  double pressure = 0;  // relative, largest
  void add(const std::vector<double>& row, double x, double p_A, double p_B) {
    s = std::max(s, std::fabs(x + kStart - row[kS]));
    pressure = std::max({pressure, std::fabs(p_B / row[kP1] - 1), std::fabs(p_A / row[kP2] - 1)});
  }
};

// The monolith at every millisecond, compared with the table on the way.
struct Reference {
  std::vector<double> s, F;  // m; N, pressure force less viscous friction
  Deviation deviation;
};

const Reference& reference() {
  static const Reference result = [] {
    const scene::Scene scene = load();
    monolith::Monolith monolith(scene);
    EXPECT_TRUE(monolith.start().is_ok());
    Reference run;
    std::size_t row = 0;
    for (SimTime t{};; t = t + kMillisecond) {
      const monolith::PortState& port = monolith.ports()[0];
      run.s.push_back(port.x + kStart);
      run.F.push_back(port.F - 1e5 * port.v);
      if (row < table().size() && std::fabs(table()[row][kTime] - t.seconds()) < 1e-6) {
        run.deviation.add(table()[row++], port.x, monolith.variable("Vol_A.pressure"),
                          monolith.variable("Vol_B.pressure"));
      }
      if (t.ns >= kEnd.ns) break;
      const double begin = signal(t.seconds()), end = signal((t + kMillisecond).seconds());
      EXPECT_TRUE(monolith.advance_to(t + kMillisecond, {&begin, 1}, {&end, 1}).is_ok());
    }
    EXPECT_EQ(row, table().size());
    return run;
  }();
  return result;
}

TEST(TwoDofCrane, monolith_follows_the_published_case) {
  const Deviation& deviation = reference().deviation;
  RecordProperty("s_um", std::to_string(1e6 * deviation.s));
  RecordProperty("pressure_ppm", std::to_string(1e6 * deviation.pressure));
  EXPECT_LT(deviation.s, 1e-4);
  EXPECT_LT(deviation.pressure, 5e-3);
}

TEST(TwoDofCrane, starts_in_the_published_equilibrium) {
  const scene::Scene scene = load();
  CoupledRun run(scene);
  ASSERT_TRUE(run.start().is_ok());
  EXPECT_NEAR(run.actuators().F[0], 8829, 1e-3);
  EXPECT_NEAR(run.actuators().p_A[0], 4.52915385e6, 1);
  EXPECT_NEAR(run.actuators().p_B[0], 3.17084615e6, 1);
  EXPECT_NEAR(1 / (run.mechanism().W[0]), 2088.9, 0.1);  // the case's effective mass [kg]
  EXPECT_NEAR(run.variable("Vol_B.effective_bulk_modulus"), 1.552488e9, 1e3);
  EXPECT_NEAR(run.variable("Vol_A.effective_bulk_modulus"), 1.561664e9, 1e3);
}

TEST(TwoDofCrane, co_simulation_of_level_two_follows_the_published_case_with_every_solver) {
  for (const std::string solver : {"rodas3", "rk4", "implicit_euler", "cvode"}) {
    const scene::Scene scene = load({"hydraulics.solver=" + solver, "hydraulics.max_substep=0.1 ms"});
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok()) << solver;
    Deviation deviation;
    std::size_t row = 1;
    while (run.time().ns < kEnd.ns) {
      const double now = signal(run.time().seconds() + 0.5e-3);
      run.step({&now, 1});
      if (row < table().size() && std::fabs(table()[row][kTime] - run.time().seconds()) < 1e-6) {
        deviation.add(table()[row++], run.mechanism().x[0], run.actuators().p_A[0], run.actuators().p_B[0]);
      }
    }
    EXPECT_FALSE(run.has_failed()) << solver;
    EXPECT_EQ(run.flags(), 0u) << solver;
    RecordProperty(solver + "_s_um", std::to_string(1e6 * deviation.s));
    RecordProperty(solver + "_pressure_ppm", std::to_string(1e6 * deviation.pressure));
    EXPECT_LT(deviation.s, 1e-4) << solver;
    EXPECT_LT(deviation.pressure, 5e-3) << solver;
  }
}

TEST(TwoDofCrane, runge_kutta_beyond_its_limit_is_refused_with_the_volume_and_a_substep_that_would_do) {
  // the valve's edges empty a chamber in 0.2 ms
  const scene::Scene scene = load({"hydraulics.solver=rk4", "hydraulics.max_substep=1 ms"});
  CoupledRun run(scene);
  const Status status = run.start();
  ASSERT_FALSE(status.is_ok());
  EXPECT_NE(status.text.find("Vol_"), std::string::npos) << status.text;
  EXPECT_NE(status.text.find("Set hydraulics.max_substep below 0.4"), std::string::npos) << status.text;
}

// ---- E03 ------------------------------------------------------------------------------------------------------

// The two rods by their own equations, absolute angles from +x, no code of the libraries.
class Rods {
 public:
  [[nodiscard]] double length() const { return length_at(y_[0]); }
  [[nodiscard]] double rate() const { return slope_at(y_[0]) * y_[2]; }
  [[nodiscard]] double mobility() const {  // of the cylinder's coordinate [1/kg]
    const double c = std::cos(y_[0] - y_[1]), m_12 = kHook * kL1 * kL2 * c, m_22 = kHook * kL2 * kL2;
    return slope_at(y_[0]) * slope_at(y_[0]) / (kM11 - m_12 * m_12 / m_22);
  }
  void advance(double F, double H, int parts) {
    const double h = H / parts;
    for (int part = 0; part < parts; ++part) {
      const State k1 = rates(y_, F), k2 = rates(moved(k1, h / 2), F), k3 = rates(moved(k2, h / 2), F);
      const State k4 = rates(moved(k3, h), F);
      for (std::size_t i = 0; i < 4; ++i) y_[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
  }

 private:
  using State = std::array<double, 4>;  // theta 1, theta 2, their rates
  static constexpr double kL1 = 1, kL2 = 0.5, kRod = 200, kTip = 250, kHook = 100, kG = 9.81;
  static constexpr double kM11 = kRod * kL1 * kL1 / 3 + (kTip + kHook) * kL1 * kL1;
  static constexpr double kHalfRoot3 = 0.5 * std::numbers::sqrt3;

  static double length_at(double theta) { return kL1 * std::sqrt(1 - kHalfRoot3 * std::cos(theta)); }
  static double slope_at(double theta) { return kL1 * kL1 * kHalfRoot3 * std::sin(theta) / (2 * length_at(theta)); }
  [[nodiscard]] State moved(const State& k, double h) const {
    State y = y_;
    for (std::size_t i = 0; i < 4; ++i) y[i] += h * k[i];
    return y;
  }
  static State rates(const State& y, double F) {
    const double s = std::sin(y[0] - y[1]), c = std::cos(y[0] - y[1]), couple = kHook * kL1 * kL2;
    const double m_12 = couple * c, m_22 = kHook * kL2 * kL2;
    const double q_1 =
        slope_at(y[0]) * F - couple * s * y[3] * y[3] - kG * std::cos(y[0]) * (kRod / 2 + kTip + kHook) * kL1;
    const double q_2 = couple * s * y[2] * y[2] - kHook * kG * kL2 * std::cos(y[1]);
    const double determinant = kM11 * m_22 - m_12 * m_12;
    return {y[2], y[3], (q_1 * m_22 - q_2 * m_12) / determinant, (q_2 * kM11 - q_1 * m_12) / determinant};
  }

  State y_ = {std::numbers::pi / 6, -std::numbers::pi / 2, 0, 0};
};

// The case's root mean square of a force error: from half a second after each command on, until the next.
class ForceError {
 public:
  void add(double t, double F) {
    if (!((t > 2.5 && t < 6) || t > 6.5)) return;
    sum_ += F * F;
    ++count_;
  }
  [[nodiscard]] double mean() const { return std::sqrt(sum_ / count_); }

 private:
  double sum_ = 0;
  int count_ = 0;
};

enum class ForceOf { old_speed, fresh_speed };  // which speed the held force's friction takes

struct SplitError {
  double s = 0;                 // m, largest
  double F = 0;                 // N, ForceError
  double excess = 0;            // J, largest sum of the interface's energy errors, in size
  bool creates_energy = false;  // by the indicator, more than 1.5 s after the last command
};

// The benchmark's coupling: mechanics holds F, hydraulics holds s and s', both in micro steps of 0.2 ms with RK4;
// nothing is corrected at the exchange.
SplitError split(double H, ForceOf force_of) {
  constexpr double kMicro = 2e-4;
  const scene::Scene scene = load({"hydraulics.solver=rk4", "hydraulics.max_substep=0.2 ms"});
  hydraulics::Circuit circuit(scene.hydraulics);
  hydraulics::CircuitIntegrator oil(circuit, scene.hydraulics);
  const hydraulics::HeldSpeed held(1);
  const double x_start = 0.5 - kStart, still = 0, F_start = 8829;
  oil.start({&x_start, 1}, {&still, 1}, {&F_start, 1});

  Rods rods;
  Indicator indicator(1, SimDuration{std::llround(H * 1e9)});
  const PortLevels levels(Level::hold, {{"Cyl"}});
  MechanismSample mechanism;
  ActuatorSample actuators;
  resize(mechanism, 1), resize(actuators, 1);
  double F = F_start, excess = 0;
  ForceError force_error;
  SplitError error;
  const auto steps = static_cast<std::int64_t>(std::llround(kDuration / H));
  const int parts = std::max(1, static_cast<int>(std::ceil(H / kMicro - 1e-9)));
  for (std::int64_t n = 0; n < steps; ++n) {
    const double s = rods.length(), v = rods.rate(), t = static_cast<double>(n) * H;
    rods.advance(F, H, parts);
    const double x = s - kStart;
    double oil_work = 0;
    for (int part = 0; part < parts; ++part) {
      const double now = signal(t + (part + 0.5) * H / parts);
      circuit.set_control(0, now);
      oil.mutable_state()[static_cast<std::size_t>(circuit.position(0))] = x;
      oil.mutable_state()[static_cast<std::size_t>(circuit.speed(0))] = v;
      static_cast<void>(oil.step(H / parts, held));
      oil_work += oil.actuators()[0].work - 1e5 * v * v * H / parts;
    }
    const double held_F = F;
    const hydraulics::ActuatorLinearisation& a = oil.actuators()[0];
    F = a.F - 1e5 * (force_of == ForceOf::old_speed ? v : rods.rate());

    mechanism.x[0] = rods.length() - kStart, mechanism.v[0] = rods.rate(), mechanism.W[0] = rods.mobility();
    mechanism.F_used[0] = F, mechanism.work[0] = held_F * (rods.length() - s);
    // the hydraulics takes the position over as it is: no work of a volume correction
    actuators.F[0] = F, actuators.K[0] = a.K, actuators.x_ref[0] = mechanism.x[0], actuators.v_ref[0] = v;
    actuators.work[0] = oil_work;
    indicator.update(mechanism, actuators, actuators.K, levels);
    excess += indicator.port(0).dE;
    error.excess = std::max(error.excess, std::fabs(excess));
    error.creates_energy = error.creates_energy || (t > 7.5 && indicator.creates_energy());

    const double t_new = static_cast<double>(n + 1) * H * 1e3;
    const auto k = static_cast<std::size_t>(std::llround(t_new));
    if (std::fabs(t_new - static_cast<double>(k)) > 1e-6) continue;
    error.s = std::max(error.s, std::fabs(rods.length() - reference().s[k]));
    force_error.add(1e-3 * t_new, F - reference().F[k]);
  }
  error.F = force_error.mean();
  return error;
}

struct Published {
  double H, s, F;  // s, m, N
};

void expect_within_a_third(const Published& published, const SplitError& error) {
  ::testing::Test::RecordProperty("s_um_" + std::to_string(published.H), std::to_string(1e6 * error.s));
  ::testing::Test::RecordProperty("F_N_" + std::to_string(published.H), std::to_string(error.F));
  EXPECT_NEAR(error.s, published.s, 0.3 * published.s) << published.H;
  EXPECT_NEAR(error.F, published.F, 0.3 * published.F) << published.H;
  EXPECT_FALSE(error.creates_energy) << published.H;
}

TEST(TwoDofCraneSplit, has_the_published_errors_with_the_friction_of_the_old_speed) {
  double coarser = 0, coarser_H = 0;
  for (const Published& published :
       {Published{1e-2, 7.76e-4, 6.73}, Published{5e-3, 3.50e-4, 3.45}, Published{2e-3, 1.34e-4, 1.52},
        Published{1e-3, 6.97e-5, 0.809}, Published{5e-4, 3.41e-5, 0.399}}) {
    const SplitError error = split(published.H, ForceOf::old_speed);
    expect_within_a_third(published, error);
    if (coarser > 0 && published.H >= 1e-3) {
      const double order = std::log(coarser / error.s) / std::log(coarser_H / published.H);
      EXPECT_GT(order, 0.9) << published.H;
      EXPECT_LT(order, 1.2) << published.H;
    }
    coarser = error.s, coarser_H = published.H;
  }
}

TEST(TwoDofCraneSplit, has_the_published_errors_with_the_friction_of_the_fresh_speed) {
  for (const Published& published : {Published{1e-3, 2.68e-5, 0.346}, Published{1e-2, 2.96e-4, 2.19}}) {
    expect_within_a_third(published, split(published.H, ForceOf::fresh_speed));
  }
}

TEST(TwoDofCraneSplit, is_flagged_where_the_published_one_diverges) {
  EXPECT_TRUE(split(2e-2, ForceOf::old_speed).creates_energy);
  EXPECT_FALSE(split(1e-2, ForceOf::old_speed).creates_energy);
}

TEST(TwoDofCraneSplit, loses_its_excess_energy_with_the_step) {
  double coarser = split(4e-3, ForceOf::old_speed).excess;
  for (const double H : {2e-3, 1e-3}) {
    const double excess = split(H, ForceOf::old_speed).excess;
    EXPECT_LT(excess, 0.6 * coarser) << H;
    coarser = excess;
  }
}

// ---- the levels of this program on the same crane ---------------------------------------------------------------

SplitError level_error(Level level, double H) {
  scene::Scene scene = load({"hydraulics.relative_tolerance=1e-6"});
  scene.session.step = H;
  scene.session.coupling = level;
  scene.session.coupling_alarm = scene::CouplingAlarm::warn;  // above the Nyquist limit of the exchange at 20 ms
  CoupledRun run(scene);
  EXPECT_TRUE(run.start().is_ok());
  SplitError error;
  ForceError force_error;
  const auto steps = static_cast<std::int64_t>(std::llround(kDuration / H));
  const auto every = static_cast<std::size_t>(std::llround(H * 1e3));
  for (std::int64_t n = 0; n < steps; ++n) {
    const double now = signal(run.time().seconds() + 0.5 * H);
    run.step({&now, 1});
    const std::size_t k = static_cast<std::size_t>(n + 1) * every;
    error.s = std::max(error.s, std::fabs(run.mechanism().x[0] + kStart - reference().s[k]));
    force_error.add(run.time().seconds(), run.actuators().F[0] - 1e5 * run.mechanism().v[0] - reference().F[k]);
    error.creates_energy = error.creates_energy || (run.time().seconds() > 7.5 && run.indicator().creates_energy());
  }
  error.F = force_error.mean();
  ::testing::Test::RecordProperty((level == Level::two ? "two_s_um_" : "hold_s_um_") + std::to_string(H),
                                  std::to_string(1e6 * error.s));
  ::testing::Test::RecordProperty((level == Level::two ? "two_F_N_" : "hold_F_N_") + std::to_string(H),
                                  std::to_string(error.F));
  return error;
}

// The spool jumps and the mechanics receives it one step later: errors of the stroke are those of that step, at any
// level. Between the commands the levels differ.
TEST(TwoDofCrane, levels_are_at_least_as_good_as_the_published_coupling) {
  for (const Level level : {Level::hold, Level::two}) {
    for (const Published& published : {Published{1e-3, 2.68e-5, 0.346}, Published{1e-2, 2.96e-4, 2.19}}) {
      const SplitError error = level_error(level, published.H);
      EXPECT_LT(error.s, 1.3 * published.s) << published.H;
      EXPECT_FALSE(error.creates_energy) << published.H;
    }
  }
}

TEST(TwoDofCrane, level_two_is_stable_at_20_ms) {
  const SplitError two = level_error(Level::two, 2e-2);
  EXPECT_FALSE(two.creates_energy);
  EXPECT_LT(two.s, 1e-3);
}

}  // namespace two_dof_crane_test
}  // namespace slew::coupling::test
