// SPDX-License-Identifier: Apache-2.0
// Cost of bending: the mechanics of the truck crane with its jib boom rigid, frozen, with an increasing number of
// modes, with 20 and 200 nodes, and in segments; and a chain of five booms of which none, one or all bend. Beside each
// the rigid one of the same run.
//
//   flexible_cost                    tables of microseconds per simulated millisecond
//   flexible_cost --steps NAME N     N steps of one mechanism and nothing else, for a counter of instructions; prints
//                                    the hash of the state, by which builds are compared
//   flexible_cost --node NAME N      the crane's run N times, for a profiler; prints the iterations of the ports' laws
//
// Rounds over all subjects one after the other, the medians of the rounds; thread time.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "io_node/scene_config.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/formulation.h"
#include "scene/flexible_conversion.h"
#include "scene/scene.h"
#include "scene/script.h"
#include "tests/support/flex_beams.h"

namespace {

using namespace slew;

constexpr SimDuration kH = milliseconds(1);  // without segments
constexpr int kMilliseconds = 3000;          // rest, lift
constexpr int kRounds = 15;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> times) {
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

// the jib boom with its lowest modes
std::shared_ptr<const multibody::ModalBody> jib_modes(int nodes, int modes, flex::GeometricStiffening stiffening) {
  flex::ReductionDef def = flex::testing::with_modes(20);
  def.stiffening = stiffening;
  std::vector<int> kept;
  for (int k = 1; k <= modes; ++k) kept.push_back(k);
  const flex::Reduction all = flex::reduce(flex::build_beam(flex::testing::jib_boom(nodes)), def);
  return std::make_shared<multibody::ModalBody>(scene::modal_body(flex::select(all, kept), "jib"));
}

struct Boom {
  std::string name;
  int modes = 0, nodes = 20;  // modes below zero: rigid
  flex::GeometricStiffening stiffening = flex::GeometricStiffening::none;
  int segments = 0;                       // 0: by modes
  const char* longest_substep = nullptr;  // that a whole number of them makes the step of the session, for segments
};

const std::vector<Boom>& booms() {
  static const std::vector<Boom> list = {
      {"rigid", -1},
      {"frozen", 0},
      {"2", 2},
      {"2_stiffening", 2, 20, flex::GeometricStiffening::straight_beam},
      {"2_of_200_nodes", 2, 200},
      {"6", 6},
      {"12", 12},
      {"12_of_200_nodes", 12, 200},
      {.name = "5_segments", .segments = 5, .longest_substep = "250 us"},
      {.name = "10_segments", .segments = 10, .longest_substep = "50 us"},
      {.name = "20_segments", .segments = 20, .longest_substep = "13.9 us"},
  };
  return list;
}

scene::Scene crane(const Boom& boom) {
  const std::string folder = SLEWRING_SOURCE_DIR "/scenes/";
  if (boom.segments > 0) {
    return scene::load_file(folder + "truck_crane_segmented.yaml",
                            {fmt::format("Truck_JibBoom.segments={}", boom.segments),
                             fmt::format("mechanics.max_substep={}", boom.longest_substep)});
  }
  if (boom.modes < 0) return scene::load_file(folder + "truck_crane.yaml", {"hydraulics.minimum_step=1e-8 s"});
  scene::Scene scene = scene::load_file(folder + "truck_crane_flexible.yaml");
  scene.mechanics.flexible_bodies[0].modes = jib_modes(boom.nodes, boom.modes, boom.stiffening);
  return scene;
}

// One run of the machine with the inputs of the mechanics.
struct Tape {
  std::vector<coupling::ActuatorSample> actuators;
  std::vector<std::vector<double>> controls;
};

Tape record(const scene::Scene& scene, mechanics_node::MechanicsSubsystem& mechanics) {
  Tape tape;
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  const scene::ScriptPlayer script(scene);
  const io_node::IoConfig config = io_node::make_config(scene, "benchmark", io_node::Recording::none);
  const SimDuration H = scene.session.step_duration();
  io_node::InputGate gate(config.channels, config.gate(), H);
  std::vector<SignalCourse> raw(gate.size());
  coupling::OwnSample m, h;
  static_cast<void>(mechanics.first_sample(m));
  static_cast<void>(hydraulics.start({&m.mechanism, nullptr}, h));
  static_cast<void>(mechanics.start({nullptr, &h.actuators}, m));
  const StepIndex steps = kMilliseconds * milliseconds(1).ns / H.ns;
  for (StepIndex n = 0; n < steps; ++n) {
    for (std::size_t i = 0; i < raw.size(); ++i) script.read_course(i, start_of(n, H), start_of(n, H) + H, raw[i]);
    gate.advance(n, raw, 0);
    std::vector<double> controls;
    for (std::size_t i = 0; i < gate.size(); ++i) controls.push_back(gate.control(i));
    tape.actuators.push_back(h.actuators);
    tape.controls.push_back(controls);
    coupling::OwnSample m_next, h_next;
    mechanics.step(n, {nullptr, &tape.actuators.back()}, controls, m_next);
    hydraulics.step(n, {&m.mechanism, nullptr}, controls, h_next);
    m = m_next;
    h = h_next;
  }
  return tape;
}

// A free mechanism: Runge-Kutta steps from a start, of 1 ms or of the length that segments need.
class Falling {
 public:
  explicit Falling(multibody::MechanicsDef def)
      : h_(def.segmented_bodies.empty() ? kH.seconds() : def.max_substep),
        model_(build(def)),
        ws_(model_),
        start_(start_state(model_)) {
    moving_ = start_;
  }
  double time(int steps) {
    multibody::copy_state(start_, moving_);
    const double begin = thread_seconds();
    for (int i = 0; i < steps; ++i) is_right_ = advance_free(model_, moving_, ws_, h_) && is_right_;
    return (thread_seconds() - begin) / steps;
  }
  [[nodiscard]] std::uint64_t hash() const {
    StateHash hash;
    multibody::add_to_hash(model_, moving_, hash);
    return hash.digest();
  }
  [[nodiscard]] bool is_right() const { return is_right_ && multibody::is_finite(moving_); }

 private:
  static multibody::Model build(multibody::MechanicsDef& def) {
    def.contacts.clear();
    def.shapes.clear();
    return multibody::build_model(def);
  }
  double h_;  // s
  multibody::Model model_;
  multibody::Workspace ws_;
  multibody::State start_, moving_;
  bool is_right_ = true;
};

// booms hinged end to end about their z, the first in Ground; `bending` of them with two modes
multibody::MechanicsDef chain(int bending) {
  multibody::MechanicsDef def;
  const auto modes = jib_modes(20, 2, flex::GeometricStiffening::none);
  const slew::Triple tip = {-6.5, 0.02904, 0.1507};
  std::string parent = "Ground";
  for (int i = 0; i < 5; ++i) {
    const std::string name = "Boom" + std::to_string(i);
    const slew::Triple place = i == 0 ? slew::Triple{} : tip;
    def.bodies.push_back({.name = name, .relative_to = parent, .position = place});
    multibody::take_mass(*modes, def.bodies.back());
    def.joints.push_back({.name = "J" + std::to_string(i), .body1 = parent, .point1 = place, .body2 = name});
    if (i < bending) {
      def.bodies.back().type = multibody::BodyType::flexible;
      def.flexible_bodies.push_back(
          {.body = name, .modes = modes, .relative_damping = {0.005}, .start = std::vector<double>(2)});
    }
    parent = name;
  }
  return def;
}

struct Crane {
  explicit Crane(const Boom& boom)
      : name(boom.name), scene(crane(boom)), mechanics(scene), tape(record(scene, mechanics)), alone(scene.mechanics) {}

  void run() {
    mechanics.reset();
    coupling::OwnSample sample;
    static_cast<void>(mechanics.first_sample(sample));
    static_cast<void>(mechanics.start({nullptr, &tape.actuators[0]}, sample));
    iterations = 0;
    const double begin = thread_seconds();
    for (std::size_t i = 0; i < tape.controls.size(); ++i) {
      const auto n = static_cast<StepIndex>(i);
      iterations += mechanics.step(n, {nullptr, &tape.actuators[i]}, tape.controls[i], sample).iterations;
    }
    node_times.push_back((thread_seconds() - begin) / kMilliseconds);
    alone_times.push_back(alone.time(200));
  }

  std::string name;
  scene::Scene scene;
  mechanics_node::MechanicsSubsystem mechanics;
  Tape tape;
  Falling alone;
  double iterations = 0;  // iterations of the ports' laws in the last run
  std::vector<double> node_times{}, alone_times{};
};

int print_tables() {
  std::vector<std::unique_ptr<Crane>> cranes;
  for (const Boom& boom : booms()) cranes.push_back(std::make_unique<Crane>(boom));
  std::vector<std::unique_ptr<Falling>> chains;
  std::vector<std::vector<double>> chain_times(3);
  for (const int bending : {0, 1, 5}) chains.push_back(std::make_unique<Falling>(chain(bending)));
  for (int round = 0; round < kRounds; ++round) {
    for (const auto& crane : cranes) crane->run();
    for (std::size_t i = 0; i < chains.size(); ++i) chain_times[i].push_back(chains[i]->time(1000));
  }
  bool is_right = true;
  fmt::print("| crane, jib boom | mechanics [us per ms] | over rigid | iterations of the ports' laws per ms |");
  fmt::print(" RK4 step alone [us] | over rigid |\n|---|---|---|---|---|---|\n");
  const double node = median(cranes[0]->node_times), alone = median(cranes[0]->alone_times);
  for (const auto& crane : cranes) {
    const double own = median(crane->node_times), bare = median(crane->alone_times);
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", crane->name, own * 1e6, own / node,
               crane->iterations / kMilliseconds, bare * 1e6, bare / alone);
    is_right = is_right && crane->alone.is_right();
  }
  fmt::print("\n| chain of five booms, bending | RK4 step [us] | over rigid |\n|---|---|---|\n");
  const char* const kBending[] = {"none", "one", "all"};
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const double own = median(chain_times[i]);
    fmt::print("| {} | {:.2f} | {:.2f} |\n", kBending[i], own * 1e6, own / median(chain_times[0]));
    is_right = is_right && chains[i]->is_right();
  }
  if (!is_right) fmt::print(stderr, "a step was not right\n");
  return is_right ? 0 : 1;
}

int run_node(const std::string& name, int times) {
  for (const Boom& boom : booms()) {
    if (boom.name != name) continue;
    Crane crane(boom);
    for (int i = 0; i < times; ++i) crane.run();
    fmt::print("{:.2f} iterations of the ports' laws per ms\n", crane.iterations / kMilliseconds);
    return 0;
  }
  return 2;
}

int run_steps(const std::string& name, int steps) {
  const auto run = [&](multibody::MechanicsDef def) {
    Falling mechanism(std::move(def));
    static_cast<void>(mechanism.time(steps));
    fmt::print("{:016x}\n", mechanism.hash());
    return mechanism.is_right() ? 0 : 1;
  };
  for (const int bending : {0, 1, 5}) {
    if (name == "chain_" + std::to_string(bending)) return run(chain(bending));
  }
  for (const Boom& boom : booms()) {
    if (boom.name == name) return run(crane(boom).mechanics);
  }
  fmt::print(stderr, "no mechanism '{}'; known: chain_0, chain_1, chain_5", name);
  for (const Boom& boom : booms()) fmt::print(stderr, ", {}", boom.name);
  fmt::print(stderr, "\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "--steps") == 0) return run_steps(argv[2], std::atoi(argv[3]));
  if (argc == 4 && std::strcmp(argv[1], "--node") == 0) return run_node(argv[2], std::atoi(argv[3]));
  if (argc == 1) return print_tables();
  fmt::print(stderr, "usage: flexible_cost [--steps NAME N | --node NAME N]\n");
  return 2;
}
