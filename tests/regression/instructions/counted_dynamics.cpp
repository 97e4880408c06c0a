// SPDX-License-Identifier: Apache-2.0
// Calls the forward dynamics of a mechanism, and the mobilities of its rows, often enough that an instruction counter
// sees nothing else.
//
//   counted_dynamics crane | crane_loops | chain10 | loops10 | loops40 | sliders100 | sliders400
//
// Prints the number of calls. count_instructions.cmake counts what they execute.
#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "multibody/constraints/rows.h"
#include "multibody/formulations/dynamics.h"
#include "tests/support/chain_def.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"
#include "tests/validation/multibody/loop_defs.h"

namespace {

using namespace slew::multibody;

MechanicsDef crane_loops_def() {
  MechanicsDef def = testing::crane_def();
  for (const char* force : {"ForceT_Lift", "ForceT_Jib"}) testing::replace_dummies(def, force, {0, 0, 1});
  return def;
}

// independent sliders with friction, each of them a row
MechanicsDef sliders(int count) {
  MechanicsDef def;
  for (int i = 0; i < count; ++i) {
    const std::string body = "B" + std::to_string(i);
    def.bodies.push_back({.name = body, .mass = 1, .inertia = {1, 1, 1}});
    def.joints.push_back({.name = "J" + std::to_string(i),
                          .type = JointType::prismatic,
                          .body2 = body,
                          .first = {.coulomb_friction = 1}});
  }
  return def;
}

}  // namespace

int main(int count, char** arguments) {
  const std::map<std::string, std::function<MechanicsDef()>> mechanisms = {
      {"crane", [] { return testing::crane_def({.dummies = testing::Dummies::without}); }},
      {"crane_loops", crane_loops_def},
      {"chain10", [] { return testing::chain_def(10); }},
      // four-bars in a row: as many instructions each
      {"loops10", [] { return testing::four_bars(10); }},
      {"loops40", [] { return testing::four_bars(40); }},
      {"sliders100", [] { return sliders(100); }},
      {"sliders400", [] { return sliders(400); }}};
  const auto chosen = mechanisms.find(count == 2 ? arguments[1] : "");
  if (chosen == mechanisms.end()) {
    std::fputs("counted_dynamics: expected crane, crane_loops, chain10, loops10, loops40, sliders100 or sliders400\n",
               stderr);
    return 2;
  }
  const MechanicsDef def = chosen->second();
  const Model model = build_model(def, joint_rows(def));
  Workspace ws(model);
  State state = start_state(model);
  constexpr int kCalls = 160;
  for (int i = 0; i < kCalls; ++i) {
    // states of a motion; the sub-steps between them are not forward_dynamics() of this program
    for (double& u : state.u) u = 0.1 + 1e-3 * i;
    forward_dynamics(model, state.q, state.u, {}, ws);
    if (!model.rows.empty()) evaluate_rows(model, state, ws);
  }
  std::printf("calls %d\n", kCalls);
  return 0;
}
