// SPDX-License-Identifier: Apache-2.0
// `slewring export --lcm`: a recorded session as an LCM event log.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/settings.h"
#include "observer/observer.h"

namespace slew::bridge {

// Writes a session that a view is fed with as an LCM event log. Times are those of the session; the first event is at
// 0.
class LogExport {
 public:
  // write: takes the next bytes of the log. Throws Failure.
  LogExport(const Settings& settings, const std::string& session, SceneView scene,
            std::function<void(std::string_view)> write);
  ~LogExport();

  // Leaves out blocks outside; both included.
  void choose(std::uint64_t from_ns, std::uint64_t to_ns);
  // Throws Failure from its calls when the session was reset.
  [[nodiscard]] observer::Receiver& receiver(const observer::SessionView& view);
  [[nodiscard]] std::int64_t events() const noexcept;
  // Steps of signal lists of which the recording has not all values.
  [[nodiscard]] std::uint64_t incomplete() const noexcept;
  // Inputs of the scene whose raw value the recording does not have.
  [[nodiscard]] std::vector<std::string> missing_inputs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slew::bridge
