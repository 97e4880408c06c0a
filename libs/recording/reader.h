// SPDX-License-Identifier: Apache-2.0
// Reads a recording: whole, cut at any byte, or damaged.
//
// A whole file is read through the index at its end. Otherwise it is scanned from the start, and its content is the
// longest trusted prefix; damage() gives its end and the reason. No input makes the reader crash: every length is
// checked against the file, and memory is bounded by the file's size and by kMaxChunkBytes. Reads files of Writer;
// other MCAP files are refused unless they hold the identity record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "recording/chunk_reader.h"
#include "recording/file_scan.h"
#include "recording/input_file.h"
#include "recording/session_identity.h"

namespace slew::recording {

struct RecordedChannel {
  std::uint16_t id = 0;
  std::string topic;
  std::string type_name;
  std::string idl;
  std::string message_encoding;
  TextMap metadata;
  std::uint64_t message_count = 0;
};

struct RecordedMessage {
  const RecordedChannel* channel = nullptr;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;      // simulation time, see writer.h
  std::uint64_t publish_time_ns = 0;  // wall clock
  ByteSpan payload;                   // valid until the next message is read
};

struct MessageFilter {
  std::vector<std::string> topics;  // empty: all
  std::uint64_t from_ns = 0;        // log times, both included
  std::uint64_t to_ns = std::numeric_limits<std::uint64_t>::max();
};

class Reader {
 public:
  // Errors: bad_input when it is not a recording, is of a newer format version, or ends before its identity; storage
  // when the disk fails. A cut or damaged recording opens.
  [[nodiscard]] static Status open(const std::filesystem::path& path, std::unique_ptr<Reader>& reader);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_.path(); }
  [[nodiscard]] std::uint64_t file_bytes() const noexcept { return file_.size(); }
  [[nodiscard]] const SessionIdentity& identity() const noexcept { return identity_; }

  [[nodiscard]] const std::vector<RecordedChannel>& channels() const noexcept { return channels_; }
  [[nodiscard]] const RecordedChannel* find_channel(std::string_view topic) const noexcept;  // nullptr: none

  [[nodiscard]] const std::vector<AttachmentIndexRecord>& attachments() const noexcept { return index_.attachments; }
  // Errors: bad_input if the name does not exist or its checksum differs; storage.
  [[nodiscard]] Status read_attachment(std::string_view name, Bytes& content) const;

  // All metadata records in the order of the file; the last one of a name, or nullptr.
  [[nodiscard]] const std::vector<MetadataRecord>& metadata() const noexcept { return metadata_; }
  [[nodiscard]] const TextMap* find_metadata(std::string_view name) const noexcept;

  // Chunks of the readable part, in the order of the file.
  [[nodiscard]] const std::vector<ChunkIndexRecord>& chunks() const noexcept { return index_.chunks; }
  // Messages, chunks and times of the readable part.
  [[nodiscard]] const StatisticsRecord& statistics() const noexcept { return index_.statistics; }

  // Place and reason of an early end of reading; none for a file with an intact end (verify() checks every byte).
  [[nodiscard]] const std::optional<Damage>& damage() const noexcept { return damage_; }
  // True if the session was recorded to its end: no message is missing after the readable part.
  [[nodiscard]] bool has_all_messages() const noexcept { return has_all_messages_; }
  // One sentence for the user, empty when there is no damage.
  [[nodiscard]] std::string damage_text() const;

  // Visits the messages in the order of the file: (epoch, step, channel, sequence), except late ones. visit returns
  // true to continue. Errors: bad_input at a damaged chunk, after the messages in front of it; storage.
  enum class Visit { go_on, stop };
  [[nodiscard]] Status for_each(const MessageFilter& filter,
                                const std::function<Visit(const RecordedMessage&)>& visit) const;

  // Reads every byte of the file and compares every checksum. Errors: bad_input, naming the first wrong byte; storage.
  [[nodiscard]] Status verify() const;

 private:
  friend class MessageCursor;

  Reader() = default;
  [[nodiscard]] Status load();
  [[nodiscard]] bool load_metadata(Status& status);
  void list_channels();
  [[nodiscard]] Status not_a_recording(const std::string& problem) const;

  InputFile file_;
  FileIndex index_;
  std::vector<MetadataRecord> metadata_;
  SessionIdentity identity_;
  std::vector<RecordedChannel> channels_;
  std::vector<const RecordedChannel*> channel_of_id_;  // nullptr: no channel
  std::optional<Damage> damage_;
  bool has_all_messages_ = false;
};

// Returns the messages of a reader one by one, for a replay at its own pace. The reader must outlive it.
class MessageCursor {
 public:
  MessageCursor(const Reader& reader, const MessageFilter& filter);

  // False at the end, or if status() holds an error as in Reader::for_each.
  [[nodiscard]] bool next(RecordedMessage& message);
  [[nodiscard]] const Status& status() const noexcept { return status_; }

 private:
  [[nodiscard]] bool is_wanted(const ChunkIndexRecord& chunk);
  [[nodiscard]] bool has_wanted_column(const ChunkIndexRecord& chunk);
  [[nodiscard]] bool open_next_chunk();
  [[nodiscard]] bool damaged(std::uint64_t offset, const std::string& problem);

  const Reader& reader_;
  std::uint64_t from_ns_;
  std::uint64_t to_ns_;
  std::vector<bool> is_channel_wanted_;  // by id
  ChunkReader chunk_reader_;
  std::vector<std::uint16_t> chunk_channels_;  // of the chunk looked at
  Bytes record_;
  Bytes unpacked_;
  std::size_t next_chunk_ = 0;
  ChunkRecords records_{ByteSpan{}};
  Status status_;
};

}  // namespace slew::recording
