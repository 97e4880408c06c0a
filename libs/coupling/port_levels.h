// SPDX-License-Identifier: Apache-2.0
// The coupling level of every port of a session; each node keeps its own copy.
//
// A port has a level of its own or follows the session's. Levels change at step boundaries, by parameter changes that
// all nodes apply at the same step: "session.coupling" (a Level) and "<port>.coupling" (a PortLevel). Both sides can
// change at once because a sample has the same meaning at every level: a level only selects how a side uses it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "coupling/level.h"

namespace slew::coupling {

class PortLevels {
 public:
  struct Port {
    std::string name;
    PortLevel level = PortLevel::session;
  };

  // ports: in port order.
  PortLevels(Level session, std::vector<Port> ports);

  [[nodiscard]] Level operator[](std::size_t port) const noexcept { return levels_[port]; }
  // The lowest level of any port in the enum's order; without ports the session's.
  [[nodiscard]] Level lowest() const noexcept;

  // Applies a change. True if the path is the session's or a port's and the value is the number of one of its levels.
  // No allocation.
  bool change(std::string_view path, double value) noexcept;
  // Restores the levels of the construction.
  void reset() noexcept;

  // Adds the differences from the construction.
  void add_to(StateHash& hash) const noexcept;
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  void latch() noexcept;

  Level session_, first_session_;
  std::vector<Port> ports_;
  std::vector<PortLevel> first_;
  std::vector<Level> levels_;  // by port, in force
};

}  // namespace slew::coupling
