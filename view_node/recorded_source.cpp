// SPDX-License-Identifier: Apache-2.0
#include "view_node/recorded_source.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/failure.h"
#include "core/time.h"
#include "node/identity.h"
#include "session/recorded.h"

namespace slew::view_node {
namespace {

using wire::Topic;

constexpr std::int64_t kFrameNs = 1'000'000'000 / 60;
constexpr double kSlowest = 0.01, kFastest = 100;
constexpr std::uint64_t kLookBackNs = 1'000'000'000;  // the rarest variables are published more often

Topic topic_of(const recording::RecordedChannel& channel) {
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    if (channel.topic == node::to_text(static_cast<Topic>(i))) return static_cast<Topic>(i);
  }
  return Topic::count;
}

// Values alone: messages of the wire from before the time that was jumped to are none of it.
class ValuesAlone final : public observer::Receiver {
 public:
  explicit ValuesAlone(gateway::Gateway& gateway) : gateway_(gateway) {}
  void take_block(const wire::VariableBlock& block, std::span<const std::byte> bytes, double time) override {
    gateway_.take_block(block, bytes, time);
  }

 private:
  gateway::Gateway& gateway_;
};

double seconds_of(std::uint64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

}  // namespace

RecordedSource::RecordedSource(const recording::Reader& reader) : reader_(reader) {
  const recording::StatisticsRecord& statistics = reader.statistics();
  range_ = {statistics.start_time, statistics.end_time};
  const recording::MessageFilter values = session::only({Topic::variables});
  bool has_values = false;
  require(reader.for_each(values, [&](const recording::RecordedMessage&) {
    has_values = true;
    return recording::Reader::Visit::stop;
  }));
  const auto keep = [&reader](Topic topic, std::vector<KeptMessage>& kept) {
    require(reader.for_each(session::only({topic}), [&](const recording::RecordedMessage& message) {
      kept.push_back({topic, {message.payload.begin(), message.payload.end()}, message.log_time_ns});
      return recording::Reader::Visit::go_on;
    }));
  };
  // names first: a message of the directory may be filed behind the first values
  keep(Topic::session, names_);
  keep(Topic::variable_directory, names_);
  keep(Topic::node_status, states_);
  forget_later(0);
  if (!has_values || !view_.has_session()) {
    throw Failure(ExitCode::bad_input, reader.path().string() +
                                           ": the recording has no values of variables; nothing was started; record "
                                           "the session with recording.variables");
  }
  base_ns_ = range_.from_ns;
  seek_ns_ = range_.from_ns;
}

std::vector<gateway::WireChannelDef> RecordedSource::wire_topics() const {
  std::vector<gateway::WireChannelDef> defs;
  for (const recording::RecordedChannel& channel : reader_.channels()) {
    const Topic topic = topic_of(channel);
    if (topic != Topic::count && channel.message_count > 0) defs.push_back({topic, channel.type_name, channel.idl});
  }
  return defs;
}

void RecordedSource::publish_names(gateway::Gateway& gateway) const {
  const auto filter = session::only({Topic::session, Topic::variable_directory});
  require(reader_.for_each(filter, [&](const recording::RecordedMessage& message) {
    gateway.take_wire(topic_of(*message.channel), message.payload, seconds_of(message.log_time_ns));
    return recording::Reader::Visit::go_on;
  }));
}

std::uint64_t RecordedSource::time_at(std::int64_t now_ns) const noexcept {
  if (!is_playing_) return base_ns_;
  const double passed = static_cast<double>(now_ns - base_wall_ns_) * speed_;
  return std::min(range_.to_ns, base_ns_ + static_cast<std::uint64_t>(std::max(0.0, passed)));
}

gateway::PlaybackState RecordedSource::state(std::int64_t now_ns) const {
  gateway::PlaybackState state;
  state.time_ns = time_at(now_ns);
  state.speed = static_cast<float>(speed_);
  state.status = is_playing_                ? gateway::PlaybackStatus::playing
                 : base_ns_ >= range_.to_ns ? gateway::PlaybackStatus::ended
                                            : gateway::PlaybackStatus::paused;
  return state;
}

Status RecordedSource::control(const gateway::PlaybackControl& request, std::int64_t now_ns) {
  const auto refuse = [](const std::string& text) {
    return Status::error(ExitCode::bad_input, text + "; the playback goes on as before");
  };
  if (!(request.speed >= static_cast<float>(kSlowest) && request.speed <= static_cast<float>(kFastest)))
    return refuse("the speed of the playback is not from 0.01 to 100");
  if (request.seek_ns && (*request.seek_ns < range_.from_ns || *request.seek_ns > range_.to_ns)) {
    return refuse("the time is not in the recording, which goes from " + std::to_string(seconds_of(range_.from_ns)) +
                  " to " + std::to_string(seconds_of(range_.to_ns)) + " s");
  }
  base_ns_ = request.seek_ns.value_or(time_at(now_ns));
  if (request.seek_ns) seek_ns_ = request.seek_ns;
  base_wall_ns_ = now_ns;
  speed_ = static_cast<double>(request.speed);
  is_playing_ = !request.is_paused;
  // from the begin again, as every player does
  if (is_playing_ && base_ns_ >= range_.to_ns && !request.seek_ns) {
    base_ns_ = range_.from_ns;
    seek_ns_ = base_ns_;
  }
  return Status::ok();
}

bool RecordedSource::read_until(std::uint64_t time_ns, observer::Receiver* receiver) {
  recording::RecordedMessage message;
  while (true) {
    if (next_) {
      message = *next_;
    } else if (!cursor_->next(message)) {
      return false;
    }
    next_.reset();
    if (message.log_time_ns > time_ns) {
      next_ = message;  // its bytes stay valid until the next one is read
      return true;
    }
    view_.take(topic_of(*message.channel), message.payload, seconds_of(message.log_time_ns), receiver);
  }
}

void RecordedSource::forget_later(std::uint64_t time_ns) {
  view_ = observer::SessionView();
  for (const KeptMessage& name : names_) view_.take(name.topic, name.bytes);
  for (const KeptMessage& state : states_)
    if (state.time_ns <= time_ns) view_.take(state.topic, state.bytes, seconds_of(state.time_ns));
}

void RecordedSource::jump(std::uint64_t time_ns, gateway::Gateway& gateway) {
  recording::MessageFilter filter;
  if (!reads_wire_) filter = session::only({Topic::node_status, Topic::health, Topic::variables});
  filter.from_ns = time_ns > kLookBackNs ? time_ns - kLookBackNs : 0;
  cursor_.emplace(reader_, filter);
  next_.reset();
  forget_later(time_ns);
  gateway.forget_values();
  ValuesAlone values(gateway);
  static_cast<void>(read_until(time_ns, &values));
}

void RecordedSource::poll(gateway::Gateway& gateway, std::int64_t now_ns) {
  if (now_ns < next_frame_ns_ && !seek_ns_) return;
  next_frame_ns_ = now_ns + kFrameNs;
  const std::uint64_t time_ns = time_at(now_ns);
  if (reads_wire_ != gateway.wants_wire()) {
    reads_wire_ = !reads_wire_;
    if (!seek_ns_) seek_ns_ = time_ns;
  }
  if (seek_ns_) {
    jump(*seek_ns_, gateway);
    seek_ns_.reset();
  } else if (!is_playing_ || time_ns == read_to_ns_) {
    return;
  }
  const bool has_more = read_until(time_ns, &gateway);
  read_to_ns_ = time_ns;
  gateway.show(view_, time_ns);
  if (const Status& status = cursor_->status(); !has_more && !status.is_ok())
    gateway.add_event(gateway::LogLevel::error, "window", status.text);
  if (!is_playing_ || (has_more && time_ns < range_.to_ns)) return;
  is_playing_ = false;
  base_ns_ = range_.to_ns;
  gateway.publish_playback(now_ns);
}

}  // namespace slew::view_node
