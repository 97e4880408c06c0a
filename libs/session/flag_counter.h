// Counts the flags of the physics nodes' steps (core/step_report.h), sample by sample, in a live session or a
// recording. One sentence for each flag that a user must see, with the first step that raised it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/time.h"
#include "scene/scene.h"
#include "transport/wire.h"

namespace slew::session {

// Flags: not converged, sub-step budget, clamp, energy from the coupling, cavitation and pressures beyond the oil's law
// with the volume's name, deflections that are not small; and steps of a free-running node without a partner's sample.
// End stops and open relief valves occur in sound runs too and are left out.
class FlagCounter {
 public:
  static constexpr std::size_t kFlags = 8;

  // Repeated samples of a role are ignored.
  void take(const wire::Header& header, const wire::SampleState& state);

  [[nodiscard]] bool has_samples() const noexcept { return !of_.empty(); }
  // Samples between the session's first step and the last sample that did not arrive here.
  [[nodiscard]] std::uint64_t missed(StepIndex begin) const;
  // volumes: names, in the order of the scene.
  [[nodiscard]] std::vector<std::string> sentences(SimDuration step, const std::vector<std::string>& volumes) const;

 private:
  struct Seen {
    std::uint64_t steps = 0;
    StepIndex first = 0;
    std::int32_t volume = -1;  // the first one that a step names
  };
  struct Counts {
    std::array<Seen, kFlags> seen;
    std::uint64_t steps = 0, late = 0;  // late: steps that continued the partner model
    StepIndex longest = 0;              // late steps in a row
    std::uint32_t lost = 0;             // samples that no step used
    std::uint64_t missed = 0;           // samples that did not arrive here, between two that did
    StepIndex begin = 0, step = 0;      // first and newest sample
    std::uint32_t epoch = 0;
    bool has_sample = false;
  };
  static void take_lateness(const wire::Header& header, const wire::SampleState& state, Counts& counts);

  std::map<wire::Role, Counts> of_;
};

[[nodiscard]] std::vector<std::string> volume_names(const scene::Scene& scene);

}  // namespace slew::session
