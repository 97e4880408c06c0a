#include "session/flag_counter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/display.h"
#include "core/step_report.h"
#include "node/identity.h"

namespace slew::session {
namespace {

struct Meaning {
  StepFlag flag;
  const char* what;
  const char* remedy;
};

constexpr std::array<Meaning, FlagCounter::kFlags> kMeanings = {{
    {StepFlag::not_converged, "an iteration reached its limit and its residual was accepted", "choose a smaller step"},
    {StepFlag::step_budget, "the sub-step budget was used up and the error of the last one accepted",
     "raise hydraulics.substep_budget or the tolerances"},
    {StepFlag::clamp_active, "a quantity was held at a bound of its validity", "look at the pressures and the inputs"},
    {StepFlag::late_input, "a sample was later than the horizon of the partner model",
     "look for load on the machine or the network, or choose session.mode: lockstep"},
    {StepFlag::coupling_creates_energy, "the coupling created energy, so the run may be unstable",
     "choose a smaller session.step, or level two for a port that has another"},
    {StepFlag::cavitating, "a volume cavitated", "look at the pressures near zero"},
    {StepFlag::beyond_oil_law, "a pressure was beyond the range of the oil's law (1000 bar)",
     "limit it: a relief valve on the line, a lower load or setting"},
    {StepFlag::large_deflection, "a flexible body was bent by more than a tenth of its length",
     "its theory is one of small deflections: take the numbers for estimates"},
}};

// Hydraulics' samples: the offender is a volume when no flag with another kind of offender is up.
bool names_volume(StepFlag flag, const wire::SampleState& state) {
  constexpr auto kOthers = static_cast<std::uint32_t>(StepFlag::not_converged) |
                           static_cast<std::uint32_t>(StepFlag::step_budget) |
                           static_cast<std::uint32_t>(StepFlag::non_finite);
  const bool is_beyond = (state.flags & static_cast<std::uint32_t>(StepFlag::beyond_oil_law)) != 0;
  if ((state.flags & kOthers) != 0) return false;
  return flag == StepFlag::beyond_oil_law || (flag == StepFlag::cavitating && !is_beyond);
}

}  // namespace

void FlagCounter::take(const wire::Header& header, const wire::SampleState& state) {
  if (header.phase != wire::Phase::running) return;
  Counts& counts = of_[header.role];
  const bool is_same_epoch = counts.has_sample && header.epoch == counts.epoch;
  // a repeated sample, or one of an earlier epoch
  if (counts.has_sample && (header.epoch < counts.epoch || (is_same_epoch && header.step <= counts.step))) return;
  if (is_same_epoch) counts.missed += static_cast<std::uint64_t>(header.step - counts.step - 1);
  if (!counts.has_sample) counts.begin = header.step;
  counts.has_sample = true;
  counts.epoch = header.epoch;
  counts.step = header.step;
  take_lateness(header, state, counts);
  for (std::size_t i = 0; i < kMeanings.size(); ++i) {
    if ((state.flags & static_cast<std::uint32_t>(kMeanings[i].flag)) == 0) continue;
    Seen& entry = counts.seen[i];
    if (entry.steps++ == 0) entry.first = header.step;
    const bool is_named = header.role == wire::Role::hydraulics && names_volume(kMeanings[i].flag, state);
    if (entry.volume < 0 && is_named) entry.volume = state.offender;
  }
}

void FlagCounter::take_lateness(const wire::Header& header, const wire::SampleState& state, Counts& counts) {
  if (header.step == 0) return;
  ++counts.steps;
  counts.lost = state.lost;
  if (state.quality == coupling::Quality::ok) return;
  ++counts.late;
  counts.longest = std::max(counts.longest, header.step - 1 - state.used_step);
}

std::uint64_t FlagCounter::missed(StepIndex begin) const {
  std::uint64_t missed = 0;
  for (const auto& [role, counts] : of_) {
    missed += counts.missed + static_cast<std::uint64_t>(std::max<StepIndex>(0, counts.begin - begin - 1));
  }
  return missed;
}

std::vector<std::string> FlagCounter::sentences(SimDuration step, const std::vector<std::string>& volumes) const {
  std::vector<std::string> sentences;
  for (const auto& [role, counts] : of_) {
    if (counts.late == 0 && counts.lost == 0) continue;
    sentences.push_back(
        fmt::format("{}: free-running, {} of {} without the partner's sample ({:.3g} %), {} in a row at "
                    "most; {} never used",
                    node::to_text(role), counts.late, counted(counts.steps, "step", "steps"),
                    100.0 * static_cast<double>(counts.late) / static_cast<double>(counts.steps), counts.longest,
                    counted(counts.lost, "sample", "samples")));
  }
  for (const auto& [role, counts] : of_) {
    for (std::size_t i = 0; i < kMeanings.size(); ++i) {
      const Seen& entry = counts.seen[i];
      if (entry.steps == 0) continue;
      const bool is_named = entry.volume >= 0 && static_cast<std::size_t>(entry.volume) < volumes.size();
      const std::string name = is_named ? volumes[static_cast<std::size_t>(entry.volume)] + ": " : "";
      sentences.push_back(fmt::format("{}: {}{} in {}, first at {}; {}", node::to_text(role), name, kMeanings[i].what,
                                      counted(entry.steps, "step", "steps"),
                                      duration_text(static_cast<double>(entry.first) * step.seconds()),
                                      kMeanings[i].remedy));
    }
  }
  return sentences;
}

std::vector<std::string> volume_names(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) names.push_back(volume.name);
  return names;
}

}  // namespace slew::session
