// SPDX-License-Identifier: Apache-2.0
#include "session/recorded.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "node/identity.h"
#include "recording/run_directory.h"
#include "scene/name_pattern.h"
#include "scene/units.h"
#include "session/unrecorded.h"
#include "transport/cdr/codec.h"

namespace slew::session {
namespace {

using recording::Reader;
using wire::Topic;
using Visit = recording::Reader::Visit;

Topic topic_of(const recording::RecordedChannel& channel) {
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    if (channel.topic == node::to_text(static_cast<Topic>(i))) return static_cast<Topic>(i);
  }
  return Topic::count;
}

// A damaged chunk ends the reading; the messages in front of it count.
void read_all(const Reader& reader, const recording::MessageFilter& filter,
              const std::function<Visit(const recording::RecordedMessage&)>& visit) {
  const Status status = reader.for_each(filter, visit);
  if (status.code == ExitCode::storage) throw Failure(status.code, status.text);
  if (!status.is_ok()) std::fprintf(stderr, "warning: %s\n", printable_lines(status.text).c_str());
}

constexpr const char* kSceneFile = "scene.yaml";

struct Attached {
  std::string text;
  Status status;
};

Attached read_attached(const Reader& reader, const std::string& name) {
  recording::Bytes content;
  Status status = reader.read_attachment(name, content);
  return {std::string(recording::as_text(content)), std::move(status)};
}

// The recorded description of the recording's own session; none: it is not there.
std::optional<wire::SessionDescription> description_of(const Reader& reader) {
  recording::MessageFilter filter;
  filter.topics.emplace_back(node::to_text(Topic::session));
  std::optional<wire::SessionDescription> found;
  wire::SessionDescription session;
  // a damaged part behind the description does not matter
  static_cast<void>(reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    const bool is_it = transport::decode(message.payload, session) &&
                       node::to_text(session.header.session) == reader.identity().session_id &&
                       !session.scene_text.empty();
    if (is_it) found = std::move(session);
    return is_it ? Visit::stop : Visit::go_on;
  }));
  return found;
}

std::vector<scene::Asset> described_manifest(const Reader& reader, const Status& problem) {
  const std::optional<wire::SessionDescription> session = description_of(reader);
  if (!session) {
    if (!problem.is_ok()) throw Failure(problem.code, problem.text);
    throw Failure(ExitCode::bad_input, "the recording's list of files cannot be read; it is damaged");
  }
  std::vector<scene::Asset> assets;
  for (const wire::Asset& asset : session->assets) assets.push_back({asset.name, asset.size, asset.sha256});
  return assets;
}

// The same text is in the recording twice: damage of one is no obstacle.
void warn_of_scene(const Reader& reader) {
  const Status problem = read_attached(reader, kSceneFile).status;
  if (problem.is_ok() || !description_of(reader)) return;
  const std::string what = problem.text.substr(0, problem.text.find(';'));
  std::fprintf(stderr, "warning: %s; the scene is taken from the session's recorded description, which has the same\n",
               printable_lines(what).c_str());
}

}  // namespace

recording::MessageFilter only(std::initializer_list<Topic> topics) {
  recording::MessageFilter filter;
  for (const Topic topic : topics) filter.topics.emplace_back(node::to_text(topic));
  return filter;
}

std::vector<scene::Asset> recorded_manifest(const Reader& reader) {
  const Attached manifest = read_attached(reader, "manifest.json");
  const Json list = manifest.status.is_ok() ? Json::parse(manifest.text).value_or(Json()) : Json();
  if (!list.is_array()) return described_manifest(reader, manifest.status);
  std::vector<scene::Asset> assets;
  for (const Json& entry : list.items()) {
    scene::Asset& asset = assets.emplace_back();
    asset.name = entry.text_or("name", "");
    if (const Json* size = entry.find("size")) asset.size = static_cast<std::uint64_t>(size->integer());
    const std::string sum = entry.text_or("sha256", "");
    for (std::size_t i = 0; i < asset.sha256.size() && 2 * i + 1 < sum.size(); ++i) {
      std::from_chars(sum.data() + 2 * i, sum.data() + 2 * i + 2, asset.sha256[i], 16);
    }
  }
  return assets;
}

std::unique_ptr<Reader> open_recording(const std::string& path) {
  std::filesystem::path file = path;
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) file /= recording::kRecordingFileName;
  std::unique_ptr<Reader> reader;
  require(Reader::open(file, reader));
  const std::string damage = reader->damage_text();
  if (!damage.empty()) std::fprintf(stderr, "warning: %s\n", printable_lines(damage).c_str());
  warn_of_scene(*reader);
  return reader;
}

scene::Scene recorded_scene(const Reader& reader, const std::string& assets) {
  const std::string text = recorded_scene_text(reader), name = reader.identity().scene;
  scene::Scene plain = scene::load_text(text, name);
  if (!plain.needs_files()) return plain;
  const Status status = scene::check_assets(recorded_manifest(reader), assets);
  if (!status.is_ok()) {
    throw Failure(ExitCode::bad_input, "the scene's files are not in '" + assets +
                                           "' as they were: " + status.text.substr(0, status.text.find("; this node")) +
                                           "; nothing was computed; name their folder with --assets");
  }
  return scene::load_text(text, name, {}, assets);
}

std::uint64_t recorded_time_ns(const std::string& option, const std::string& text) {
  scene::UnitSystem units;
  const scene::QuantityResult time = scene::read_quantity(text, scene::Writing::quoted, Dimension::time, units);
  const bool is_bare = text.find_first_not_of("0123456789.eE+-") == std::string::npos;
  const double seconds = time.value ? *time.value : is_bare ? std::strtod(text.c_str(), nullptr) : -1;
  // beyond 2^63 ns no recording goes
  if (!(seconds >= 0) || seconds > 9e9) {
    throw Failure(ExitCode::bad_input, option + " '" + text +
                                           "' is not a time of the recording; nothing was written; expected one such "
                                           "as '2.5 s', or a bare number in s, 0 or more");
  }
  return static_cast<std::uint64_t>(std::llround(seconds * 1e9));
}

TimeRange recorded_range(const std::string& from, const std::string& to) {
  TimeRange range;
  if (!from.empty()) range.from_ns = recorded_time_ns("--from", from);
  if (!to.empty()) range.to_ns = recorded_time_ns("--to", to);
  if (range.to_ns < range.from_ns) {
    throw Failure(ExitCode::bad_input,
                  "--to " + to + " lies before --from " + from + "; nothing was written; name the earlier time first");
  }
  return range;
}

std::string recorded_assets(const std::string& recording) {
  std::filesystem::path file = recording;
  std::error_code error;
  if (!std::filesystem::is_directory(file, error)) file = file.parent_path();
  return (file / "assets").string();
}

void keep_assets(const scene::Scene& scene, const std::string& folder, const std::string& recording) {
  const std::filesystem::path kept = recorded_assets(recording);
  const auto keep = [&](const std::filesystem::path& from, const std::string& name) {
    std::error_code error;
    const std::filesystem::path to = kept / name;
    std::filesystem::create_directories(to.parent_path(), error);
    if (!error) std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
    if (!error) return;
    throw Failure(ExitCode::storage, "the scene's files were not all copied to " + kept.string() + ": " + name + ": " +
                                         error.message() + "; the recording is complete; replay it with --assets " +
                                         folder);
  };
  for (const scene::Asset& asset : scene.assets) keep(std::filesystem::path(folder) / asset.name, asset.name);
  // a saved session may continue without the meshes for the eye
  for (const scene::GraphicDef& graphic : scene.graphics) {
    const std::filesystem::path from = std::filesystem::path(folder) / graphic.file;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(from, ignored)) keep(from, graphic.file);
  }
  if (scene.script.file && !scene.script.file->found.empty()) keep(scene.script.file->found, scene.script.file->file);
}

RecordedView view_recording(const Reader& reader, const std::vector<std::string>& patterns) {
  RecordedView seen{observer::SessionView(), Tally({patterns, reader.identity().communication_step})};
  const auto take = [&](const recording::RecordedMessage& message) {
    seen.view.take(topic_of(*message.channel), message.payload, static_cast<double>(message.log_time_ns) / 1e9,
                   &seen.tally);
    return Visit::go_on;
  };
  // names first: a message of the directory may be filed behind the first values
  read_all(reader, only({Topic::session}), take);
  read_all(reader, only({Topic::variable_directory, Topic::node_status, Topic::health}), take);
  seen.tally.end_names();
  read_all(reader, only({Topic::variables}), take);
  return seen;
}

void watch_recording(const Reader& reader, observer::SessionView& view, observer::Receiver& receiver) {
  const auto take = [&](const recording::RecordedMessage& message) {
    view.take(topic_of(*message.channel), message.payload, static_cast<double>(message.log_time_ns) / 1e9, &receiver);
    return Visit::go_on;
  };
  read_all(reader, only({Topic::session}), take);
  read_all(reader, only({Topic::variable_directory}), take);
  read_all(reader, only({Topic::node_status, Topic::health, Topic::variables}), take);
}

namespace {

Curves named_curves(const Reader& reader, std::span<const std::string> patterns) {
  Curves curves({patterns.begin(), patterns.end()}, reader.identity().communication_step);
  wire::VariableDirectory directory;
  read_all(reader, only({Topic::variable_directory}), [&](const recording::RecordedMessage& message) {
    if (transport::decode(message.payload, directory)) curves.take(directory);
    return Visit::go_on;
  });
  curves.end_names();
  return curves;
}

}  // namespace

std::vector<std::string> recorded_names(const Reader& reader) {
  return named_curves(reader, {}).names();
}

std::vector<plotting::Series> read_series(const Reader& reader, std::span<const std::string> patterns, Units units,
                                          const TimeRange& range) {
  Curves curves = named_curves(reader, patterns);
  const std::vector<std::string> names = curves.names();
  if (const std::vector<std::string> missing = scene::unmatched(patterns, names); !missing.empty()) {
    throw Failure(ExitCode::bad_input, why_missing(reader, missing, names));
  }
  wire::VariableBlock block;
  recording::MessageFilter blocks = only({Topic::variables});
  blocks.from_ns = range.from_ns;
  blocks.to_ns = range.to_ns;
  read_all(reader, blocks, [&](const recording::RecordedMessage& message) {
    if (transport::decode(message.payload, block)) curves.take(block, static_cast<double>(message.log_time_ns) / 1e9);
    return Visit::go_on;
  });
  return curves.select(patterns, units);
}

std::optional<ClosingCounts> closing_counts(const Reader& reader) {
  const recording::TextMap* summary = reader.find_metadata(recording::kSummaryName);
  if (summary == nullptr || reader.damage() || !reader.has_all_messages()) return std::nullopt;
  const auto text = [&](const char* key) {
    const auto found = summary->find(key);
    return found == summary->end() ? std::string() : found->second;
  };
  const std::optional<TickSpan> ticks = node::tick_span_of(text(recording::kTicksKey));
  std::optional<node::FlagCounter> flags = node::FlagCounter::of_text(text(recording::kFlagsKey));
  const std::string variables = text(recording::kVariablesKey);
  if (!ticks || !flags || variables.empty()) return std::nullopt;
  return ClosingCounts{*ticks, std::move(*flags), std::strtoull(variables.c_str(), nullptr, 16)};
}

TickSpan tick_span(const Reader& reader) {
  node::TickCounter counter(reader.identity().communication_step);
  std::vector<std::int64_t> sent;  // ns, wall clock of their writer
  wire::Tick tick;
  wire::NodeStatus status;
  read_all(reader, only({Topic::tick, Topic::node_status}), [&](const recording::RecordedMessage& message) {
    const auto sent_ns = static_cast<std::int64_t>(message.publish_time_ns);
    if (topic_of(*message.channel) == Topic::tick && transport::decode(message.payload, tick)) {
      counter.take(tick.header, tick.flags);
      sent.push_back(sent_ns);
    } else if (transport::decode(message.payload, status)) {
      counter.take_status(status, sent_ns);
    }
    return Visit::go_on;
  });
  std::sort(sent.begin(), sent.end());
  for (const std::int64_t sent_ns : sent) counter.take_time(sent_ns);
  return counter.span();
}

std::string left_out_text(const Reader& reader) {
  switch (reader.identity().steps) {
    case recording::RecordedSteps::ticks:
      return "no samples (recording.steps: ticks): replay computes them again, and compares digests of the state "
             "hashes";
    case recording::RecordedSteps::none:
      return "no ticks and no samples (recording.steps: none): the session cannot be replayed";
    default:
      return "";
  }
}

bool has_columns(const Reader& reader) {
  const auto& chunks = reader.chunks();
  return std::any_of(chunks.begin(), chunks.end(),
                     [](const recording::ChunkIndexRecord& chunk) { return chunk.compression == recording::kColumns; });
}

std::string behind_end_text(const TickSpan& span) {
  if (span.behind_end == 0) return "";
  return fmt::format(
      "{} behind an END of their epoch: another program wrote that END or those ticks, or a message was "
      "changed; replay computes up to the END",
      counted(span.behind_end, "tick is", "ticks are"));
}

std::string recorded_scene_text(const Reader& reader) {
  Attached scene = read_attached(reader, kSceneFile);
  if (scene.status.is_ok()) return std::move(scene.text);
  std::optional<wire::SessionDescription> session = description_of(reader);
  if (!session) throw Failure(scene.status.code, scene.status.text);
  return std::move(session->scene_text);
}

}  // namespace slew::session
