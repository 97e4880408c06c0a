// SPDX-License-Identifier: Apache-2.0
#include "analysis/run_report/flag_report.h"

#include <fmt/format.h>

#include <array>

#include "core/display.h"
#include "core/failure.h"
#include "hydraulics/circuit.h"
#include "node/identity.h"
#include "session/recorded.h"
#include "transport/cdr/codec.h"
#include "transport/wire.h"

namespace slew::analysis {
namespace {

using node::FlagCounter;

struct Meaning {
  const char* what;
  const char* remedy;
};

// in the order of FlagCounter::kFlags
constexpr std::array<Meaning, FlagCounter::kFlags.size()> kMeanings = {{
    {"an iteration reached its limit and its residual was accepted", "choose a smaller step"},
    {"the sub-step budget was used up and the rest of the step computed at looser tolerances",
     "raise hydraulics.substep_budget or the tolerances"},
    {"a quantity was held at a bound of its validity", "look at the pressures and the inputs"},
    {"a sample was later than the horizon of the partner model",
     "look for load on the machine or the network, or choose session.mode: lockstep"},
    {"the coupling created energy, so the run may be unstable",
     "choose a smaller session.step, or level two for a port that has another"},
    {"the oil cavitated", "look at the pressures near zero"},
    {"a pressure was beyond the range of the oil's law (1000 bar)",
     "limit it: a relief valve on the line, a lower load or setting"},
    {"a flexible body was bent by more than a tenth of its length",
     "its theory is one of small deflections: take the numbers for estimates"},
}};

constexpr Meaning kSearchFailed = {"no distance was found, or a body turned by half a turn or more between two samples",
                                   "lower recording.every, or look for a body that leaves the machine"};

constexpr Meaning kCircuitFailed = {
    "the solver's sub-steps reached their limit and their error was accepted",
    "choose a smaller session.step or hydraulics.max_substep; with rk4 its steps are too long for the circuit: choose "
    "another hydraulics.solver"};

constexpr Meaning kPassed = {
    "its shapes passed through each other between two instants, or faster than a sub-step follows",
    "choose a smaller session.step or mechanics.max_substep, or a thicker shape"};

const Meaning& meaning_of(wire::Role role, std::size_t flag, bool is_named) {
  if (FlagCounter::kFlags[flag] != StepFlag::not_converged) return kMeanings[flag];
  if (role == wire::Role::sensor) return kSearchFailed;
  if (role == wire::Role::mechanics && is_named) return kPassed;
  return role == wire::Role::hydraulics ? kCircuitFailed : kMeanings[flag];
}

}  // namespace

std::vector<std::string> flag_sentences(const FlagCounter& flags, SimDuration step, const OffenderNames& names) {
  std::vector<std::string> sentences;
  for (const auto& [role, counts] : flags.by_role()) {
    if (counts.late == 0 && counts.lost == 0) continue;
    sentences.push_back(
        fmt::format("{}: free-running, {} of {} without the partner's sample ({:.3g} %), {} in a row at "
                    "most; {} never used",
                    node::to_text(role), counts.late, counted(counts.steps, "step", "steps"),
                    100.0 * static_cast<double>(counts.late) / static_cast<double>(counts.steps), counts.longest,
                    counted(counts.lost, "sample", "samples")));
  }
  for (const auto& [role, counts] : flags.by_role()) {
    for (std::size_t i = 0; i < kMeanings.size(); ++i) {
      const FlagCounter::Seen& entry = counts.seen[i];
      if (entry.steps == 0) continue;
      const std::vector<std::string>& of_role = role == wire::Role::sensor      ? names.sensors
                                                : role == wire::Role::mechanics ? names.contacts
                                                                                : names.states;
      const bool is_named = entry.offender >= 0 && static_cast<std::size_t>(entry.offender) < of_role.size();
      const std::string name = is_named ? of_role[static_cast<std::size_t>(entry.offender)] + ": " : "";
      const Meaning& meaning = meaning_of(role, i, is_named);
      sentences.push_back(fmt::format("{}: {}{} in {}, first at {}; {}", node::to_text(role), name, meaning.what,
                                      counted(entry.steps, "step", "steps"),
                                      duration_text(static_cast<double>(entry.first) * step.seconds()),
                                      meaning.remedy));
    }
  }
  return sentences;
}

namespace {

OffenderNames offender_names(const scene::Scene& scene) {
  OffenderNames names;
  if (scene.has_hydraulics()) {
    const hydraulics::Circuit circuit(scene.hydraulics);
    for (int i = 0; i < circuit.volume_count(); ++i) names.states.push_back(circuit.volume_name(i));
    for (const hydraulics::Actuator& actuator : circuit.actuators()) names.states.push_back(actuator.name);
    for (const hydraulics::Actuator& actuator : circuit.actuators()) names.states.push_back(actuator.name);
    for (int i = circuit.first_component_state(); i < circuit.state_count(); ++i) {
      names.states.push_back(circuit.state_owner(i - circuit.first_component_state()));
    }
  }
  for (const sensors::SensorDef& sensor : scene.sensors) names.sensors.push_back(sensor.name);
  for (const multibody::ContactPairDef& pair : scene.mechanics.contacts) names.contacts.push_back(pair.name);
  return names;
}

template <typename Message>
void take_sample(const recording::RecordedMessage& recorded, FlagCounter& flags) {
  Message sample;
  if (transport::decode(recorded.payload, sample)) flags.take(sample.header, sample.state);
}

}  // namespace

std::vector<std::string> explain_flags(const FlagCounter& flags, const scene::Scene& scene) {
  return flag_sentences(flags, scene.session.step_duration(), offender_names(scene));
}

FlagCounter recorded_flags(const recording::Reader& reader) {
  FlagCounter flags;
  recording::MessageFilter filter;
  for (const wire::Topic topic : {wire::Topic::mechanism, wire::Topic::actuators, wire::Topic::sensors}) {
    filter.topics.emplace_back(node::to_text(topic));
  }
  const Status status = reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (message.channel->topic == filter.topics[0]) {
      take_sample<wire::MechanismMessage>(message, flags);
    } else if (message.channel->topic == filter.topics[1]) {
      take_sample<wire::ActuatorMessage>(message, flags);
    } else {
      take_sample<wire::SensorMessage>(message, flags);
    }
    return recording::Reader::Visit::go_on;
  });
  if (status.code == ExitCode::storage) throw Failure(status.code, status.text);
  return flags;
}

std::vector<std::string> explain_flags(const FlagCounter& flags, const recording::Reader& reader) {
  const SimDuration step = reader.identity().communication_step;
  // the scene is read for the names in the sentences alone
  if (flag_sentences(flags, step, {}).empty()) return {};
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(reader), reader.identity().scene);
  return flag_sentences(flags, step, offender_names(scene));
}

std::vector<std::string> explain_flags(const session::RunOutcome& outcome, const scene::Scene& scene) {
  using wire::Role;
  const FlagCounter& flags = outcome.tally.flags();
  std::vector<std::string> sentences = explain_flags(flags, scene);
  const bool has_steps = outcome.view.has_session() && outcome.steps > 0 &&
                         (outcome.view.session().required_roles & (bit(Role::mechanics) | bit(Role::hydraulics))) != 0;
  if (has_steps && !flags.has_samples()) {
    sentences.emplace_back(
        "no sample of the physics arrived here, so that the flags of the steps are missing; record the session; keys "
        "of an earlier version must be replaced with 'slewring keys create'");
  }
  if (const std::uint64_t missed = flags.missed(outcome.begin); missed > 0) {
    sentences.push_back(
        fmt::format("{} did not arrive here, and their flags are not counted; record the session and look with "
                    "'slewring info'",
                    counted(missed, "sample", "samples")));
  }
  return sentences;
}

}  // namespace slew::analysis
