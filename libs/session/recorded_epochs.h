// SPDX-License-Identifier: Apache-2.0
// Where the epochs of a recording begin: with INIT, or with the states of a step.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/time.h"
#include "io_node/saved_session.h"
#include "recording/reader.h"

namespace slew::session {

class RecordedEpochs {
 public:
  using States = std::vector<io_node::SavedState>;

  // Reads the states. reader: outlives this. Throws Failure.
  explicit RecordedEpochs(const recording::Reader& reader);

  // A recording may begin later than its session. Both throw Failure.
  [[nodiscard]] std::uint32_t first() const;
  [[nodiscard]] std::uint32_t last() const;
  // The states with which the epoch begins: no tick is older. Null: it begins with INIT.
  [[nodiscard]] const States* first_states(std::uint32_t epoch) const;
  // The first states behind a step that are there of all roles. Null: there are none.
  [[nodiscard]] const States* states_behind(std::uint32_t epoch, StepIndex step) const;

 private:
  void read_states();
  void read_first_ticks();

  const recording::Reader& reader_;
  std::map<std::uint32_t, std::map<StepIndex, States>> states_;  // by epoch and step
  std::map<std::uint32_t, StepIndex> first_ticks_;               // first step that has a tick, by epoch
};

}  // namespace slew::session
