// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_events.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/failure.h"
#include "device_node/signal_feed.h"
#include "math/vector3.h"
#include "node/identity.h"
#include "scene/scene.h"
#include "sensors/sensors.h"
#include "session/recorded.h"
#include "transport/cdr/codec.h"
#include "transport/wire.h"

namespace slew::session {
namespace {

using wire::Topic;
using Requests = std::map<std::uint64_t, wire::ControlRequest>;
using Visit = recording::Reader::Visit;

std::string with_reason(std::string text, const std::string& reason) {
  return reason.empty() ? text : text + ": " + reason;
}

// in recordings of protocol version 3 only the request has the text, where it was recorded
std::string request_text(const wire::ControlReply& reply, const Requests& requests) {
  if (!reply.asked.empty()) return reply.asked;
  const auto request = requests.find(reply.request);
  return request == requests.end() ? "request" : node::to_text(request->second);
}

// A value that was read; one `param list` reads hundreds.
bool is_answered_read(const wire::ControlReply& reply, const Requests& requests) {
  return reply.is_accepted && reply.request != 0 && request_text(reply, requests).starts_with("get ");
}

std::string lease_text(const wire::ControllerLease& lease) {
  const char* const what = !lease.is_granted ? "does not have" : lease.holder.empty() ? "has released" : "has";
  return with_reason(fmt::format("controller {} {} channel {}", lease.controller, what, lease.channel), lease.reason);
}

// The recorded scene; an empty one if it cannot be read, as in a recording without its description.
scene::Scene recorded_scene(const recording::Reader& reader) {
  try {
    return scene::load_text(recorded_scene_text(reader), reader.identity().scene);
  } catch (const std::exception&) {
    return {};
  }
}

// Changes of the scene's switched outputs: functions of recorded variables, as devices compute them live.
class OutputEvents final : public observer::Receiver {
 public:
  OutputEvents(const recording::Reader& reader, const scene::OutputsDef& outputs) {
    const std::vector<std::string> names = recorded_names(reader);
    std::vector<device_node::FedSignal> signals;
    for (const scene::SwitchedDef& output : outputs.switched) {
      const std::string& variable = output.output.variable;
      if (std::find(names.begin(), names.end(), variable) != names.end()) {
        signals.push_back({.variable = "", .output = output.name});
      } else {
        events_.push_back(
            {0, 0,
             fmt::format("output {}: its changes are not known, since {} was not recorded", output.name, variable)});
      }
    }
    if (signals.empty()) return;
    feed_.emplace(
        signals, outputs, 0.0, [](const device_node::FedValues&) {},
        [this](const scene::SwitchedDef& output, bool is_on) {
          events_.push_back({step_, epoch_, fmt::format("output {} goes {}", output.name, is_on ? "on" : "off")});
        });
    observer::SessionView view;
    watch_recording(reader, view, *this);
  }

  void take_directory(const wire::VariableDirectory& directory) override { feed_->take(directory); }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) override {
    step_ = block.header.step;
    epoch_ = block.header.epoch;
    feed_->take(block, time);
  }

  [[nodiscard]] const std::vector<RecordedEvent>& events() const noexcept { return events_; }

 private:
  std::optional<device_node::SignalFeed> feed_;
  StepIndex step_ = 0;
  std::uint32_t epoch_ = 0;
  std::vector<RecordedEvent> events_;
};

// In the order of steps where they are of different kinds.
std::vector<RecordedEvent> merged(const std::vector<RecordedEvent>& events, const std::vector<RecordedEvent>& more) {
  std::vector<RecordedEvent> all;
  std::merge(events.begin(), events.end(), more.begin(), more.end(), std::back_inserter(all),
             [](const RecordedEvent& a, const RecordedEvent& b) {
               return std::pair(a.epoch, a.step) < std::pair(b.epoch, b.step);
             });
  return all;
}

// Events of sensors by the names in the recorded scene.
class SensorTexts {
 public:
  explicit SensorTexts(std::vector<sensors::SensorDef> defs) : defs_(std::move(defs)) {}

  void add(const wire::SensorMessage& message, std::vector<RecordedEvent>& events) const {
    for (const coupling::SensorEvent& event : message.sample.events) {
      if (event.sensor >= defs_.size()) continue;
      const sensors::Event named{event.sensor, event.watched,           static_cast<sensors::EventKind>(event.kind),
                                 event.value,  math::Vec3(event.place), event.before};
      events.push_back({message.header.step, message.header.epoch, sensors::event_text(defs_[event.sensor], named)});
    }
  }

 private:
  std::vector<sensors::SensorDef> defs_;
};

}  // namespace

std::vector<RecordedEvent> recorded_events(const recording::Reader& reader) {
  Requests requests;
  std::vector<RecordedEvent> events;
  const auto topic = [](Topic which) { return std::string(node::to_text(which)); };
  recording::MessageFilter filter;
  filter.topics = {topic(Topic::control_request)};
  // a damaged chunk ends the reading; the messages in front of it count
  static_cast<void>(reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    wire::ControlRequest request;
    if (transport::decode(message.payload, request)) requests[request.request] = std::move(request);
    return Visit::go_on;
  }));
  filter.topics = {topic(Topic::control_reply), topic(Topic::controller_lease), topic(Topic::sensors)};
  const scene::Scene scene = recorded_scene(reader);
  const SensorTexts sensor_texts(scene.sensors);
  std::set<std::uint64_t> answered;  // a reply is resent to a requester that has not received it
  static_cast<void>(reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    wire::ControlReply reply;
    wire::ControllerLease lease;
    wire::SensorMessage sensors;
    if (message.channel->topic == filter.topics[2]) {
      if (transport::decode(message.payload, sensors)) sensor_texts.add(sensors, events);
    } else if (message.channel->topic == filter.topics[1]) {
      if (transport::decode(message.payload, lease)) {
        events.push_back({lease.header.step, lease.header.epoch, lease_text(lease)});
      }
    } else if (transport::decode(message.payload, reply)) {
      if (reply.request != 0 && !answered.insert(reply.request).second) return Visit::go_on;
      if (is_answered_read(reply, requests)) return Visit::go_on;
      const std::string asked = request_text(reply, requests);
      const std::string answer = reply.is_accepted ? " accepted" : " refused";
      const std::string text = reply.request == 0 ? reply.reason : with_reason(asked + answer, reply.reason);
      // these hold in the epoch that they begin
      const bool begins_epoch = reply.is_accepted && (asked == "reset" || asked == "load");
      events.push_back({reply.header.step, reply.header.epoch + (begins_epoch ? 1 : 0), text});
    }
    return Visit::go_on;
  }));
  if (scene.outputs.switched.empty()) return events;
  return merged(events, OutputEvents(reader, scene.outputs).events());
}

}  // namespace slew::session
