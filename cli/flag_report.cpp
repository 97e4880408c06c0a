#include "cli/flag_report.h"

#include <fmt/format.h>

#include "core/display.h"
#include "core/failure.h"
#include "node/identity.h"
#include "session/flag_counter.h"
#include "session/recorded.h"
#include "transport/cdr/codec.h"
#include "transport/wire.h"

namespace slew::cli {

std::vector<std::string> explain_flags(const recording::Reader& reader) {
  session::FlagCounter flags;
  recording::MessageFilter filter;
  for (const wire::Topic topic : {wire::Topic::mechanism, wire::Topic::actuators}) {
    filter.topics.emplace_back(node::to_text(topic));
  }
  const Status status = reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (message.channel->topic == filter.topics.front()) {
      wire::MechanismMessage sample;
      if (transport::decode(message.payload, sample)) flags.take(sample.header, sample.state);
    } else {
      wire::ActuatorMessage sample;
      if (transport::decode(message.payload, sample)) flags.take(sample.header, sample.state);
    }
    return recording::Reader::Visit::go_on;
  });
  if (status.code == ExitCode::storage) throw Failure(status.code, status.text);
  const SimDuration step = reader.identity().communication_step;
  // the scene is read only for the names in the sentences
  if (flags.sentences(step, {}).empty()) return {};
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(reader), reader.identity().scene);
  return flags.sentences(step, session::volume_names(scene));
}

std::vector<std::string> explain_flags(const session::RunOutcome& outcome, const scene::Scene& scene) {
  using wire::Role;
  const session::FlagCounter& flags = outcome.view.flags();
  std::vector<std::string> sentences = flags.sentences(scene.session.step_duration(), session::volume_names(scene));
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

}  // namespace slew::cli
