// SPDX-License-Identifier: Apache-2.0
// No live value of a running session breaks a rule between the fields of a hydraulic component that the loader keeps.
#include "io_node/scene_config.h"
#include "tests/unit/io_node/played_io.h"

namespace slew::io_node {
namespace live_rules_test {

constexpr const char* kCircuit =
    "volumes:\n  T: {fixed: true}\n  P: {rigid_volume: 1 l}\n  S: {rigid_volume: 1 l}\n"
    "curves:\n  Load: {points: [[0, 200], [300, 200]]}\ncomponents:\n"
    "  U: {type: unloading_valve, port_1: P, port_2: T, port_3: S, nominal_flow: 60 l/min, cut_out_pressure: 100 bar, "
    "cut_in_pressure: 80 bar}\n"
    "  E: {type: engine, torque_curve: Load, inertia: 1 kg m2, speed: 200 rad/s, minimum_speed: 80 rad/s, "
    "stall_speed: 60 rad/s}\n"
    "  Q: {type: pump, port_a: P, port_b: T, engine: E, displacement: 40 cm3/rev, swash: -0.5, minimum_swash: -0.8}\n"
    "  D: {type: pump, port_a: P, port_b: T, speed: 150 rad/s, displacement: 10 cm3/rev}\n"
    "  R: {type: relief_valve, port_1: P, port_2: T, nominal_flow: 200 l/min, setting_pressure: 250 bar}\n";

// rk4 at 1 ms follows a spring of 8e6 N/m on 1 kg
constexpr const char* kMass =
    "session: {step: 1 ms}\nbodies: {B: {position: [1 m, 0, 0], mass: 1 kg, inertia: [0.1, 0.1, 0.1]}}\n"
    "joints: {J: {type: prismatic, orientation1: [0, 90 deg, 0], body2: B, orientation2: [0, 90 deg, 0]}}\n"
    "forces:\n  S: {type: translational, body1: Ground, body2: B, free_length: 1 m, spring_constant: 6e6 N/m}\n";

class LiveRules : public Io {
 protected:
  void start(const std::string& script = {}) { start_scene(kCircuit + script); }
  void start_scene(const std::string& text) {
    IoConfig with = make_config(scene::load_text(text, "test"), "s", Recording::none);
    with.session = config().session;
    with.required_roles = config().required_roles;
    with.name_check = {};
    restart(std::move(with));
    get_running();
  }
  // Empty: accepted.
  std::string set(const std::string& path, double value, SimDuration over = {}) {
    wire::ControlRequest request;
    request.session = "s";
    request.request = ++requests_;
    request.action = wire::ControlAction::set_parameter;
    request.path = path;
    request.value = value;
    request.over_ns = over.ns;
    played.publish(Topic::control_request, request);
    poll();
    const auto replies = played.received<wire::ControlReply>(Topic::control_reply);
    EXPECT_EQ(replies.size(), 1u);
    if (replies.empty()) return "no reply";
    return replies.back().is_accepted ? "" : replies.back().reason;
  }
};

TEST_F(LiveRules, RefuseTheValueWithTheLoadersSentence) {
  start();
  EXPECT_EQ(set("U.cut_in_pressure", 120e5),
            "U.cut_in_pressure: 12000000 Pa is refused: U.cut_in_pressure: the valve would shut above the pressure at "
            "which it opens; expected at most cut_out_pressure");
  EXPECT_NE(set("U.cut_out_pressure", 70e5).find("U.cut_in_pressure: the valve would shut"), std::string::npos);
  EXPECT_NE(set("Q.swash", -0.9).find("Q.swash: the swash -0.9 lies below its least one"), std::string::npos);
  EXPECT_NE(set("D.speed", 0).find("D.speed: nothing drives the pump"), std::string::npos);
  EXPECT_NE(set("E.speed", 50).find("E.stall_speed: the engine would stand at its governed speed"), std::string::npos);
  EXPECT_EQ(set("E.friction_torque", 250), "") << "a fault that a session may want";
  EXPECT_EQ(set("U.cut_in_pressure", 100e5), "");
}

TEST_F(LiveRules, HoldForTheValuesOfTheSessionAndNotOfTheScene) {
  start();
  EXPECT_EQ(set("U.cut_out_pressure", 150e5), "");
  EXPECT_EQ(set("U.cut_in_pressure", 120e5), "") << "the change before waits for the same step";
  run_to(20);
  EXPECT_NE(set("U.cut_out_pressure", 110e5), "") << "allowed in the scene, not beside 120 bar";
  EXPECT_EQ(set("U.cut_in_pressure", 90e5), "");
  run_to(30);
  EXPECT_EQ(set("U.cut_out_pressure", 110e5), "");
}

TEST_F(LiveRules, HoldAllAlongTheRamps) {
  start();
  EXPECT_NE(set("U.cut_in_pressure", 120e5, milliseconds(100)).find(" at 0.1 s: "), std::string::npos) << "at its end";
  EXPECT_EQ(set("U.cut_out_pressure", 150e5, milliseconds(100)), "");
  // at 10 ms the one is 120 bar and the other 105 bar, though both ends fit
  EXPECT_NE(set("U.cut_in_pressure", 120e5, milliseconds(10)), "");
  EXPECT_EQ(set("U.cut_in_pressure", 120e5, milliseconds(100)), "");
  run_to(50);
  EXPECT_NE(set("U.cut_out_pressure", 100e5), "") << "where the ramp is";
  // held where it is, 125 bar, the ramp to 120 bar still fits
  EXPECT_EQ(set("U.cut_out_pressure", 125e5), "");
}

TEST_F(LiveRules, HoldForTheScriptsChangesThatFollow) {
  start(
      "script:\n  parameters:\n    - {at: 0.1 s, set: U.cut_in_pressure, value: 95 bar}\n"
      "    - {at: 0.2 s, set: U.cut_in_pressure, value: 60 bar}\n");
  const std::string refusal = set("U.cut_out_pressure", 90e5);
  EXPECT_NE(refusal.find("U.cut_in_pressure at 0.1 s: the valve would shut"), std::string::npos) << refusal;
  run_to(250);
  EXPECT_EQ(set("U.cut_out_pressure", 90e5), "");
}

// Was judged beside the scene's 1 kg: the spring was refused, and the lost mass accepted, 2.5 times the limit of rk4.
TEST_F(LiveRules, OfTheMechanismHoldForTheValuesOfTheSession) {
  start_scene(kMass);
  EXPECT_NE(set("S.spring_constant", 2e7).find("S.spring_constant: 20000000 N/m is refused: "), std::string::npos);
  EXPECT_EQ(set("B.mass", 4), "");
  EXPECT_EQ(set("S.spring_constant", 2e7), "") << "the change before waits for the same step";
  run_to(20);
  EXPECT_NE(set("B.mass", 1).find("B.mass: 1 kg is refused: "), std::string::npos) << "allowed in the scene";
  EXPECT_EQ(set("B.mass", 3), "");
  run_to(30);
  EXPECT_EQ(set("S.spring_constant", 6e6), "");
  run_to(40);
  EXPECT_EQ(set("B.mass", 1), "");
}

TEST_F(LiveRules, OfTheMechanismHoldAlongTheRamps) {
  start_scene(kMass);
  EXPECT_EQ(set("B.mass", 4, milliseconds(100)), "");
  EXPECT_NE(set("S.spring_constant", 2e7), "") << "the mass is not there yet";
  EXPECT_EQ(set("S.spring_constant", 2e7, milliseconds(100)), "");
  run_to(50);
  const std::string refusal = set("B.mass", 2.2);
  EXPECT_NE(refusal.find("is refused: at 0.1"), std::string::npos) << refusal;
}

}  // namespace live_rules_test
}  // namespace slew::io_node
