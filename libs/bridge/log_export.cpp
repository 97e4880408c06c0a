// SPDX-License-Identifier: Apache-2.0
#include "bridge/log_export.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "bridge/outgoing.h"
#include "core/failure.h"
#include "lcm_log/event_log.h"

namespace slew::bridge {
namespace {

constexpr std::int64_t kDirectoryEveryNs = 1'000'000'000;
constexpr const char* kOfRecording = "recording";  // controller in an exported log

}  // namespace

struct LogExport::State final : observer::Receiver {
  State(const Settings& settings, const std::string& session, SceneView of_scene,
        std::function<void(std::string_view)> write_bytes)
      : scene(std::move(of_scene)),
        write(std::move(write_bytes)),
        prefix(prefix_of(settings, session, read_lists(settings))),
        outgoing(
            prefix, read_lists(settings), settings.every,
            [this](const std::string& channel, std::string_view bytes, StepIndex step) { put(channel, bytes, step); }),
        inputs(scene.channels.size()) {
    check_every(settings, scene);
  }

  struct RecordedInput {
    std::optional<std::uint32_t> index;  // of its raw value among io's variables
    std::optional<double> value{};
    StepIndex step = 0;
  };

  void put(const std::string& channel, std::string_view bytes, StepIndex at_step) {
    line.clear();
    writer.add({(at_step * step_ns + 500) / 1000, channel, std::as_bytes(std::span<const char>(bytes))}, line);
    write(line);
  }
  void take_directory(const wire::VariableDirectory& directory) override {
    outgoing.take(directory);
    for (std::size_t i = 0; i < directory.entries.size(); ++i) {
      if (directory.header.role != wire::Role::io) continue;
      for (std::size_t k = 0; k < inputs.size(); ++k) {
        if (directory.entries[i].name == scene.channels[k].name + ".raw")
          inputs[k].index = directory.first + static_cast<std::uint32_t>(i);
      }
    }
  }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) override;
  void take_inputs(const wire::VariableBlock& block);

  SceneView scene;
  std::function<void(std::string_view)> write;
  std::string prefix;
  Outgoing outgoing;
  std::vector<RecordedInput> inputs;  // by channel of the scene
  lcm_log::EventLogWriter writer;
  const observer::SessionView* view = nullptr;
  std::int64_t step_ns = 0;
  std::int64_t from_ns = 0, to_ns = INT64_MAX;
  std::int64_t next_directory_ns = 0;
  std::optional<std::uint32_t> epoch;
  std::int64_t sequence = 0;
  std::string line, input_bytes;
};

void LogExport::State::take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) {
  step_ns = view->session().step_ns;
  const StepIndex step = block.header.step;
  // the range is of the recording's time, which goes on over a reset; the log has the session's
  const std::int64_t recorded_ns = std::llround(time * 1e9);
  if (recorded_ns < from_ns || recorded_ns > to_ns) return;
  if (epoch && block.header.epoch != *epoch) {
    throw Failure(
        ExitCode::bad_input,
        "the session was reset or loaded on the way, so its time is no one line; nothing was written; choose the time "
        "of one epoch");
  }
  if (!epoch) check_names(outgoing.lists(), *view, "the recording");
  epoch = block.header.epoch;
  const std::int64_t time_ns = step * step_ns;
  if (writer.count() == 0) outgoing.publish_directory(0);
  if (time_ns >= next_directory_ns) {
    next_directory_ns = (time_ns / kDirectoryEveryNs + 1) * kDirectoryEveryNs;
    outgoing.publish_directory(step);
    outgoing.publish_health(*view, step);
  }
  outgoing.take(block, time);
  if (block.header.role == wire::Role::io) take_inputs(block);
}

// At each change, and often enough that a value that stays is no silence.
void LogExport::State::take_inputs(const wire::VariableBlock& block) {
  const StepIndex repeat = std::max<StepIndex>(1, scene.neutral_after.ns / 2 / step_ns);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    RecordedInput& input = inputs[i];
    if (!input.index || *input.index < block.first) continue;
    const std::size_t at = *input.index - block.first;
    if (at >= block.values.size()) continue;
    const double value = block.values[at];
    const StepIndex step = block.header.step;
    if (!std::isfinite(value) || (input.value == value && step - input.step < repeat)) continue;
    input.value = value;
    input.step = step;
    encode(lcm_log::Input{kOfRecording, 0, sequence++, scene.channels[i].name, value, kJoinStep}, input_bytes);
    put(prefix + "_INPUT", input_bytes, step);
  }
}

LogExport::LogExport(const Settings& settings, const std::string& session, SceneView scene,
                     std::function<void(std::string_view)> write)
    : state_(std::make_unique<State>(settings, session, std::move(scene), std::move(write))) {}

LogExport::~LogExport() = default;

void LogExport::choose(std::uint64_t from_ns, std::uint64_t to_ns) {
  state_->from_ns = static_cast<std::int64_t>(std::min<std::uint64_t>(from_ns, INT64_MAX));
  state_->to_ns = static_cast<std::int64_t>(std::min<std::uint64_t>(to_ns, INT64_MAX));
}

observer::Receiver& LogExport::receiver(const observer::SessionView& view) {
  state_->view = &view;
  return *state_;
}

std::int64_t LogExport::events() const noexcept {
  return state_->writer.count();
}

std::uint64_t LogExport::incomplete() const noexcept {
  return state_->outgoing.incomplete();
}

std::vector<std::string> LogExport::missing_inputs() const {
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < state_->inputs.size(); ++i) {
    if (!state_->inputs[i].index) missing.push_back(state_->scene.channels[i].name);
  }
  return missing;
}

}  // namespace slew::bridge
