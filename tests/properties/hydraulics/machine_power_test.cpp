// SPDX-License-Identifier: Apache-2.0
// Power of shaft and oil of every pump and motor at random states of all four quadrants: what one side takes, the other
// gives less losses that are never negative.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "hydraulics/circuit.h"
#include "hydraulics/components/engine.h"
#include "hydraulics/components/hydraulic_motor.h"
#include "hydraulics/components/ls_pump.h"
#include "hydraulics/components/pump.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/nightly.h"

namespace slew::hydraulics::test {
namespace machine_power_test {

constexpr double kInertia = 2;        // kg m2
constexpr double kEngineSpeed = 150;  // rad/s
constexpr double kRounding = 1e-12;   // share of the powers

using Random = std::mt19937_64;

double uniform(Random& random, double least, double most) {
  return std::uniform_real_distribution<double>(least, most)(random);
}

// Pumps of both types on an engine and at speeds of their own, and a motor, with random efficiencies and leaks.
HydraulicsDef machines(Random& random) {
  HydraulicsDef def;
  add_volume(def, "A").rigid_volume = 1e-3, add_volume(def, "B").rigid_volume = 1e-3;
  add_volume(def, "Case").rigid_volume = 1e-3, add_tank(def, "Tank", 1e5);
  const auto efficiency = [&] { return random() % 4 == 0 ? 1 : uniform(random, 0.5, 1); };
  const auto leak = [&] { return random() % 2 == 0 ? 0 : uniform(random, 0, 1e-4); };
  for (const char* name : {"Shaft_Pump", "Own_Pump"}) {
    PumpDef& pump = add<PumpDef>(def, name);
    pump.port_a = "A", pump.port_b = "B", pump.displacement = uniform(random, 1e-6, 2e-5), pump.minimum_swash = -1;
    pump.mechanical_coefficient = efficiency(), pump.volumetric_coefficient = efficiency();
    pump.leak_flow = leak();
    pump.port_c = "Case", pump.case_leak_flow = leak();
    if (name[0] == 'S') pump.drive = {"Engine", uniform(random, 0.5, 2)};
    if (name[0] == 'O') pump.speed = uniform(random, 0.1, 200);
  }
  for (const char* name : {"Shaft_Ls", "Own_Ls"}) {
    LsPumpDef& pump = add<LsPumpDef>(def, name);
    pump.port_a = "A", pump.port_b = "Tank", pump.displacement = uniform(random, 1e-6, 2e-5);
    pump.mechanical_coefficient = efficiency(), pump.volumetric_coefficient = efficiency();
    pump.leak_flow = leak();
    if (name[0] == 'S') pump.drive = {"Engine", uniform(random, 0.5, 2)};
    if (name[0] == 'O') pump.speed = uniform(random, 0.1, 200);
  }
  EngineDef& engine = add<EngineDef>(def, "Engine");
  engine.torque_curve = "Full_Load", engine.inertia = kInertia, engine.speed = kEngineSpeed, engine.stall_speed = 80;
  engine.friction_torque = 10, engine.viscous_friction = 0.05;
  def.curves.push_back({.name = "Full_Load", .points = {{0, 300}, {300, 300}}});
  HydraulicMotorDef& motor = add<HydraulicMotorDef>(def, "Motor");
  motor.force = "Force", motor.port_a = "A", motor.port_b = "B", motor.port_c = "Case", motor.displacement = 1e-5;
  motor.leak_flow = leak(), motor.case_leak_flow = leak();
  return def;
}

class Machines {
 public:
  explicit Machines(const HydraulicsDef& def) : circuit_(def), y_(static_cast<std::size_t>(circuit_.state_count())) {}

  // Pressures, often close to one another, speeds of both signs, often close to rest, and swashes of both signs.
  void draw(Random& random) {
    const double common = uniform(random, 1e5, 400e5);
    const auto pressure = [&] {
      return random() % 3 == 0 ? common + uniform(random, -4e5, 4e5) : std::pow(10, uniform(random, 5, 7.6));
    };
    for (int i = 0; i < circuit_.volume_count(); ++i)
      y_[at(i)] = circuit_.is_fixed(i) ? 1e5 : std::max(pressure(), 1e4);
    y_[at(circuit_.position(0))] = 0, y_[at(circuit_.speed(0))] = uniform(random, -100, 100);
    for (int k = circuit_.first_component_state(); k < circuit_.state_count(); ++k) {
      const std::string& owner = circuit_.state_owner(k - circuit_.first_component_state());
      const double least = owner.find("Ls") == std::string::npos ? -1 : 0;
      y_[at(k)] = uniform(random, least, 1);
      if (owner == "Engine" && random() % 2 == 0) y_[at(k)] = uniform(random, -3, 3) / kEngineSpeed;
    }
    values_.resize(circuit_.variables().size());
    circuit_.read_variables(y_.data(), values_);
  }
  [[nodiscard]] double variable(const std::string& name) const {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (circuit_.variables()[i].name == name) return values_[i];
    }
    ADD_FAILURE() << name;
    return 0;
  }
  [[nodiscard]] double pressure(const char* volume) const { return y_[at(circuit_.find_volume(volume))]; }
  // w' of the engine [rad/s2]
  [[nodiscard]] double engine_rate() {
    std::vector<double> f(y_.size());
    circuit_.rates(y_.data(), f.data());
    for (int k = circuit_.first_component_state();; ++k) {
      if (circuit_.state_owner(k - circuit_.first_component_state()) == "Engine") return f[at(k)] * kEngineSpeed;
    }
  }

 private:
  [[nodiscard]] static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  Circuit circuit_;
  std::vector<double> y_, values_;
};

void expect_loss(double shaft, double oil, const char* name) {
  EXPECT_GE(shaft - oil, -kRounding * (std::fabs(shaft) + std::fabs(oil)))
      << name << ": the shaft takes " << shaft << " W, the oil gets " << oil << " W";
}

TEST(MachinePower, of_pumps_and_motors_is_lost_in_every_quadrant) {
  testing::for_each_seed(testing::seeds({{1, 50}}), [](std::uint32_t seed) {
    Random random(seed);
    const HydraulicsDef def = machines(random);
    Machines all(def);
    for (int trial = 0; trial < 500; ++trial) {
      all.draw(random);
      const double p_a = all.pressure("A"), p_b = all.pressure("B"), p_c = all.pressure("Case");
      for (const char* name : {"Shaft_Pump", "Own_Pump"}) {
        // without the flows into the case, whose loss G (p - p_c)^2 is none of the shaft's
        expect_loss(all.variable(name + std::string(".power")), all.variable(name + std::string(".flow")) * (p_a - p_b),
                    name);
      }
      for (const char* name : {"Shaft_Ls", "Own_Ls"}) {
        expect_loss(all.variable(name + std::string(".power")),
                    all.variable(name + std::string(".flow")) * (p_a - all.pressure("Tank")), name);
      }
      expect_loss(all.variable("Motor.flow_a") * p_a + all.variable("Motor.flow_b") * p_b -
                      all.variable("Motor.case_flow") * p_c,
                  all.variable("Motor.pressure_torque") * all.variable("Motor.speed"), "Motor");
    }
  });
}

// J w' = T - sum r T_i with the published torques, forwards, backwards and at rest.
TEST(MachinePower, published_torques_are_those_that_the_engine_receives) {
  testing::for_each_seed(testing::seeds({{100, 50}}), [](std::uint32_t seed) {
    Random random(seed);
    const HydraulicsDef def = machines(random);
    const auto ratio = [&](const char* name) {
      for (const auto& component : def.components) {
        if (component->name != name) continue;
        if (const auto* pump = dynamic_cast<const PumpDef*>(component.get())) return pump->drive.speed_ratio;
        return dynamic_cast<const LsPumpDef&>(*component).drive.speed_ratio;
      }
      return 0.0;
    };
    Machines all(def);
    for (int trial = 0; trial < 500; ++trial) {
      all.draw(random);
      const double T = all.variable("Engine.torque"), T_pump = ratio("Shaft_Pump") * all.variable("Shaft_Pump.torque"),
                   T_ls = ratio("Shaft_Ls") * all.variable("Shaft_Ls.torque");
      EXPECT_NEAR(kInertia * all.engine_rate(), T - T_pump - T_ls,
                  1e-10 * (std::fabs(T) + std::fabs(T_pump) + std::fabs(T_ls)));
    }
  });
}

}  // namespace machine_power_test
}  // namespace slew::hydraulics::test
