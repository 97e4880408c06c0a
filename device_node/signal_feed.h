// SPDX-License-Identifier: Apache-2.0
// Values of a session for a device that shows them: variables, and outputs of the scene.
//
// The values are those of one step: they are made when all variables of that step have arrived, at the earliest `every`
// of the session's time after the ones before; 0: in every published step. A session that stands still makes none.
// Outputs follow every published step, also between.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "observer/session_view.h"
#include "observer/step_values.h"
#include "scene/devices.h"

namespace slew::device_node {

// One value: a variable or an output; neither: 0.
struct FedSignal {
  std::string variable, output;
};

// Values of one step.
struct FedValues {
  double time = 0;  // of the step in the session, s
  std::uint32_t epoch = 0;
  std::span<const double> values;  // one for each signal
};

class SignalFeed {
 public:
  using Show = std::function<void(const FedValues&)>;
  // A switched output has gone on or off in the step of the newest block; pulses are no changes.
  using Change = std::function<void(const scene::SwitchedDef& output, bool is_on)>;

  SignalFeed(const std::vector<FedSignal>& signals, const scene::OutputsDef& outputs, double every, Show show,
             Change change = nullptr);

  // Names of the variables that it needs.
  [[nodiscard]] const std::vector<std::string>& variables() const noexcept { return variables_; }

  void take(const wire::VariableDirectory& directory);
  // time: of the block in the session [s].
  void take(const wire::VariableBlock& block, double time);

  [[nodiscard]] Json counts() const;

 private:
  struct Source {
    enum class Kind : std::uint8_t { none, variable, switched, analog } kind = Kind::none;
    std::size_t index = 0;  // among variables_, switched_ or analog_
  };
  struct Switched {
    scene::SwitchedDef def;
    std::size_t variable = 0;  // among variables_
    devices::SwitchedOutputState state{};
  };
  struct Analog {
    scene::AnalogDef def;
    std::size_t variable = 0;
    devices::AnalogOutputState state{};
  };

  [[nodiscard]] std::size_t need(const std::string& variable);
  [[nodiscard]] Source source_of(const FedSignal& signal, const scene::OutputsDef& outputs);
  void begin_epoch(std::uint32_t epoch);
  void step_outputs(const std::vector<double>& values, double dt);
  [[nodiscard]] double value_of(const Source& source, const std::vector<double>& values) const;

  double every_;
  Show show_;
  Change change_;  // may be empty
  std::vector<std::string> variables_;
  std::vector<Source> sources_;  // by signal
  std::vector<Switched> switched_;
  std::vector<Analog> analog_;
  observer::StepValues values_{0};
  std::vector<double> shown_;
  std::uint32_t epoch_ = 0;
  double last_time_ = 0;  // of the last whole step [s]
  double next_time_ = 0;  // earliest of the next values [s]
  bool has_time_ = false;
};

}  // namespace slew::device_node
