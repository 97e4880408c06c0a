// SPDX-License-Identifier: Apache-2.0
// Selected variables of a session as curves, taken block by block from a recording or while the
// session runs.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/time.h"
#include "plotting/series.h"
#include "transport/wire.h"

namespace slew::session {

enum class Units : std::uint8_t { si, display };

class Curves {
 public:
  // patterns: of the variables that are kept. step: the session's communication step.
  Curves(std::vector<std::string> patterns, SimDuration step) : patterns_(std::move(patterns)), step_(step) {}

  // Names come before values: a block whose writer has not published all its names waits for them.
  void take(const wire::VariableDirectory& directory);
  // No further name comes.
  void end_names() noexcept { has_all_names_ = true; }
  // time: of the block [s].
  void take(const wire::VariableBlock& block, double time);

  // Every block was taken behind its names and in the order of steps, all of one epoch.
  [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }
  // All variables of the session, in the order of roles and of their places.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool has(const std::string& name) const { return known_.contains(name); }
  // Those that the patterns name, in their order. Pre-condition: every pattern fits a name, and is one of those kept.
  [[nodiscard]] std::vector<plotting::Series> select(std::span<const std::string> patterns, Units units) const;

 private:
  using Place = std::pair<wire::Role, std::uint32_t>;  // writer and index
  struct Variable {
    Place place;
    std::string unit;
  };
  struct Writer {
    std::uint32_t named = 0, total = 0;
    bool has_directory = false;
    std::uint32_t epoch = 0;
    StepIndex newest = kJoinStep;
    StepIndex between = 0;  // steps from one block to the next
    bool has_block = false;
    std::vector<std::pair<wire::VariableBlock, double>> early;
  };
  void keep(const wire::VariableBlock& block, double time);

  std::vector<std::string> patterns_;
  SimDuration step_;
  std::map<std::string, Variable> known_;
  std::map<Place, plotting::Series> curves_;  // in SI
  std::map<wire::Role, Writer> writers_;
  bool has_all_names_ = false;
  bool is_sound_ = true;
};

}  // namespace slew::session
