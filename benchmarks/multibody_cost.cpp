// SPDX-License-Identifier: Apache-2.0
// Cost of the mechanics: forward dynamics and steps of the crane, of the crane with its cylinders as bodies in loops,
// of contact and of chains, in nanoseconds of thread time; and the energy drift of a chain.
//
//   multibody_cost
//
// All figures of one run belong together: rounds over all cases one after the other, the medians of the rounds.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "benchmarks/peers/models.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/results/observe.h"
#include "tests/support/chain_def.h"
#include "tests/validation/multibody/crane_def.h"

namespace {

using namespace slew::multibody;
using slew::peers::Case;

constexpr double kStep = 1e-3;
constexpr int kRounds = 21;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> times) {
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

// A mechanism with all that is timed of it.
struct Subject {
  explicit Subject(const Case& chosen)
      : name(chosen.name),
        model(build_model(chosen.def)),
        ws(model),
        start(slew::peers::motion_of(model, 1)[0]),
        moving(start),
        euler(Formulation::recursive, model, start, {.integrator = Integrator::semi_implicit_euler}) {}

  void run() {
    constexpr int kSteps = 100;
    const int calls = 40000 / static_cast<int>(model.links.size());
    time(calls, dynamics_times, [&] { forward_dynamics(model, start.q, start.u, {}, ws); });
    copy_state(start, moving);
    time(kSteps, euler_times, [&] {
      euler.evaluate(model, moving, ws);
      is_right = euler.advance(model, moving, ws, kStep, {}, {}) && is_right;
      for (const RowValue& row : ws.loops.rows) {
        open = std::max(open, std::fabs(row.g));
        opening = std::max(opening, std::fabs(row.rate));
      }
    });
    copy_state(start, moving);
    time(kSteps, rk4_times, [&] { is_right = advance_free(model, moving, ws, kStep) && is_right; });
  }

  static void time(int calls, std::vector<double>& times, const std::function<void()>& call) {
    const double begin = thread_seconds();
    for (int i = 0; i < calls; ++i) call();
    times.push_back((thread_seconds() - begin) * 1e9 / calls);
  }

  std::string name;
  Model model;
  Workspace ws;
  State start, moving;
  Dynamics euler;
  std::vector<double> dynamics_times{}, euler_times{}, rk4_times{};
  double open = 0, opening = 0;  // m, m/s, largest of the loops after the steps of Euler's method
  bool is_right = true;
};

// Chain of 5 links that starts at rest 1.2 rad off the vertical and swings for 10 s: largest error of its energy [J],
// and microseconds per simulated millisecond.
void print_energy_error(Integrator integrator, int steps_per_millisecond) {
  MechanicsDef def = testing::chain_def(5, {.first_angle = 1.2, .initial_speed = 0});
  def.gravity = {0, 0, -9.81};
  const Model model = build_model(def);
  Workspace ws(model);
  State state = start_state(model);
  Dynamics dynamics(Formulation::recursive, model, state, {.integrator = integrator});
  const double h = kStep / steps_per_millisecond;
  double first = 0, largest = 0, spent = 0;
  for (int i = 0; i < 10000; ++i) {
    observe(model, state, ws);
    const Energy now = energy(model, ws);
    if (i == 0) first = now.kinetic + now.potential;
    largest = std::max(largest, std::fabs(now.kinetic + now.potential - first));
    const double begin = thread_seconds();
    for (int k = 0; k < steps_per_millisecond; ++k) {
      if (integrator == Integrator::rk4) {
        static_cast<void>(advance_free(model, state, ws, h));
        continue;
      }
      dynamics.evaluate(model, state, ws);
      static_cast<void>(dynamics.advance(model, state, ws, h, {}, {}));
    }
    spent += thread_seconds() - begin;
  }
  fmt::print("| {} | {} | {:.2g} | {:.2f} |\n", integrator == Integrator::rk4 ? "rk4" : "semi_implicit_euler",
             steps_per_millisecond, largest, spent * 1e6 / 10000);
}

}  // namespace

int main() {
  std::vector<Case> list = slew::peers::cases();
  list.insert(list.begin() + 1, {"crane, dummies", testing::crane_def()});
  std::vector<Subject> subjects;
  subjects.reserve(list.size());
  for (const Case& chosen : list) subjects.emplace_back(chosen);
  for (int round = 0; round < kRounds; ++round) {
    for (Subject& subject : subjects) subject.run();
  }
  fmt::print(
      "| | speeds | forward dynamics [ns] | Euler step [ns] | loops open by [m] | at [m/s] | RK4 step "
      "[ns] |\n|---|---|---|---|---|---|---|\n");
  bool is_right = true;
  for (const Subject& s : subjects) {
    fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.1g} | {:.1g} | {:.0f} |\n", s.name, s.model.speed_count(),
               median(s.dynamics_times), median(s.euler_times), s.open, s.opening, median(s.rk4_times));
    is_right = is_right && s.is_right;
  }
  fmt::print("\n| chain5, 10 s | steps per ms | energy error [J] | [us per ms] |\n|---|---|---|---|\n");
  for (const int steps : {1, 2}) print_energy_error(Integrator::rk4, steps);
  print_energy_error(Integrator::semi_implicit_euler, 1);
  if (!is_right) fmt::print(stderr, "a step was not right\n");
  return is_right ? 0 : 1;
}
