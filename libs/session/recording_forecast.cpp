// SPDX-License-Identifier: Apache-2.0
#include "session/recording_forecast.h"

#include <fmt/format.h>

#include <cmath>

#include "io_node/scene_config.h"
#include "io_node/session_variables.h"
#include "node/subsystem_factory.h"
#include "transport/roles.h"
#include "transport/wire.h"

namespace slew::session {
namespace {

using scene::RecordingCoding;
using scene::StepsKept;
using wire::Role;

// Bytes in the file, measured over the first 60 s of the truck crane.
struct Cost {
  double tick;     // without its hash, with its place in the index, where there is one
  double message;  // head of a sample
  double number;   // of a sample
  double hashes;   // share of a step in a writer's digests
  double block;    // head of a block of variables
};
constexpr double kHash = 8;  // of a tick, recorded with all steps
constexpr Cost kOfZstd = {.tick = 26, .message = 36, .number = 6.3, .hashes = 2.5, .block = 36};
constexpr Cost kOfColumns = {.tick = 2.5, .message = 11, .number = 2.2, .hashes = 0.5, .block = 3};

// Bytes of a value of a variable, measured with 24 and with all bits.
double bytes_of_value(RecordingCoding coding, double bits) {
  constexpr double kSingle = 24;
  const bool has_columns = coding == RecordingCoding::columns;
  const double of_single = has_columns ? 0.37 : 1.4, of_all = has_columns ? 1.33 : 3.2;
  if (bits <= kSingle) return of_single * bits / kSingle;
  return of_single + (of_all - of_single) * (bits - kSingle) / (scene::kAllBits - kSingle);
}

std::string size_text(double bytes) {
  const auto [unit, factor] = bytes >= 1e9   ? std::pair("GB", 1e9)
                              : bytes >= 1e6 ? std::pair("MB", 1e6)
                                             : std::pair("kB", 1e3);
  const double size = bytes / factor;
  return size < 10 ? fmt::format("{:.2g} {}", size, unit) : fmt::format("{:.0f} {}", size, unit);
}

constexpr const char* kStepsNames[] = {"all", "ticks", "none"};

}  // namespace

RecordedNumbers recorded_numbers(const scene::Scene& scene, const DirectSession& session) {
  RecordedNumbers numbers;
  const auto ports = static_cast<double>(scene.ports.size());
  const double exchanges = 1.0 / static_cast<double>(scene.session.exchange_every);
  numbers.messages = 1;
  if (scene.has_mechanics()) {
    numbers.messages += exchanges;
    numbers.samples += exchanges * (9 * ports + ports * ports);
  }
  if (scene.has_hydraulics()) {
    numbers.messages += exchanges;
    numbers.samples += exchanges * 14 * ports;
  }
  for (const scene::FlexibleBody& body : scene.flexible_bodies) {
    constexpr double kOfFrame = 13;
    const double modes = std::sqrt(static_cast<double>(body.stiffness.size()));
    numbers.samples += (5 * modes + kOfFrame) / scene.flexible_every();
  }
  const auto add = [&numbers](std::size_t variables) {
    if (variables == 0) return;
    numbers.variables += static_cast<double>(variables);
    numbers.blocks += std::ceil(static_cast<double>(variables) / static_cast<double>(wire::kMaxVariablesPerBlock));
  };
  for (const Role role : transport::physics_roles()) {
    if (session.subsystem(role) != nullptr) add(node::published_variables(scene, *session.subsystem(role)).size());
  }
  std::vector<std::string> inputs;
  for (const scene::InputDef& input : scene.inputs) inputs.push_back(input.name);
  add(io_node::own_variables(inputs, io_node::required_roles(scene, io_node::Recording::required)).size());
  return numbers;
}

double recorded_bytes(const scene::Scene& scene, const RecordedNumbers& numbers) {
  const scene::RecordingDef& recording = scene.recording;
  const Cost& cost = recording.coding == RecordingCoding::columns ? kOfColumns : kOfZstd;
  double of_step = 0;
  if (recording.steps != StepsKept::none) of_step += cost.tick;
  const double samples = numbers.messages - 1;
  if (recording.steps == StepsKept::all) of_step += kHash + samples * cost.message + numbers.samples * cost.number;
  if (recording.steps == StepsKept::ticks) of_step += samples * cost.hashes;
  const double of_block =
      numbers.blocks * cost.block +
      numbers.variables * bytes_of_value(recording.coding, static_cast<double>(recording.significant_bits));
  of_step += of_block / static_cast<double>(recording.every);
  return of_step / scene.session.step;
}

std::string forecast_text(const scene::Scene& scene, double bytes_per_second) {
  constexpr double kHour = 3600;
  const double duration = scene.session.duration;
  return fmt::format(
      "recording: about {}{} an hour (recording.steps: {})",
      duration > 0 ? fmt::format("{} for {:.6g} s, ", size_text(bytes_per_second * duration), duration) : std::string(),
      size_text(bytes_per_second * kHour), kStepsNames[static_cast<std::size_t>(scene.recording.steps)]);
}

}  // namespace slew::session
