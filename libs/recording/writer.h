// SPDX-License-Identifier: Apache-2.0
// Writes one session to one MCAP file.
//
// Layout, reasons and guarantees: docs/recording-format.md. In short: identity, attachments, schemas and channels in
// front; then chunks of about 1 MiB of messages in the order (epoch, step, channel, sequence); index, statistics and
// footer at the end. If the process dies at any moment, the file is readable up to the last chunk handed over.
//
// log_time of a message = simulation time of its step in ns, H * max(step, 0); the first step of every later epoch
// (reset, load) follows one step behind the last time written: the time neither goes backwards in the file nor jumps
// ahead. Messages that come after their step left the sort window are written with their own time and counted
// (late_messages).
// publish_time = wall clock at the publisher, or log_time when that is unknown.
//
// Not thread-safe. write() does not allocate once the first chunk is full; it compresses in the caller's thread
// whenever a chunk is full (about 3 ms per MiB), and writes there too or, with a backlog, in a thread of its own. The
// next writing call reports a failure of that thread and counts all waiting messages as lost.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "recording/background_file.h"
#include "recording/chunk_builder.h"
#include "recording/records.h"
#include "recording/session_identity.h"
#include "recording/sort_window.h"
#include "recording/summary.h"

namespace slew::recording {

struct RecordedMessage;

enum class ChannelId : std::uint16_t {};

inline constexpr std::size_t kMaxMessageBytes = 16u << 20;  // payload of one message
inline constexpr std::size_t kMaxAttachmentBytes = 1u << 30;
inline constexpr std::size_t kMaxChannels = 65'535;

struct WriterLimits {
  std::size_t chunk_bytes = 1u << 20;  // uncompressed size at which a chunk is closed
  int compression_level = 1;           // zstd, 1 to 19
  ChunkCoding coding = ChunkCoding::zstd;
  StepIndex window_steps = 256;                  // span of steps that is sorted, 1 or more
  std::size_t window_bytes = 8u << 20;           // its memory for payloads
  std::size_t window_messages = 32'768;          // capacity of the sort window in messages
  SimDuration flush_period = milliseconds(500);  // every message is in the file after twice this time
  std::size_t backlog_bytes = 0;                 // limit of bytes that wait for a slow disk; 0: written in the caller's
                                                 // thread
};

struct ChannelDef {
  std::string topic;
  std::string type_name;  // scoped, "slewring::Tick"
  std::string idl;        // complete text: the type and all that it uses, no #include
  TextMap metadata;       // for example the role that publishes
};

struct WriterCounts {
  std::uint64_t messages = 0;       // in the file
  std::uint64_t payload_bytes = 0;  // taken, before compression
  std::uint64_t chunks = 0;
  std::uint64_t late_messages = 0;  // messages behind one of a later time in the file
  std::uint64_t lost_messages = 0;  // not in the file because a write failed
};

class Writer {
 public:
  // Creates the file with the session's identity in front. A file that exists is never touched.
  // Errors: storage; bad_input when the identity has no communication step.
  [[nodiscard]] static Status create(const std::filesystem::path& path, const SessionIdentity& identity,
                                     const WriterLimits& limits, std::unique_ptr<Writer>& writer,
                                     FileCalls& calls = system_file_calls());
  // Closes as close({}) does, if still open.
  ~Writer();

  // Files beside the messages: expanded scene, manifest, build. Before the first message by convention.
  // Errors: storage; bad_input above kMaxAttachmentBytes.
  [[nodiscard]] Status add_attachment(std::string_view name, std::string_view media_type, ByteSpan content);
  [[nodiscard]] Status add_metadata(std::string_view name, const TextMap& entries);

  // Topics of one step are written in the order in which their channels were added: add them in a fixed order.
  // Channels of one type share its schema. Errors: storage; bad_input when there are too many.
  [[nodiscard]] Status add_channel(const ChannelDef& channel, ChannelId& id);

  // The step with which an epoch begins: that of a loaded state. Before the epoch's first message; an epoch that is not
  // named begins with step 0. Messages of earlier steps of it have the time of this one.
  void begin_epoch(std::uint32_t epoch, StepIndex first_step) { first_steps_[epoch] = first_step; }

  // payload: serialised sample with its 4-byte encapsulation header. Once a write has failed, every later one returns
  // that failure and counts the message as lost. Errors: storage; failed for a channel that was not added, a step
  // out of range or a payload above kMaxMessageBytes.
  [[nodiscard]] Status write(ChannelId channel, const MessageStamp& stamp, ByteSpan payload);

  // Writes a message of another recording with its times, behind all others: it is not sorted. Errors as in write().
  [[nodiscard]] Status append(ChannelId channel, const RecordedMessage& message);

  // Writes messages that are old enough. Call it about ten times a second, also without new messages.
  [[nodiscard]] Status flush_if_due(std::int64_t monotonic_ns);
  // Writes all messages, also those that an earlier step might still precede; waits until they are in the file.
  [[nodiscard]] Status flush();
  // Waits until all messages handed over are in the file.
  [[nodiscard]] Status settle();
  // Bytes that wait for the disk.
  [[nodiscard]] std::size_t backlog_bytes() const { return file_.backlog(); }

  // Flushes, writes summary entries (if any), index and footer, waits for the disk. After a failure it still tries to
  // complete the file and returns the first failure.
  [[nodiscard]] Status close(const TextMap& summary);

  // Number of messages of one channel handed to the file.
  [[nodiscard]] std::uint64_t messages_in_file(ChannelId channel) const;
  // After a failed write: the step before which all received messages are in the file. None: no write has failed.
  [[nodiscard]] std::optional<StepIndex> first_lost_step() const noexcept { return first_lost_step_; }
  [[nodiscard]] const WriterCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_.path(); }
  [[nodiscard]] std::uint64_t file_bytes() const noexcept { return file_.size(); }

 private:
  Writer(const SessionIdentity& identity, const WriterLimits& limits, FileCalls& calls);

  [[nodiscard]] Status write_front(const SessionIdentity& identity);
  [[nodiscard]] Status append_marked(std::uint64_t room_behind = 0);
  [[nodiscard]] std::uint64_t room_for_end() const noexcept;
  [[nodiscard]] Status schema_of(const ChannelDef& channel, std::uint16_t& id);
  [[nodiscard]] Status emit_first();
  [[nodiscard]] Status emit(const MessageStamp& stamp, std::uint16_t channel, ByteSpan payload);
  [[nodiscard]] Status put_message(const MessageRecord& message);
  [[nodiscard]] Status write_chunk();
  [[nodiscard]] Status write_end(const TextMap& summary);
  [[nodiscard]] Status remember(Status status);
  void note_lost(std::uint64_t log_time);
  void roll_back();
  void forget_written();
  [[nodiscard]] std::uint64_t log_time_of(const MessageStamp& stamp);

  WriterLimits limits_;
  SimDuration communication_step_;
  BackgroundFile file_;
  Bytes buffer_;  // records not yet in the file
  SortWindow window_;
  ChunkBuilder chunk_;

  FileIndex index_;                            // channel id = position in index_.channels
  std::uint64_t declared_bytes_ = 0;           // bytes of schemas and channels, which the end repeats
  std::vector<std::uint64_t> pending_counts_;  // messages of each channel in the open chunk

  // where an epoch lies on the time of the file
  struct EpochStart {
    std::uint64_t time = 0;  // ns, log time of its first step
    StepIndex step = 0;      // that step
  };
  std::map<std::uint32_t, EpochStart> epoch_start_;
  std::map<std::uint32_t, StepIndex> first_steps_;  // of the epochs that do not begin with step 0
  std::uint64_t last_log_time_ = 0;

  std::optional<std::int64_t> last_flush_ns_;
  std::uint32_t flushed_epoch_ = 0;  // newest epoch and step at the last flush
  StepIndex flushed_step_ = kJoinStep - 1;

  // chunks that may still wait for the disk
  struct HandedOver {
    std::uint64_t end = 0;              // offset of its end
    std::uint64_t start_time = 0;       // ns
    std::vector<std::uint64_t> counts;  // by channel
  };
  std::deque<HandedOver> handed_over_;

  WriterCounts counts_;
  std::optional<StepIndex> first_lost_step_;
  Status failure_;
};

}  // namespace slew::recording
