// SPDX-License-Identifier: Apache-2.0
// Cost of the truck crane in one process: rigid, with two modes of its jib boom, and with both booms of eight modes and
// its cylinders as bodies, whose bag stands on the ground for a while (full) or hangs (full_in_the_air). Each
// subsystem's step, both coupled in one thread, and the whole session over the bus of one process (ticks, encoding,
// gate, no recorder), per simulated millisecond at H = 1 ms, over the scene's own manoeuvre.
//
//   crane_step --benchmark_min_time=2
#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "build_paths.h"
#include "flex_node/flex_subsystem.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "io_node/io_node.h"
#include "io_node/scene_config.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "node/physics_node.h"
#include "scene/scene.h"
#include "scene/script.h"
#include "transport/in_process/in_process_bus.h"

namespace {

using namespace slew;

enum class Boom { rigid, two_modes, full, full_in_the_air };

scene::Scene load(const char* name, const std::vector<std::string>& overrides = {}) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR "/scenes/") + name + ".yaml", overrides);
}

scene::Scene load(Boom boom) {
  switch (boom) {
    case Boom::rigid:
      return load("truck_crane");
    case Boom::two_modes:
      return load("truck_crane_flexible");
    case Boom::full:
      return load("truck_crane_full");
    case Boom::full_in_the_air:
      break;
  }
  // the levers of truck_crane.yaml
  return load("truck_crane_full", {"script.inputs={Input_Lift: [[0 s, 0], [1 s, 1], [5.5 s, 0]], "
                                   "Input_Slew: [[0 s, 0], [5 s, -1], [12 s, 0]]}"});
}

const scene::Scene& crane(Boom boom) {
  static std::map<Boom, scene::Scene> loaded;
  const auto found = loaded.find(boom);
  return found != loaded.end() ? found->second : loaded.emplace(boom, load(boom)).first->second;
}

constexpr SimDuration kH = milliseconds(1);
constexpr StepIndex kSteps = 6000;  // rest, lift, lift and slew; full: rest, lower, stand, lift

io_node::IoConfig io_config(Boom boom) {
  return io_node::make_config(crane(boom), "benchmark", io_node::Recording::none);
}

// One run with everything that either side was given: replayed to one side alone, it does the same again.
struct Tape {
  std::vector<coupling::MechanismSample> mechanism;
  std::vector<coupling::ActuatorSample> actuators;
  std::vector<std::vector<double>> controls;
};

// starts both subsystems; their samples 0
void start(coupling::Subsystem& mechanics, coupling::Subsystem& hydraulics, coupling::OwnSample& m,
           coupling::OwnSample& h) {
  static_cast<void>(mechanics.first_sample(m));
  static_cast<void>(hydraulics.start({&m.mechanism, nullptr}, h));
  static_cast<void>(mechanics.start({nullptr, &h.actuators}, m));
}

Tape record(Boom boom) {
  Tape t;
  mechanics_node::MechanicsSubsystem mechanics(crane(boom));
  hydraulics_node::HydraulicsSubsystem hydraulics(crane(boom));
  const scene::ScriptPlayer script(crane(boom));
  const io_node::IoConfig config = io_config(boom);
  io_node::InputGate gate(config.channels, config.gate(), kH);
  std::vector<SignalCourse> raw(gate.size());
  coupling::OwnSample m, h;
  start(mechanics, hydraulics, m, h);
  for (StepIndex n = 0; n < kSteps; ++n) {
    for (std::size_t i = 0; i < raw.size(); ++i) script.read_course(i, start_of(n, kH), start_of(n, kH) + kH, raw[i]);
    gate.advance(n, raw, 0);
    std::vector<double> controls;
    for (std::size_t i = 0; i < gate.size(); ++i) controls.push_back(gate.control(i));
    t.mechanism.push_back(m.mechanism);
    t.actuators.push_back(h.actuators);
    t.controls.push_back(controls);
    coupling::OwnSample m_next, h_next;
    mechanics.step(n, {nullptr, &t.actuators.back()}, controls, m_next);
    hydraulics.step(n, {&t.mechanism.back(), nullptr}, controls, h_next);
    m = m_next;
    h = h_next;
  }
  return t;
}

const Tape& tape(Boom boom) {
  static std::map<Boom, Tape> recorded;
  const auto found = recorded.find(boom);
  return found != recorded.end() ? found->second : recorded.emplace(boom, record(boom)).first->second;
}

void report(benchmark::State& state, StepIndex steps_per_iteration) {
  state.counters["per_simulated_ms"] = benchmark::Counter(static_cast<double>(state.iterations() * steps_per_iteration),
                                                          benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// one side, with the other side's samples from the tape
template <typename Side>
void run_side(benchmark::State& state, Boom boom, Side side) {
  const Tape& t = tape(boom);
  for (auto _ : state) {
    state.PauseTiming();
    mechanics_node::MechanicsSubsystem mechanics(crane(boom));
    hydraulics_node::HydraulicsSubsystem hydraulics(crane(boom));
    coupling::OwnSample m, h;
    start(mechanics, hydraulics, m, h);
    state.ResumeTiming();
    for (StepIndex n = 0; n < kSteps; ++n) side(mechanics, hydraulics, n, t, m, h);
  }
  report(state, kSteps);
}

void step_mechanics(coupling::Subsystem& mechanics, coupling::Subsystem&, StepIndex n, const Tape& t,
                    coupling::OwnSample& m, coupling::OwnSample&) {
  const auto i = static_cast<std::size_t>(n);
  mechanics.step(n, {nullptr, &t.actuators[i]}, t.controls[i], m);
}

void step_hydraulics(coupling::Subsystem&, coupling::Subsystem& hydraulics, StepIndex n, const Tape& t,
                     coupling::OwnSample&, coupling::OwnSample& h) {
  const auto i = static_cast<std::size_t>(n);
  hydraulics.step(n, {&t.mechanism[i], nullptr}, t.controls[i], h);
}

void step_both(coupling::Subsystem& mechanics, coupling::Subsystem& hydraulics, StepIndex n, const Tape& t,
               coupling::OwnSample& m, coupling::OwnSample& h) {
  const coupling::MechanismSample mechanism = m.mechanism;
  const auto& controls = t.controls[static_cast<std::size_t>(n)];
  mechanics.step(n, {nullptr, &h.actuators}, controls, m);
  hydraulics.step(n, {&mechanism, nullptr}, controls, h);
}

void BM_Mechanics(benchmark::State& state, Boom boom) {
  run_side(state, boom, step_mechanics);
}
BENCHMARK_CAPTURE(BM_Mechanics, rigid, Boom::rigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Mechanics, two_modes, Boom::two_modes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Mechanics, full, Boom::full)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Mechanics, full_in_the_air, Boom::full_in_the_air)->Unit(benchmark::kMillisecond);

void BM_Hydraulics(benchmark::State& state, Boom boom) {
  run_side(state, boom, step_hydraulics);
}
BENCHMARK_CAPTURE(BM_Hydraulics, rigid, Boom::rigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Hydraulics, two_modes, Boom::two_modes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Hydraulics, full, Boom::full)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Hydraulics, full_in_the_air, Boom::full_in_the_air)->Unit(benchmark::kMillisecond);

void BM_Coupled(benchmark::State& state, Boom boom) {
  run_side(state, boom, step_both);
}
BENCHMARK_CAPTURE(BM_Coupled, rigid, Boom::rigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Coupled, two_modes, Boom::two_modes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Coupled, full, Boom::full)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Coupled, full_in_the_air, Boom::full_in_the_air)->Unit(benchmark::kMillisecond);

// The state after a second of the manoeuvre as bytes, and put back into the same subsystems.
enum class Saving { save, load };

void BM_SavedState(benchmark::State& state, Boom boom, Saving saving) {
  const Tape& t = tape(boom);
  mechanics_node::MechanicsSubsystem mechanics(crane(boom));
  hydraulics_node::HydraulicsSubsystem hydraulics(crane(boom));
  coupling::OwnSample m, h;
  start(mechanics, hydraulics, m, h);
  for (StepIndex n = 0; n < 1000; ++n) step_both(mechanics, hydraulics, n, t, m, h);
  std::vector<std::byte> of_mechanics, of_hydraulics;
  mechanics.save(of_mechanics);
  hydraulics.save(of_hydraulics);
  for (auto _ : state) {
    if (saving == Saving::save) {
      of_mechanics.clear();
      of_hydraulics.clear();
      mechanics.save(of_mechanics);
      hydraulics.save(of_hydraulics);
    } else if (!mechanics.load(of_mechanics, m).is_ok() || !hydraulics.load(of_hydraulics, h).is_ok()) {
      state.SkipWithError("refused");
    }
  }
  state.counters["mechanics_bytes"] = static_cast<double>(of_mechanics.size());
  state.counters["hydraulics_bytes"] = static_cast<double>(of_hydraulics.size());
}
BENCHMARK_CAPTURE(BM_SavedState, save_rigid, Boom::rigid, Saving::save)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_SavedState, save_two_modes, Boom::two_modes, Saving::save)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_SavedState, load_rigid, Boom::rigid, Saving::load)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_SavedState, load_two_modes, Boom::two_modes, Saving::load)->Unit(benchmark::kMicrosecond);

void BM_Session(benchmark::State& state, Boom boom) {
  for (auto _ : state) {
    transport::InProcessBus bus;
    const auto io_end = node::open_transport(wire::Role::io, bus);
    const auto mechanics_end = node::open_transport(wire::Role::mechanics, bus);
    const auto hydraulics_end = node::open_transport(wire::Role::hydraulics, bus);
    io_node::IoConfig config = io_config(boom);
    config.session.pace = Pace::free;
    config.session.window = 4;
    config.name_check = {0};
    config.session.duration = static_cast<double>(kSteps) * kH.seconds();
    io_node::IoNode io(*io_end, std::move(config));
    node::PhysicsNode mechanics(wire::Role::mechanics, *mechanics_end,
                                [boom](const wire::SessionDescription&, node::BuiltSubsystem& built) {
                                  built.subsystem = mechanics_node::make_mechanics_subsystem(crane(boom));
                                  return Status::ok();
                                });
    node::PhysicsNode hydraulics(wire::Role::hydraulics, *hydraulics_end,
                                 [boom](const wire::SessionDescription&, node::BuiltSubsystem& built) {
                                   built.subsystem = hydraulics_node::make_hydraulics_subsystem(crane(boom));
                                   return Status::ok();
                                 });
    std::vector<node::Node*> nodes = {&io, &mechanics, &hydraulics};
    std::unique_ptr<transport::Transport> flex_end;
    std::unique_ptr<node::PhysicsNode> flex;
    if (crane(boom).has_modes()) {
      flex_end = node::open_transport(wire::Role::flex, bus);
      flex = std::make_unique<node::PhysicsNode>(wire::Role::flex, *flex_end,
                                                 [boom](const wire::SessionDescription&, node::BuiltSubsystem& built) {
                                                   built.subsystem = flex_node::make_flex_subsystem(crane(boom));
                                                   return Status::ok();
                                                 });
      nodes.push_back(flex.get());
    }
    if (node::run_together(nodes, {}) != ExitCode::ok) state.SkipWithError("the session failed");
  }
  report(state, kSteps);
}
BENCHMARK_CAPTURE(BM_Session, rigid, Boom::rigid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Session, two_modes, Boom::two_modes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Session, full, Boom::full)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Session, full_in_the_air, Boom::full_in_the_air)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
