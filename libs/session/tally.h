// SPDX-License-Identifier: Apache-2.0
// Beside the view of a session, for the report of a run: flags of the physics samples, curves of chosen variables, and
// a digest of all blocks of variables.
#pragma once

#include <cstdint>
#include <utility>

#include "core/state_hash.h"
#include "node/flag_counter.h"
#include "observer/session_view.h"
#include "session/curves.h"

namespace slew::session {

class Tally final : public observer::Receiver {
 public:
  // curves: without contents; they name the variables that are kept.
  explicit Tally(Curves curves) : curves_(curves), empty_curves_(std::move(curves)) {}

  // What the physics samples reported, as far as the transport reads their topics.
  [[nodiscard]] const node::FlagCounter& flags() const noexcept { return flags_; }
  [[nodiscard]] const Curves& curves() const noexcept { return curves_; }
  // Of all blocks of variables that have come, whatever their order.
  [[nodiscard]] std::uint64_t variables_digest() const noexcept { return variables_digest_; }
  // No further name of a variable comes.
  void end_names() noexcept { curves_.end_names(); }

  void begin_session() override {
    flags_ = {};
    curves_ = empty_curves_;
    variables_digest_ = 0;
  }
  void take_directory(const wire::VariableDirectory& directory) override { curves_.take(directory); }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte> bytes, double time) override {
    variables_digest_ += digest_of(bytes);
    curves_.take(block, time);
  }
  void take_sample(const wire::Header& header, const wire::SampleState& state) override { flags_.take(header, state); }

 private:
  node::FlagCounter flags_;
  Curves curves_, empty_curves_;
  std::uint64_t variables_digest_ = 0;
};

}  // namespace slew::session
