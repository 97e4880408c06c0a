// SPDX-License-Identifier: Apache-2.0
// A recording as the source of a gateway: its messages in their order, up to a time that is played, held or set.
//
// Times are those of the recording, from 0: after a reset of the session they go on (recording/writer.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gateway/gateway.h"
#include "observer/session_view.h"
#include "recording/reader.h"

namespace slew::view_node {

class RecordedSource final : public gateway::Playback {
 public:
  // reader: outlives this. Stands at the begin. Throws Failure when the recording has no values.
  explicit RecordedSource(const recording::Reader& reader);

  [[nodiscard]] const observer::SessionView& view() const noexcept { return view_; }
  [[nodiscard]] gateway::DataRange range() const noexcept { return range_; }

  // The recorded topics, with the interface definition of the recording.
  [[nodiscard]] std::vector<gateway::WireChannelDef> wire_topics() const;
  // Gives the gateway the messages that its clients may request at any time: the session and the names of variables.
  void publish_names(gateway::Gateway& gateway) const;
  // Goes on to the time of the playback and shows it; nothing while it stands. The playback ends at a damaged place of
  // the recording, with an event.
  void poll(gateway::Gateway& gateway, std::int64_t now_ns);

  [[nodiscard]] Status control(const gateway::PlaybackControl& request, std::int64_t now_ns) override;
  [[nodiscard]] gateway::PlaybackState state(std::int64_t now_ns) const override;

 private:
  [[nodiscard]] std::uint64_t time_at(std::int64_t now_ns) const noexcept;
  // What an observer at the time has received: names, and the last state of each node.
  void forget_later(std::uint64_t time_ns);
  // Reads from so early that every variable has a value at the time.
  void jump(std::uint64_t time_ns, gateway::Gateway& gateway);
  // Takes the messages up to the time. False: the recording has no more of them, or is damaged there.
  bool read_until(std::uint64_t time_ns, observer::Receiver* receiver);

  struct KeptMessage {
    wire::Topic topic;
    std::vector<std::byte> bytes;
    std::uint64_t time_ns;
  };

  const recording::Reader& reader_;
  std::vector<KeptMessage> names_, states_;  // session and directories; states of nodes, in the order of time
  observer::SessionView view_;
  gateway::DataRange range_;
  std::optional<recording::MessageCursor> cursor_;
  std::optional<recording::RecordedMessage> next_;  // read, and later than the time
  std::uint64_t read_to_ns_ = 0;
  bool reads_wire_ = false;  // all topics, since a client has subscribed to one

  bool is_playing_ = false;
  double speed_ = 1;
  std::uint64_t base_ns_ = 0;             // time of the recording at `base_wall_ns_`
  std::int64_t base_wall_ns_ = 0;         // monotonic
  std::optional<std::uint64_t> seek_ns_;  // to be done by the next poll
  std::int64_t next_frame_ns_ = 0;        // monotonic
};

}  // namespace slew::view_node
