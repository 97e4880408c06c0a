// SPDX-License-Identifier: Apache-2.0
// Ours and one peer, the one that this program is linked with, on the same mechanisms: forward dynamics and steps of
// 1 ms, in nanoseconds of thread time.
//
//   peer_cost_mujoco        (or _simbody, _dart, _bullet)
//
// Batches of either take turns, and so do the mechanisms; medians are printed, one line a figure, separated by tabs:
// peer, quantity, mechanism, ours, peer, the difference. table.py runs all programs and makes the tables of results.md.
//
// Ends with 1 when a peer's accelerations are not ours, or its motion is another after 0.1 s: then it is not the same
// mechanism.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "benchmarks/peers/models.h"
#include "multibody/formulations/dynamics.h"

namespace {

using namespace slew;
using namespace slew::peers;
using multibody::Model, multibody::Workspace;

constexpr int kStates = 16, kRounds = 31, kSteps = 100;
constexpr double kStep = 1e-3;
constexpr double kBatch = 1e-3;  // s
// rad and m, between first-order steps of different kinds
constexpr double kSameMotion = 2e-2;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// nanoseconds per call
double time_of(const std::function<void(int)>& call, int calls) {
  const double begin = thread_seconds();
  for (int i = 0; i < calls; ++i) call(i);
  return (thread_seconds() - begin) * 1e9 / calls;
}

double median(std::vector<double> times) {
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

// a timed quantity, and its times
struct Side {
  std::function<void()> begin;
  std::function<void(int)> call;
  int calls = 0;
  std::vector<double> times;

  void run() {
    begin();
    if (calls == 0) calls = std::clamp(static_cast<int>(kBatch * 1e9 / time_of(call, kStates)), 1, 100000);
    times.push_back(time_of(call, calls));
  }
};

struct Figure {
  std::string quantity, mechanism, remark;
  Side ours, peer;
};

// One mechanism on both sides.
class Pair {
 public:
  explicit Pair(const Case& chosen)
      : name_(chosen.name),
        model_(multibody::build_model(chosen.def)),
        ws_(model_),
        states_(motion_of(model_, kStates)),
        moving_(states_[0]),
        stepper_(multibody::Formulation::recursive, model_, states_[0],
                 {.integrator = multibody::Integrator::semi_implicit_euler}),
        peer_(make_peer(mechanism_of(chosen.def, model_), kStep)) {
    for (const multibody::State& state : states_) {
      see(state);
      peer_states_.push_back(state_of(model_, state, ws_));
    }
  }

  [[nodiscard]] bool has_peer() const { return peer_ != nullptr; }
  [[nodiscard]] const Peer& peer() const { return *peer_; }

  // relative
  [[nodiscard]] double acceleration_difference() {
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      see(states_[i]);
      peer_->find_accelerations(peer_states_[i]);
      const std::vector<double> expected = accelerations_of(model_, states_[i], ws_), got = peer_->accelerations();
      for (std::size_t k = 0; k < expected.size(); ++k) {
        if (!std::isfinite(got[k])) return HUGE_VAL;
        difference = std::max(difference, std::fabs(got[k] - expected[k]));
        largest = std::max(largest, std::fabs(expected[k]));
      }
    }
    return difference / largest;
  }

  // rad and m, after kSteps
  [[nodiscard]] double motion_difference() {
    start();
    peer_->start(peer_states_[0]);
    for (int i = 0; i < kSteps; ++i) {
      step();
      peer_->step(kStep);
    }
    const std::vector<double> angles = peer_->angles();
    double difference = 0;
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      const multibody::Link& link = model_.links[i];
      const bool is_single =
          link.joint == multibody::LinkJoint::revolute || link.joint == multibody::LinkJoint::prismatic;
      if (!is_single) continue;
      difference = std::max(difference, std::fabs(angles[i - 1] - moving_.q[static_cast<std::size_t>(link.q)]));
    }
    return difference;
  }

  [[nodiscard]] Figure dynamics(const std::string& remark) {
    return {"forward dynamics",
            name_,
            remark,
            {[] {}, [this](int i) { see(states_[static_cast<std::size_t>(i % kStates)]); }, 0, {}},
            {[] {},
             [this](int i) { peer_->find_accelerations(peer_states_[static_cast<std::size_t>(i % kStates)]); },
             0,
             {}}};
  }

  [[nodiscard]] Figure steps(const std::string& remark) {
    return {"step of 1 ms",
            name_,
            remark,
            {[this] { start(); }, [this](int) { step(); }, kSteps, {}},
            {[this] { peer_->start(peer_states_[0]); }, [this](int) { peer_->step(kStep); }, kSteps, {}}};
  }

 private:
  void see(const multibody::State& state) { multibody::forward_dynamics(model_, state.q, state.u, {}, ws_); }
  void start() { copy_state(states_[0], moving_); }
  void step() {
    stepper_.evaluate(model_, moving_, ws_);
    if (!stepper_.advance(model_, moving_, ws_, kStep, {}, {})) throw std::runtime_error(name_ + ": no step");
  }

  std::string name_;
  Model model_;
  Workspace ws_;
  std::vector<multibody::State> states_;
  multibody::State moving_;
  multibody::Dynamics stepper_;
  std::unique_ptr<Peer> peer_;
  std::vector<State> peer_states_;
};

// Adds the timed quantities of the pair; false: not the same mechanism.
bool add(Pair& pair, const std::string& name, std::vector<Figure>& figures) {
  const Peer& peer = pair.peer();
  bool is_same = true;
  if (peer.has_dynamics()) {
    const double difference = pair.acceleration_difference();
    is_same = difference < peer.tolerance();
    figures.push_back(pair.dynamics(fmt::format("accelerations {:.1e}", difference)));
    if (!is_same) fmt::print(stderr, "{}: {}'s accelerations differ by {:.1e}\n", name, peer.name(), difference);
  }
  if (!peer.step_method().empty()) {
    const double difference = pair.motion_difference();
    if (!(difference < kSameMotion)) {
      fmt::print(stderr, "{}: {}'s motion differs by {:.1e} rad or m\n", name, peer.name(), difference);
      is_same = false;
    }
    figures.push_back(pair.steps(fmt::format("{}; motion {:.1e}", peer.step_method(), difference)));
  }
  return is_same;
}

}  // namespace

int main() {
  std::vector<std::unique_ptr<Pair>> pairs;
  std::vector<Figure> figures;
  bool is_same = true;
  for (const Case& chosen : cases()) {
    pairs.push_back(std::make_unique<Pair>(chosen));
    if (pairs.back()->has_peer()) is_same = add(*pairs.back(), chosen.name, figures) && is_same;
  }
  if (!is_same) return 1;
  for (int round = 0; round < kRounds; ++round) {
    for (Figure& figure : figures) {
      figure.ours.run();
      figure.peer.run();
    }
  }
  for (const Figure& f : figures) {
    fmt::print("{}\t{}\t{}\t{:.0f}\t{:.0f}\t{}\n", pairs[0]->peer().name(), f.quantity, f.mechanism,
               median(f.ours.times), median(f.peer.times), f.remark);
  }
  return 0;
}
