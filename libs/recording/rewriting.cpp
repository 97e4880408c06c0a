// SPDX-License-Identifier: Apache-2.0
#include "recording/rewriting.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <system_error>
#include <utility>

namespace slew::recording {
namespace {

constexpr const char* kOfKey = "of";
constexpr const char* kFromKey = "from_ns";
constexpr const char* kToKey = "to_ns";
constexpr std::uint64_t kNoEnd = std::numeric_limits<std::uint64_t>::max();

double seconds(std::uint64_t ns) noexcept {
  return static_cast<double>(ns) * 1e-9;
}

// Times that a file has: those of its slice, else those of its messages.
struct Times {
  std::uint64_t from = 0;
  std::uint64_t to = 0;  // not included
};

std::uint64_t number_in(const TextMap& entries, const char* key, std::uint64_t otherwise) {
  const auto found = entries.find(key);
  std::uint64_t value = otherwise;
  if (found != entries.end()) {
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), value);
  }
  return value;
}

Times times_of(const Reader& reader) {
  const std::uint64_t end = reader.statistics().end_time;
  const TextMap* entries = reader.find_metadata(kSliceName);
  if (entries == nullptr) return {reader.statistics().start_time, end + 1};
  const std::uint64_t to = number_in(*entries, kToKey, kNoEnd);
  return {number_in(*entries, kFromKey, 0), to == kNoEnd ? end + 1 : to};
}

// The new file, which takes messages of one source after the other.
class Rewriting {
 public:
  Status start(const Reader& first, const std::filesystem::path& to, const WriterLimits& limits) {
    path_ = to;
    Status status = Writer::create(to, first.identity(), limits, writer_);
    for (const AttachmentIndexRecord& attachment : first.attachments()) {
      Bytes content;
      if (status.is_ok()) status = first.read_attachment(attachment.name, content);
      if (status.is_ok()) status = writer_->add_attachment(attachment.name, attachment.media_type, content);
    }
    return status;
  }

  Status add_source(const Reader& source) {
    Status status;
    for (const RecordedChannel& channel : source.channels()) {
      if (!status.is_ok() || channels_.contains(channel.topic)) continue;
      status = writer_->add_channel({channel.topic, channel.type_name, channel.idl, channel.metadata},
                                    channels_[channel.topic]);
    }
    for (const MetadataRecord& record : source.metadata()) {
      const bool is_of_source =
          record.name == kIdentityName || record.name == kSummaryName || record.name == kSliceName;
      if (status.is_ok() && !is_of_source) status = writer_->add_metadata(record.name, record.entries);
    }
    return status;
  }

  Status add_messages(const Reader& source, const MessageFilter& filter) {
    Status written;
    const Status read = source.for_each(filter, [&](const RecordedMessage& message) {
      written = writer_->append(channels_.at(message.channel->topic), message);
      ++count_;
      return written.is_ok() ? Reader::Visit::go_on : Reader::Visit::stop;
    });
    return written.is_ok() ? read : written;
  }

  Status add_metadata(const char* name, const TextMap& entries) { return writer_->add_metadata(name, entries); }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

  // Closes the file, or removes it again after a failure.
  Status finish(Status status, RewriteCounts& counts) {
    if (writer_ == nullptr) return status;  // nothing was created
    if (const Status closed = writer_->close({}); status.is_ok()) status = closed;
    counts.messages = count_;
    counts.bytes = writer_->file_bytes();
    writer_.reset();
    if (status.is_ok()) return status;
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    status.text += fmt::format("; {} was removed again", path_.string());
    return status;
  }

 private:
  std::filesystem::path path_;
  std::unique_ptr<Writer> writer_;
  std::map<std::string, ChannelId> channels_;  // by topic
  std::uint64_t count_ = 0;
};

TextMap slice_entries(const Reader& source, const Times& times) {
  return {{kOfKey, source.path().filename().string()},
          {kFromKey, fmt::to_string(times.from)},
          {kToKey, fmt::to_string(times.to)}};
}

Status check_parts(const std::vector<std::pair<Times, const Reader*>>& parts, RewriteCounts& counts) {
  const Reader& first = *parts.front().second;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto& [times, part] = parts[i];
    if (part->identity().session_id != first.identity().session_id) {
      return Status::error(
          ExitCode::bad_input,
          fmt::format("{} and {} are recordings of two sessions ({} and {}); nothing was written; join "
                      "parts of one session",
                      first.path().string(), part->path().string(), first.identity().session_id,
                      part->identity().session_id));
    }
    const auto& [before, former] = parts[i - 1];
    if (times.from < before.to) {
      return Status::error(ExitCode::bad_input,
                           fmt::format("{} and {} both have the time from {:.6g} s to {:.6g} s; nothing was written; "
                                       "cut one of them with 'slewring slice'",
                                       former->path().string(), part->path().string(), seconds(times.from),
                                       seconds(std::min(before.to, times.to))));
    }
    // between the messages of two steps lies no gap
    const auto step = static_cast<std::uint64_t>(first.identity().communication_step.ns);
    if (times.from > before.to + step) {
      counts.gaps.push_back(
          fmt::format("no part has the time from {:.6g} s to {:.6g} s", seconds(before.to), seconds(times.from)));
    }
  }
  return Status::ok();
}

}  // namespace

Status slice(const Reader& source, const std::filesystem::path& to, const SliceDef& def, RewriteCounts& counts) {
  counts = {};
  MessageFilter inside;
  inside.from_ns = def.from_ns;
  inside.to_ns = def.to_ns - 1;
  const Times whole = times_of(source);
  if (def.to_ns <= def.from_ns || def.from_ns >= whole.to || def.to_ns <= whole.from) {
    return Status::error(
        ExitCode::bad_input,
        fmt::format("{}: the recording goes from {:.6g} s to {:.6g} s and has no message in this time; "
                    "nothing was written; choose other times",
                    source.path().string(), seconds(whole.from), seconds(whole.to)));
  }
  Rewriting file;
  Status status = file.start(source, to, def.limits);
  const Times kept{std::max(def.from_ns, whole.from), std::min(def.to_ns, whole.to)};
  if (status.is_ok()) status = file.add_source(source);
  if (status.is_ok()) status = file.add_metadata(kSliceName, slice_entries(source, kept));
  if (status.is_ok() && def.from_ns > 0 && !def.whole_topics.empty()) {
    MessageFilter before;
    before.topics = def.whole_topics;
    before.to_ns = def.from_ns - 1;
    status = file.add_messages(source, before);
  }
  if (status.is_ok()) status = file.add_messages(source, inside);
  counts.start_time = kept.from;
  counts.end_time = kept.to;
  return file.finish(std::move(status), counts);
}

Status join(std::span<const Reader* const> parts, const std::filesystem::path& to, const WriterLimits& limits,
            RewriteCounts& counts) {
  counts = {};
  std::vector<std::pair<Times, const Reader*>> ordered;
  for (const Reader* part : parts) ordered.emplace_back(times_of(*part), part);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first.from < b.first.from; });
  Status status = check_parts(ordered, counts);
  if (!status.is_ok()) return status;
  Rewriting file;
  status = file.start(*ordered.front().second, to, limits);
  for (const auto& [times, part] : ordered) {
    if (status.is_ok()) status = file.add_source(*part);
  }
  const Times whole{ordered.front().first.from, ordered.back().first.to};
  if (status.is_ok() && whole.from > 0) {
    status = file.add_metadata(kSliceName, slice_entries(*ordered.front().second, whole));
  }
  bool is_first = true;
  for (const auto& [times, part] : ordered) {
    // what a slice has from in front of its times is in the first one, or not there
    MessageFilter filter;
    filter.from_ns = std::exchange(is_first, false) ? 0 : times.from;
    if (status.is_ok()) status = file.add_messages(*part, filter);
  }
  counts.start_time = whole.from;
  counts.end_time = whole.to;
  return file.finish(std::move(status), counts);
}

}  // namespace slew::recording
