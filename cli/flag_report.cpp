#include "cli/flag_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "cli/display.h"
#include "cli/recorded.h"
#include "core/failure.h"
#include "core/step_report.h"
#include "node/identity.h"
#include "scene/scene.h"
#include "transport/codec.h"
#include "transport/wire.h"

namespace slew::cli {
namespace {

struct Meaning {
  StepFlag flag;
  const char* what;
  const char* remedy;
};

constexpr std::array<Meaning, 8> kMeanings = {{
    {StepFlag::not_converged, "an iteration reached its limit and its residual was accepted", "choose a smaller step"},
    {StepFlag::step_budget, "the sub-step budget was used up and the error of the last one accepted",
     "raise hydraulics.substep_budget or the tolerances"},
    {StepFlag::clamp_active, "a quantity was held at a bound of its validity", "look at the pressures and the inputs"},
    {StepFlag::late_input, "a sample was later than the copy of the partner's model is good for",
     "look for load on the machine or the network, or choose session.mode: lockstep"},
    {StepFlag::coupling_creates_energy, "the coupling created energy, so the run may be unstable",
     "choose session.coupling: two or a smaller step"},
    {StepFlag::cavitating, "a volume cavitated", "look at the pressures near zero"},
    {StepFlag::beyond_oil_law, "a pressure was beyond what the oil's law is good for (1000 bar)",
     "limit it: a relief valve on the line, a lower load or setting"},
    {StepFlag::large_deflection, "a flexible body was bent by more than a tenth of its length",
     "its theory is one of small deflections: take the numbers for estimates"},
}};

struct Seen {
  std::uint64_t steps = 0;
  StepIndex first = 0;
  std::int32_t volume = -1;  // that the first step names which names one
};

// Of hydraulics' samples: the offender is a volume where none of the flags that name something else is up.
bool names_volume(StepFlag flag, const wire::SampleState& state) {
  constexpr auto kOthers = static_cast<std::uint32_t>(StepFlag::not_converged) |
                           static_cast<std::uint32_t>(StepFlag::step_budget) |
                           static_cast<std::uint32_t>(StepFlag::non_finite);
  const bool is_beyond = (state.flags & static_cast<std::uint32_t>(StepFlag::beyond_oil_law)) != 0;
  if ((state.flags & kOthers) != 0) return false;
  return flag == StepFlag::beyond_oil_law || (flag == StepFlag::cavitating && !is_beyond);
}

std::vector<std::string> volumes_of(const recording::Reader& reader) {
  const scene::Scene scene = scene::load_text(attachment_text(reader, "scene.yaml"), reader.identity().scene);
  std::vector<std::string> names;
  for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) names.push_back(volume.name);
  return names;
}

// How a free-running node fared without its partner's samples.
struct Late {
  std::uint64_t steps = 0;  // that continued a copy
  StepIndex longest = 0;    // steps in a row
  std::uint64_t all = 0;
  std::uint32_t lost = 0;  // samples that no step used

  void add(const wire::Header& header, const wire::SampleState& state) {
    if (header.phase != wire::Phase::running || header.step == 0) return;
    ++all;
    lost = state.lost;
    if (state.quality == coupling::Quality::ok) return;
    ++steps;
    longest = std::max(longest, header.step - 1 - state.used_step);
  }
};

}  // namespace

std::vector<std::string> explain_flags(const recording::Reader& reader) {
  std::map<std::pair<wire::Role, std::size_t>, Seen> seen;
  std::map<wire::Role, Late> late;
  const auto take = [&](const wire::Header& header, const wire::SampleState& state) {
    late[header.role].add(header, state);
    for (std::size_t i = 0; i < kMeanings.size(); ++i) {
      if ((state.flags & static_cast<std::uint32_t>(kMeanings[i].flag)) == 0) continue;
      Seen& entry = seen[{header.role, i}];
      if (entry.steps++ == 0) entry.first = header.step;
      const bool is_named = header.role == wire::Role::hydraulics && names_volume(kMeanings[i].flag, state);
      if (entry.volume < 0 && is_named) entry.volume = state.offender;
    }
  };
  recording::MessageFilter filter;
  for (const wire::Topic topic : {wire::Topic::mechanism, wire::Topic::actuators}) {
    filter.topics.emplace_back(node::to_text(topic));
  }
  const Status status = reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (message.channel->topic == filter.topics.front()) {
      wire::MechanismMessage sample;
      if (transport::decode(message.payload, sample)) take(sample.header, sample.state);
    } else {
      wire::ActuatorMessage sample;
      if (transport::decode(message.payload, sample)) take(sample.header, sample.state);
    }
    return recording::Reader::Visit::go_on;
  });
  if (status.code == ExitCode::storage) throw Failure(status.code, status.text);
  std::vector<std::string> sentences;
  const double H = reader.identity().communication_step.seconds();
  for (const auto& [role, entry] : late) {
    if (entry.steps == 0 && entry.lost == 0) continue;
    sentences.push_back(
        fmt::format("{}: free-running, {} of {} without the partner's sample ({:.3g} %), {} in a row at "
                    "most; {} never used",
                    node::to_text(role), entry.steps, counted(entry.all, "step", "steps"),
                    100.0 * static_cast<double>(entry.steps) / static_cast<double>(entry.all), entry.longest,
                    counted(entry.lost, "sample", "samples")));
  }
  std::vector<std::string> volumes;
  for (const auto& [key, entry] : seen) {
    const Meaning& meaning = kMeanings[key.second];
    if (entry.volume >= 0 && volumes.empty()) volumes = volumes_of(reader);
    const bool is_named = entry.volume >= 0 && static_cast<std::size_t>(entry.volume) < volumes.size();
    const std::string name = is_named ? volumes[static_cast<std::size_t>(entry.volume)] + ": " : "";
    sentences.push_back(fmt::format("{}: {}{} in {}, first at {}; {}", node::to_text(key.first), name, meaning.what,
                                    counted(entry.steps, "step", "steps"),
                                    duration_text(static_cast<double>(entry.first) * H), meaning.remedy));
  }
  return sentences;
}

}  // namespace slew::cli
