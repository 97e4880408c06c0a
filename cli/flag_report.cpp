#include "cli/flag_report.h"

#include "cli/flag_counter.h"
#include "cli/recorded.h"
#include "core/failure.h"
#include "node/identity.h"
#include "scene/scene.h"
#include "transport/codec.h"
#include "transport/wire.h"

namespace slew::cli {

std::vector<std::string> explain_flags(const recording::Reader& reader) {
  FlagCounter flags;
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
  // the scene is read for the names in the sentences alone
  if (flags.sentences(step, {}).empty()) return {};
  const scene::Scene scene = scene::load_text(recorded_scene_text(reader), reader.identity().scene);
  return flags.sentences(step, volume_names(scene));
}

}  // namespace slew::cli
