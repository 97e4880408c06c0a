// What the mechanics costs: forward dynamics and steps of the crane, of the crane with its cylinders as bodies in
// loops, and of chains, in nanoseconds of thread time and in instructions.
//
//   multibody_cost
//
// All figures of one run belong together: rounds over all cases one after the other, the smallest of the rounds.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "multibody/dynamics.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"

namespace {

using namespace slew::multibody;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// n links with hinges about x and y in turn
MechanicsDef chain(int n) {
  MechanicsDef def;
  std::string parent = "Ground";
  for (int i = 0; i < n; ++i) {
    const std::string name = "L" + std::to_string(i);
    const slew::Triple point = {0, 0, i == 0 ? 0.0 : -0.5};
    def.bodies.push_back({.name = name,
                          .relative_to = parent,
                          .position = point,
                          .mass = 1,
                          .center_of_mass = {0, 0, -0.25},
                          .inertia = {0.03, 0.03, 0.002}});
    const slew::Triple axis = i % 2 == 0 ? slew::Triple{0, M_PI / 2, 0} : slew::Triple{-M_PI / 2, 0, 0};
    def.joints.push_back({.name = "J" + std::to_string(i),
                          .body1 = parent,
                          .point1 = point,
                          .orientation1 = axis,
                          .body2 = name,
                          .orientation2 = axis,
                          .initial_velocity = 0.1});
    parent = name;
  }
  return def;
}

struct Case {
  std::string name;
  MechanicsDef def;
};

std::vector<Case> cases() {
  using namespace testing;
  MechanicsDef loops = crane_def();
  for (const char* force : {"ForceT_Lift", "ForceT_Jib"}) replace_dummies(loops, force, {0, 0, 1});
  std::vector<Case> list = {{"crane", crane_def({.dummies = Dummies::without})},
                            {"crane, dummies", crane_def()},
                            {"crane, cylinders as bodies", loops}};
  for (const int n : {5, 10, 20, 50, 100}) list.push_back({fmt::format("chain {}", n), chain(n)});
  return list;
}

// nanoseconds per call of what is measured, or what was found before where that is less
double measure(const std::function<void()>& call, int calls, double before) {
  const double begin = thread_seconds();
  for (int i = 0; i < calls; ++i) call();
  return std::min(before, (thread_seconds() - begin) * 1e9 / calls);
}

}  // namespace

int main() {
  constexpr int kRounds = 7;
  const std::vector<Case> list = cases();
  std::vector<double> dynamics(list.size(), 1e300), step(list.size(), 1e300);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      const Model model = build_model(list[k].def);
      Workspace ws(model);
      const State start = start_state(model);
      const int calls = 20000 / static_cast<int>(model.links.size());
      dynamics[k] = measure([&] { forward_dynamics(model, start.q, start.u, {}, ws); }, calls, dynamics[k]);
      State state = start;
      step[k] = measure([&] { advance_free(model, state, ws, 1e-4); }, calls / 4, step[k]);
    }
  }
  fmt::print("{:<28}{:>8}{:>16}{:>20}\n", "", "speeds", "dynamics [ns]", "RK4 sub-step [ns]");
  for (std::size_t k = 0; k < list.size(); ++k) {
    fmt::print("{:<28}{:>8}{:>16.0f}{:>20.0f}\n", list[k].name, build_model(list[k].def).speed_count(), dynamics[k],
               step[k]);
  }
  return 0;
}
