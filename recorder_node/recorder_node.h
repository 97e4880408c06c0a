// SPDX-License-Identifier: Apache-2.0
// Records all messages of a session, ordered by step, in one file.
//
// Ticks and samples must be complete: the recorder requests the missing steps of a gap after 3 ms, and their writers
// resend them from their caches; messages that never arrive are counted per topic. The recording is closed after every
// node's END, after a fault, or on a signal. It is also closed when the disk fails or its space gets short: the session
// goes on without it, and the recorder ends with code 6.
//
// While the disk is slower than the session, up to 64 MiB wait for it. In `free` pace the session then waits too. In
// `real` pace variables and health are left out when half of that is used, and messages of each step when all of it is
// used. Each such gap is marked in the file (Metadata "slewring.gap"), and the messages are counted as lost. So are
// ticks and samples that no node can resend. After a gap in the ticks the recorder requests the states of all nodes, as
// a late recorder does: the recording replays from them on.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "node/checkpoint.h"
#include "node/flag_counter.h"
#include "node/node.h"
#include "node/resend_clock.h"
#include "node/tick_counter.h"
#include "recorder_node/selection.h"
#include "recorder_node/stream_gaps.h"
#include "recording/writer.h"

namespace slew::recorder_node {

inline constexpr std::uint64_t kKeepFreeBytes = 256'000'000;
inline constexpr std::size_t kBacklogBytes = 64u << 20;
// Columns of a few messages are not much smaller than the messages.
inline constexpr SimDuration kColumnsFlushPeriod = milliseconds(2000);
// Columns are a third as many bytes as messages: a higher level of zstd costs little.
inline constexpr int kColumnsLevel = 3;

// Limits of the recorder: a slow disk delays a thread, not the session.
[[nodiscard]] inline recording::WriterLimits recorder_limits() {
  recording::WriterLimits limits;
  limits.backlog_bytes = kBacklogBytes;
  return limits;
}

struct RecorderConfig {
  std::filesystem::path runs_directory = "runs";
  node::JoinOptions join;
  std::uint64_t keep_free = kKeepFreeBytes;  // bytes on the recording's file system that are left free
  recording::WriterLimits limits = recorder_limits();
  recording::FileCalls* file_calls = &recording::system_file_calls();
  // Finds what is recorded of a session, from its description; empty: all of it.
  std::function<Status(const wire::SessionDescription&, RecordedPart&)> part;
};

// A stream of messages that a writer publishes every k-th step: blocks of variables of one place in its list, samples
// from or to flexible bodies.
struct BlockSource {
  wire::Topic topic = wire::Topic::variables;
  wire::Role writer = wire::Role::io;
  std::uint32_t first = 0;  // first variable of a block
  auto operator<=>(const BlockSource&) const = default;
};

struct BlockStream {
  StepIndex first = kJoinStep, newest = kJoinStep;
  std::uint64_t arrived = 0;
};

// Ticks or samples of one writer, and the time to request its first gap: a stream in order must not delay another's.
struct StepStream {
  StreamGaps gaps;
  node::ResendClock resend;
};

// Steps ahead of a gap that are remembered: more than any node can resend.
[[nodiscard]] constexpr std::size_t stream_depth(SimDuration give_up_after, SimDuration step) noexcept {
  constexpr std::size_t kLeast = 4096;
  return std::max(kLeast, 2 * node::sent_depth(give_up_after, step));
}
// Messages kept for an epoch that has not begun yet: INIT, sample 0 and a few variable blocks of every node.
inline constexpr std::size_t kMaxPending = 256;

// Messages of one epoch that have arrived, by writer.
struct EpochStreams {
  StepIndex begin = 0;     // its first step
  bool had_begun = false;  // before the recorder joined: blocks before the first one received are not missing
  std::map<std::pair<wire::Topic, wire::Role>, StepStream> steps;  // ticks and samples
  std::map<BlockSource, BlockStream> blocks;
};

// How the session ended, for the recording's summary.
struct SessionEnd {
  ExitCode code = ExitCode::ok;
  std::string reason;  // empty: the code suffices
};

struct TopicCounts {
  std::uint64_t recorded = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t lost = 0;
};

class RecorderNode final : public node::Node {
 public:
  RecorderNode(transport::Transport& transport, RecorderConfig config);
  ~RecorderNode() override;

  bool poll(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override;
  [[nodiscard]] bool is_finished() const override { return stage_ == Stage::finished; }
  void request_stop(ExitCode code) override;
  [[nodiscard]] node::SessionMember& member() override { return member_; }

  // Empty before the node has a session.
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return path_; }
  // Messages that are missing in it so far.
  [[nodiscard]] std::uint64_t lost() const noexcept;
  // Bytes that wait for the disk.
  [[nodiscard]] std::size_t backlog_bytes() const { return writer_ == nullptr ? 0 : writer_->backlog_bytes(); }

 private:
  enum class Stage : std::uint8_t { waiting_for_session, recording, finished };

  void receive(const transport::Received& message, std::int64_t now_ns);
  [[nodiscard]] bool is_of_another_session(const transport::Received& message) const;
  void receive_session(const transport::Received& message, std::int64_t now_ns);
  void discard(const Status& why);
  void refuse(const Status& refusal);
  void withdraw();
  void refuse_late();
  void receive_stepped(const transport::Received& message, std::int64_t now_ns);
  void become_ready() noexcept;
  [[nodiscard]] bool has_come_in_time(const wire::Header& header, wire::Topic topic, std::int64_t now_ns);
  void record_step(const transport::Received& message, const wire::Header& header, EpochStreams& streams,
                   std::int64_t now_ns);
  // A recorder that a session does not require may join after its begin: the recording then begins with the states of
  // the next step that io sends.
  enum class Begin : std::uint8_t { known, open, late };
  [[nodiscard]] bool is_from_the_begin(const transport::Received& message, const wire::Header& header,
                                       std::int64_t now_ns);
  void keep_until_begin(const transport::Received& message);
  void begin_late(StepIndex step, std::int64_t now_ns);
  void file_pending(std::int64_t now_ns);
  void file(const transport::Received& message);
  void receive_state(const transport::Received& message, std::int64_t now_ns);
  void expect_states(StepIndex step);
  void request_states(std::int64_t now_ns);
  void record_variables(const transport::Received& message, const wire::Header& header, EpochStreams& streams);
  void record_block(const transport::Received& message, const wire::Header& header, const BlockSource& source,
                    EpochStreams& streams);
  [[nodiscard]] StepIndex& every(wire::Topic topic) noexcept { return block_every_[static_cast<std::size_t>(topic)]; }
  void keep_for_next_epoch(const transport::Received& message);
  Status create(const wire::SessionDescription& session);
  Status add_attachments(const wire::SessionDescription& session);
  void write(const transport::Received& message, std::uint32_t epoch, StepIndex step, std::uint32_t sequence);
  void count(const transport::Received& message);
  void write_hashes(const recording::StateHashes& hashes);
  void start_epoch(const wire::Header& init);
  void begin_streams(StepIndex from);
  [[nodiscard]] StepStream make_stream(StepIndex begin) const;
  [[nodiscard]] StepIndex complete_up_to() const noexcept;
  [[nodiscard]] StepIndex final_step(wire::Role writer, StepIndex newest) const noexcept;
  [[nodiscard]] StepIndex last_block(const BlockSource& source, StepIndex newest) const noexcept;
  [[nodiscard]] bool is_ending() const noexcept;
  [[nodiscard]] bool has_everything() const noexcept;
  void report_progress(std::int64_t now_ns);
  void request_gaps(std::int64_t now_ns);
  void watch(std::int64_t now_ns);
  void begin_ending(ExitCode code, const std::string& reason);
  void finish(const SessionEnd& session, ExitCode own_code, const std::string& own_reason);
  void count_losses(EpochStreams& streams, bool is_present);
  void count_all_losses();
  [[nodiscard]] bool is_left_out(wire::Topic topic, StepIndex step, std::uint32_t epoch);
  void end_gap();
  void give_up_unanswerable();
  void end_lost_steps();
  void stop_recording(const Status& why);
  void stop_when_room_is_short(std::int64_t now_ns);
  [[nodiscard]] Status problem_of_room(const std::filesystem::path& place) const;
  void close(const SessionEnd& session);
  void close_file(SessionEnd session);
  void update_health() noexcept;

  node::SessionMember member_;
  RecorderConfig config_;
  Stage stage_ = Stage::waiting_for_session;
  std::filesystem::path path_;
  std::unique_ptr<recording::Writer> writer_;
  Status stopped_;  // reason for which the recording was closed while the session goes on; ok: it is being recorded
  std::int64_t room_checked_ns_ = 0;
  struct Gap {
    std::uint32_t epoch = 0;
    StepIndex from = 0, to = 0;
    std::array<std::uint64_t, wire::kTopics> messages{};
  };
  void mark(const Gap& gap, const char* cause);
  std::optional<Gap> gap_;   // messages left out while the disk is slower than the session
  std::optional<Gap> lost_;  // ticks and samples that no node has any more
  // After a gap in the ticks the session's states are recorded, so that it can be computed again from there.
  bool wants_states_ = false;
  StepIndex gap_end_ = kJoinStep;        // last step of that gap
  std::int64_t states_deadline_ns_ = 0;  // deadline of the request for them
  StepIndex states_step_ = 0;            // step of the states that are being recorded, or were last
  std::int64_t now_ns_ = 0;              // time of the present poll
  // Contents of the file, for the summary at its end, which readers use without reading the whole file.
  std::optional<node::TickCounter> ticks_;
  node::FlagCounter flags_;
  std::uint64_t variables_digest_ = 0;
  wire::Tick tick_;
  wire::NodeStatus status_;
  bool has_warned_of_waiting_ = false;
  Selection selection_;
  bool has_step_ = false;  // a tick has come
  std::array<recording::ChannelId, wire::kTopics> channels_{};
  recording::ChannelId hashes_channel_{};
  recording::Bytes hashes_bytes_;
  std::array<TopicCounts, wire::kTopics> counts_{};
  EpochStreams streams_;
  // incomplete ones of the states with which an epoch begins or continues after a gap
  std::map<wire::Role, node::CheckpointParts> missing_states_;
  node::ResendClock states_resend_;
  wire::StatePart part_;
  EpochStreams former_;  // the epoch before: its last messages may arrive after the tick that ended it
  // steps between two blocks of a topic, from the blocks that have arrived; 0: unknown yet
  std::array<StepIndex, wire::kTopics> block_every_{};
  StepIndex reported_step_ = kJoinStep;
  StepIndex last_step_ = kJoinStep;  // step up to which every stream was complete at the end
  std::int64_t reported_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  Begin begin_ = Begin::known;
  bool has_received_probe_ = false;      // io's probe, which precedes the first tick
  std::int64_t late_deadline_ns_ = 0;    // deadline of a recorder that joined after the session's begin; 0: in time
  std::optional<wire::Role> lost_node_;  // node that is gone, while the other nodes publish their end
  struct PendingMessage {
    wire::Topic topic = wire::Topic::session;
    std::int64_t source_ns = 0;
    std::vector<std::byte> bytes;
  };
  std::vector<PendingMessage> before_begin_;  // messages without a step of their own, until the first step is known
  std::vector<PendingMessage> next_epoch_;    // messages that arrived before the tick that begins their epoch
  std::uint64_t unstepped_ = 0;               // running number of messages without a step of their own
};

}  // namespace slew::recorder_node
