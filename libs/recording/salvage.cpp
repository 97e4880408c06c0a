// SPDX-License-Identifier: Apache-2.0
#include "recording/salvage.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <tuple>

#include "recording/chunk_builder.h"
#include "recording/chunk_reader.h"

namespace slew::recording {
namespace {

constexpr const char* kRefuted = "the bytes differ from what was written";
constexpr std::uint64_t kChunkHeadBytes = kRecordHeadBytes + 40;  // up to the length of its compressed records
constexpr std::uint64_t kFirstSearchBytes = 4 * 1024;             // bytes searched at once: the next place
constexpr std::uint64_t kSearchBytes = 1u << 20;                  // to continue is near or far

class Salvager {
 public:
  Salvager(const InputFile& file, Salvage& salvage) : file_(file), salvage_(salvage) {}

  Status run() {
    Bytes magic;
    put_magic(magic);
    crc_ = crc32_of(magic);
    at_ = proved_to_ = std::min<std::uint64_t>(magic.size(), file_.size());
    Status status = file_.read(0, at_, content_);
    if (status.is_ok() && content_ != magic) lose(0, at_, "this is not how a recording begins");
    while (status.is_ok() && at_ < file_.size() && !salvage_.has_data_end) {
      std::string problem;
      status = take_record(problem);
      if (status.is_ok() && !problem.empty()) status = go_on_behind(problem);
    }
    drop_pending();
    std::ranges::sort(salvage_.records, {}, &ProvedRecord::offset);
    return status;
  }

 private:
  void lose(std::uint64_t offset, std::uint64_t end, const std::string& text) {
    if (end <= offset) return;
    if (!salvage_.lost.empty() && salvage_.lost.back().offset + salvage_.lost.back().size >= offset) {
      LostBytes& before = salvage_.lost.back();
      before.size = std::max(before.offset + before.size, end) - before.offset;
      return;
    }
    salvage_.lost.push_back({offset, end - offset, text});
  }

  // Reports the bytes not confirmed by a Mark as lost. Indexes of chunks are rebuilt and are no loss.
  void drop_pending() {
    for (const ProvedRecord& record : pending_) {
      if (record.opcode == Opcode::message_index) continue;
      lose(record.offset, record.offset + record.length, kRefuted);
    }
    pending_.clear();
  }

  // Reads the record at at_ and moves at_ behind it; returns its problem, if any.
  Status take_record(std::string& problem) {
    problem = "the file ends inside a record";
    const std::uint64_t left = file_.size() - at_;
    if (left < kRecordHeadBytes) return Status::ok();
    Status status = file_.read(at_, kRecordHeadBytes, head_);
    if (!status.is_ok()) return status;
    ByteSource head(head_);
    const Opcode opcode = Opcode{head.take<std::uint8_t>()};
    const std::uint64_t length = head.take<std::uint64_t>();
    if (length > left - kRecordHeadBytes) return status;
    status = file_.read(at_ + kRecordHeadBytes, std::min(length, kFrontBytes), content_);
    if (!status.is_ok()) return status;
    if (opcode == Opcode::invalid || !is_length_borne_out(opcode, content_, length)) {
      problem = "the length of a record is not that of its content";
      return status;
    }
    if (length > kFrontBytes) status = file_.read(at_ + kRecordHeadBytes, length, content_);
    if (!status.is_ok()) return status;
    problem = take_content(opcode);
    if (!problem.empty()) return status;
    at_ += kRecordHeadBytes + length;
    if (pending_.empty() || pending_.back().offset + pending_.back().length < at_) proved_to_ = at_;
    return status;
  }

  std::string take_content(Opcode opcode) {
    const ProvedRecord record = {opcode, at_, kRecordHeadBytes + content_.size()};
    switch (opcode) {
      case Opcode::chunk: {
        std::string problem = problem_of_chunk();
        if (!problem.empty()) return problem;
        salvage_.records.push_back(record);
        break;
      }
      case Opcode::attachment: {
        AttachmentRecord attachment;
        if (!decode_attachment(content_, attachment)) return "the checksum of an attachment differs";
        salvage_.records.push_back(record);
        break;
      }
      case Opcode::mark:
      case Opcode::data_end:
        return take_mark(opcode);
      default:
        pending_.push_back(record);
    }
    if (crc_) crc_ = crc32_of(content_, crc32_of(head_, *crc_));
    return {};
  }

  std::string problem_of_chunk() {
    ChunkRecord chunk;
    if (!decode_chunk(content_, chunk)) return "a chunk is not well formed";
    std::string problem;
    ChunkContents contents;
    const auto is_any = [](std::uint16_t) { return true; };
    if (!reader_.unpack(chunk, unpacked_, problem) || !examine(unpacked_, is_any, contents, problem)) return problem;
    return {};  // the times in its head follow from its messages
  }

  // A Mark or Data End: confirms the bytes in front of it, or restarts the checksum.
  std::string take_mark(Opcode opcode) {
    std::uint32_t crc = 0;
    if (content_.size() != sizeof crc || !decode_crc(content_, crc)) return "a mark is not well formed";
    if (crc_ && *crc_ != crc) return kRefuted;
    if (crc_) {
      std::ranges::copy_if(pending_, std::back_inserter(salvage_.records),
                           [](const ProvedRecord& r) { return r.opcode != Opcode::message_index; });
      pending_.clear();
    }
    drop_pending();
    crc_ = crc32_of(content_, crc32_of(head_, crc));
    salvage_.has_data_end = opcode == Opcode::data_end;
    return {};
  }

  // ---- after damage ----------------------------------------------------------------------------------------

  // A wrong length may have covered good records: the search begins after the last proved record.
  Status go_on_behind(const std::string& problem) {
    salvage_.is_damaged = true;
    const std::uint64_t damaged_from = proved_to_;
    std::erase_if(pending_, [&](const ProvedRecord& record) { return record.offset >= damaged_from; });
    drop_pending();
    crc_.reset();
    Status status;
    for (std::uint64_t candidate = damaged_from;; ++candidate) {
      status = find(candidate);
      if (!status.is_ok() || candidate == file_.size()) break;
      at_ = candidate;
      std::string also;
      status = take_record(also);
      if (!status.is_ok() || also.empty()) {
        lose(damaged_from, candidate, problem);
        return status;
      }
    }
    at_ = file_.size();
    lose(damaged_from, at_, problem);
    return status;
  }

  // Moves to the next candidate for a Mark, Data End or chunk, or to the end of the file.
  Status find(std::uint64_t& from) {
    std::uint64_t block = kFirstSearchBytes;
    for (; from < file_.size(); from += block, block = std::min(2 * block, kSearchBytes)) {
      const std::uint64_t size = std::min(block + kChunkHeadBytes, file_.size() - from);
      const Status status = file_.read(from, size, searched_);
      if (!status.is_ok()) return status;
      for (std::size_t i = 0; i < std::min(size, block); ++i) {
        if (!looks_like_a_record(ByteSpan(searched_).subspan(i))) continue;
        from += i;
        return status;
      }
    }
    from = file_.size();
    return Status::ok();
  }

  static bool looks_like_a_record(ByteSpan bytes) {
    ByteSource source(bytes);
    switch (Opcode{source.take<std::uint8_t>()}) {
      case Opcode::mark:
      case Opcode::data_end:
        return source.take<std::uint64_t>() == sizeof(std::uint32_t) && source.left() >= sizeof(std::uint32_t);
      case Opcode::chunk:
        std::ignore = source.take_bytes(4 * sizeof(std::uint64_t) + sizeof(std::uint32_t));
        return is_written_compression(source.take_string());
      default:
        return false;
    }
  }

  const InputFile& file_;
  Salvage& salvage_;
  ChunkReader reader_;
  Bytes head_;
  Bytes content_;
  Bytes unpacked_;
  Bytes searched_;
  std::uint64_t at_ = 0;               // offset of the record being read
  std::uint64_t proved_to_ = 0;        // offset after the last proved or confirmed record
  std::optional<std::uint32_t> crc_;   // checksum that a Mark at at_ must hold; none: unknown after damage
  std::vector<ProvedRecord> pending_;  // records that await the next Mark
};

}  // namespace

Status salvage_file(const InputFile& file, Salvage& salvage) {
  salvage = {};
  return Salvager(file, salvage).run();
}

}  // namespace slew::recording
