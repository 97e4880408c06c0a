// SPDX-License-Identifier: Apache-2.0
// Counts the flags that the steps of the two physics nodes report (core/step_report.h), sample by sample: in a live
// session, while it is recorded, or from a recording.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/step_report.h"
#include "core/time.h"
#include "transport/wire.h"

namespace slew::node {

// Flags: not converged, sub-step budget, clamp, energy from the coupling, cavitation and pressures beyond the oil's law
// with the volume's number, deflections that are not small; and steps of a free-running node without a partner's
// sample. End stops and open relief valves occur in sound runs too and are left out.
class FlagCounter {
 public:
  static constexpr std::array kFlags = {
      StepFlag::not_converged,           StepFlag::step_budget, StepFlag::clamp_active,   StepFlag::late_input,
      StepFlag::coupling_creates_energy, StepFlag::cavitating,  StepFlag::beyond_oil_law, StepFlag::large_deflection};

  struct Seen {
    std::uint64_t steps = 0;
    StepIndex first = 0;
    std::int32_t offender = -1;  // volume, sensor or contact: the first one that a step names
  };
  struct Counts {
    std::array<Seen, kFlags.size()> seen;  // in the order of kFlags
    std::uint64_t steps = 0, late = 0;     // late: steps that continued from a model of the partner
    StepIndex longest = 0;                 // late steps in a row
    std::uint32_t lost = 0;                // samples that no step used
    std::uint64_t missed = 0;              // samples that did not arrive here, between two that did
    StepIndex begin = 0, step = 0;         // steps of the first and of the newest sample
    std::uint32_t epoch = 0;
    bool has_sample = false;
  };

  // Ignores repeated samples of a role, and samples that arrive after a later one.
  void take(const wire::Header& header, const wire::SampleState& state);

  [[nodiscard]] bool has_samples() const noexcept { return !of_.empty(); }
  // No sample arrived after a later one of its role.
  [[nodiscard]] bool is_in_order() const noexcept { return is_in_order_; }
  // Samples from the session's first step to the last sample received here, less those received.
  [[nodiscard]] std::uint64_t missed(StepIndex begin) const;
  [[nodiscard]] const std::map<wire::Role, Counts>& by_role() const noexcept { return of_; }

  // All counts as one line, and back; none: the text is no such line.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] static std::optional<FlagCounter> of_text(const std::string& text);

 private:
  static void take_lateness(const wire::Header& header, const wire::SampleState& state, Counts& counts);

  std::map<wire::Role, Counts> of_;
  bool is_in_order_ = true;
};

}  // namespace slew::node
