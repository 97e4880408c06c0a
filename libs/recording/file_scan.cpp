// SPDX-License-Identifier: Apache-2.0
#include "recording/file_scan.h"

#include <fmt/format.h>

#include <algorithm>

#include "recording/chunk_reader.h"

namespace slew::recording {
namespace {

class Scanner {
 public:
  Scanner(const InputFile& file, FileScan& scan) : file_(file), scan_(scan) {}

  Status run() {
    Status status = read_magic();
    while (status.is_ok() && !scan_.damage && !scan_.has_data_end) status = read_record();
    if (!status.is_ok()) return status;
    if (scan_.damage) {
      // a wrong length is detected only at a later byte
      scan_.damage->offset = std::min(scan_.damage->offset, unproved_at_);
      keep_only_proved();
    } else {
      status = check_end();
    }
    complete_statistics(scan_.index);
    return status;
  }

 private:
  // lengths of the lists that a Mark has confirmed
  struct Proved {
    std::size_t schemas = 0;
    std::size_t channels = 0;
    std::size_t metadata = 0;
  };

  void damage(std::uint64_t offset, std::string text) { scan_.damage = Damage{offset, std::move(text)}; }

  Status read_magic() {
    const std::size_t size = std::min<std::uint64_t>(file_.size(), kMagic.size());
    Status status = file_.read(0, size, content_);
    if (!status.is_ok()) return status;
    Bytes expected;
    put_magic(expected);
    if (content_ != expected) {
      damage(0, size < kMagic.size() ? "the file ends before the first record" : "this is not an MCAP file");
    }
    crc_ = crc32_of(content_);
    at_ = unproved_at_ = kMagic.size();
    return status;
  }

  Status read_record() {
    const std::uint64_t left = file_.size() - at_;
    if (left < kRecordHeadBytes) {
      damage(at_, left == 0 ? "the file ends here, without an end" : "the file ends inside a record");
      return Status::ok();
    }
    Status status = file_.read(at_, kRecordHeadBytes, head_);
    if (!status.is_ok()) return status;
    ByteSource head(head_);
    const Opcode opcode = Opcode{head.take<std::uint8_t>()};
    const std::uint64_t length = head.take<std::uint64_t>();
    if (opcode == Opcode::invalid) {
      damage(at_, "here no record begins");
      return status;
    }
    if (length > left - kRecordHeadBytes) {
      damage(at_, "the file ends inside a record");
      return status;
    }
    status = file_.read(at_ + kRecordHeadBytes, std::min(length, kFrontBytes), content_);
    if (!status.is_ok()) return status;
    if (!is_length_borne_out(opcode, content_, length)) {
      damage(at_, "the length of a record is not that of its content");
      return status;
    }
    if (length > kFrontBytes) status = file_.read(at_ + kRecordHeadBytes, length, content_);
    if (!status.is_ok()) return status;
    take_record(opcode);
    if (scan_.damage) return status;
    crc_ = crc32_of(content_, crc32_of(head_, crc_));
    at_ += kRecordHeadBytes + length;
    if (is_proved_) unproved_at_ = at_;
    return status;
  }

  // sets is_proved_ if all bytes up to the end of this record are confirmed
  void take_record(Opcode opcode) {
    const bool was_proved = unproved_at_ == at_;
    is_proved_ = false;
    switch (opcode) {
      case Opcode::schema:
        return take_into(scan_.index.schemas, "a schema is not well formed");
      case Opcode::channel:
        return take_into(scan_.index.channels, "a channel is not well formed");
      case Opcode::metadata:
        return take_metadata();
      case Opcode::attachment:
        is_proved_ = was_proved;
        return take_attachment();
      case Opcode::chunk:
        is_proved_ = was_proved;
        return take_chunk();
      case Opcode::mark:
        return check_mark();
      case Opcode::data_end:
        check_mark();
        scan_.has_data_end = !scan_.damage;
        return;
      default:
        return;  // header, message indexes, records of later versions: confirmed by the next Mark
    }
  }

  template <typename Record>
  void take_into(std::vector<Record>& records, const char* problem) {
    Record record;
    if (!decode(content_, record)) return damage(at_, problem);
    const auto same = std::find_if(records.begin(), records.end(), [&](const Record& r) { return r.id == record.id; });
    if (same == records.end()) records.push_back(std::move(record));
  }

  void take_metadata() {
    MetadataRecord record;
    if (!decode(content_, record)) return damage(at_, "a metadata record is not well formed");
    scan_.index.metadata.push_back({at_, record_length(), std::move(record.name)});
  }

  void take_attachment() {
    AttachmentRecord record;
    if (!decode_attachment(content_, record)) return damage(at_, "the checksum of an attachment differs");
    scan_.index.attachments.push_back({at_, record_length(), record.log_time, record.create_time, record.content.size(),
                                       std::string(record.name), std::string(record.media_type)});
  }

  void take_chunk() {
    ChunkRecord chunk;
    if (!decode_chunk(content_, chunk)) return damage(at_, "a chunk is not well formed");
    std::string problem;
    ChunkContents contents;
    const auto is_known = [this](std::uint16_t id) {
      const std::vector<ChannelRecord>& channels = scan_.index.channels;
      return std::any_of(channels.begin(), channels.end(), [id](const ChannelRecord& c) { return c.id == id; });
    };
    if (!reader_.unpack(chunk, unpacked_, problem) || !examine(unpacked_, is_known, contents, problem)) {
      return damage(at_, problem);
    }
    if (contents.start_time != chunk.start_time || contents.end_time != chunk.end_time) {
      return damage(at_, "the times in the chunk's header are not those of its messages");
    }
    ChunkIndexRecord index;
    index.start_time = chunk.start_time;
    index.end_time = chunk.end_time;
    index.offset = at_;
    index.length = record_length();
    index.compression = chunk.compression;
    index.compressed_size = chunk.records.size();
    index.uncompressed_size = chunk.uncompressed_size;
    scan_.index.chunks.push_back(std::move(index));
    for (const auto& [id, count] : contents.message_counts) {
      scan_.index.statistics.channel_message_counts[id] += count;
    }
  }

  // a Mark and Data End hold the checksum of everything in front of them
  void check_mark() {
    std::uint32_t crc = 0;
    // longer content would mean a wrong length that covers the following records
    if (content_.size() != sizeof crc || !decode_crc(content_, crc) || crc != crc_) {
      // even a chunk with correct messages may contain the changed byte
      return damage(confirmed_at_, "the bytes from here on differ from what was written");
    }
    is_proved_ = true;
    confirmed_at_ = at_ + record_length();
    proved_ = {scan_.index.schemas.size(), scan_.index.channels.size(), scan_.index.metadata.size()};
  }

  void keep_only_proved() {
    scan_.index.schemas.resize(proved_.schemas);
    scan_.index.channels.resize(proved_.channels);
    scan_.index.metadata.resize(proved_.metadata);
  }

  Status check_end() {
    FileIndex summary;
    Damage found;
    Status status;
    const bool is_whole = read_summary(file_, summary, found, status);
    if (!status.is_ok()) return status;
    complete_statistics(scan_.index);
    if (!is_whole) {
      scan_.damage = found;
    } else if (summary.statistics.message_count != scan_.index.statistics.message_count ||
               summary.chunks.size() != scan_.index.chunks.size()) {
      damage(at_, "the statistics are not those of the messages");
    }
    return status;
  }

  std::uint64_t record_length() const noexcept { return kRecordHeadBytes + content_.size(); }

  const InputFile& file_;
  FileScan& scan_;
  ChunkReader reader_;
  Bytes head_;
  Bytes content_;
  Bytes unpacked_;
  std::uint64_t at_ = 0;            // offset of the record being read
  std::uint64_t unproved_at_ = 0;   // offset of the first record without a confirming checksum
  std::uint64_t confirmed_at_ = 0;  // offset after the last correct Mark
  bool is_proved_ = false;
  std::uint32_t crc_ = 0;  // checksum of the bytes in front of at_
  Proved proved_;
};

}  // namespace

Status scan_file(const InputFile& file, FileScan& scan) {
  scan = {};
  return Scanner(file, scan).run();
}

}  // namespace slew::recording
