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

// Where in the curves a variable's values go: by writer and index.
using Places = std::map<std::pair<wire::Role, std::uint32_t>, std::size_t>;

void add_block(const wire::VariableBlock& block, double time, const Places& places,
               std::span<plotting::Series> curves) {
  for (auto place = places.lower_bound({block.header.role, block.first}); place != places.end(); ++place) {
    const auto& [role, index] = place->first;
    if (role != block.header.role || index >= block.first + block.values.size()) break;
    plotting::Series& curve = curves[place->second];
    curve.time.push_back(time);
    curve.values.push_back(block.values[index - block.first]);
  }
}

bool was_paused(const std::map<std::uint64_t, bool>& paused_since, std::uint64_t from_ns, std::uint64_t to_ns) {
  auto change = paused_since.upper_bound(from_ns);
  if (change != paused_since.begin() && std::prev(change)->second) return true;
  for (; change != paused_since.end() && change->first < to_ns; ++change) {
    if (change->second) return true;
  }
  return false;
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
  if (scene.script.file && !scene.script.file->found.empty()) keep(scene.script.file->found, scene.script.file->file);
}

SessionView view_recording(const Reader& reader, Values values) {
  SessionView view;
  const auto take = [&](const recording::RecordedMessage& message) {
    view.take(topic_of(*message.channel), message.payload);
    return Visit::go_on;
  };
  // names first: a message of the directory may be filed behind the first values
  read_all(reader, only({Topic::session}), take);
  read_all(reader, only({Topic::variable_directory, Topic::node_status, Topic::health}), take);
  if (values == Values::all) read_all(reader, only({Topic::variables}), take);
  return view;
}

namespace {

struct RecordedVariable {
  std::pair<wire::Role, std::uint32_t> place;  // writer and index
  std::string unit;
};
using Known = std::map<std::string, RecordedVariable>;

Known known_variables(const Reader& reader) {
  Known known;
  read_all(reader, only({Topic::variable_directory}), [&](const recording::RecordedMessage& message) {
    wire::VariableDirectory directory;
    if (!transport::decode(message.payload, directory)) return Visit::go_on;
    for (std::size_t i = 0; i < directory.entries.size(); ++i) {
      const std::pair place(directory.header.role, directory.first + static_cast<std::uint32_t>(i));
      const wire::VariableEntry& entry = directory.entries[i];
      known.emplace(entry.name, RecordedVariable{place, entry.unit});
    }
    return Visit::go_on;
  });
  return known;
}

// in the order of roles and places, independent of the order of arrival
std::vector<std::string> names_of(const Known& known) {
  std::vector<std::string> names;
  for (const auto& entry : known) names.push_back(entry.first);
  std::sort(names.begin(), names.end(),
            [&](const std::string& a, const std::string& b) { return known.at(a).place < known.at(b).place; });
  return names;
}

}  // namespace

std::vector<std::string> recorded_names(const Reader& reader) {
  return names_of(known_variables(reader));
}

std::vector<plotting::Series> read_series(const Reader& reader, std::span<const std::string> patterns, Units units,
                                          const TimeRange& range) {
  const Known known = known_variables(reader);
  const std::vector<std::string> names = names_of(known);
  if (const std::vector<std::string> missing = scene::unmatched(patterns, names); !missing.empty()) {
    throw Failure(ExitCode::bad_input, why_missing(reader, missing, names));
  }
  Places places;
  std::vector<plotting::Series> curves;
  for (const std::string& name : scene::choose(patterns, names)) {
    const auto& [place, unit] = known.at(name);
    places.emplace(place, curves.size());
    plotting::Series curve;
    curve.name = name;
    curve.unit = units == Units::display ? std::string(display_unit(unit).unit) : unit;
    if (curve.unit == "1") curve.unit.clear();
    curves.push_back(std::move(curve));
  }
  // values; a node's blocks come every k-th step, from step 0 on
  std::map<wire::Role, StepIndex> steps_between;
  wire::VariableBlock block;
  recording::MessageFilter blocks = only({Topic::variables});
  blocks.from_ns = range.from_ns;
  blocks.to_ns = range.to_ns;
  read_all(reader, blocks, [&](const recording::RecordedMessage& message) {
    if (transport::decode(message.payload, block) && block.header.phase == wire::Phase::running) {
      add_block(block, static_cast<double>(message.log_time_ns) / 1e9, places, curves);
      StepIndex& between = steps_between[block.header.role];
      between = std::gcd(between, block.header.step);
    }
    return Visit::go_on;
  });
  for (const auto& [place, curve] : places) {
    curves[curve].spacing =
        static_cast<double>(steps_between[place.first]) * reader.identity().communication_step.seconds();
  }
  if (units == Units::display) {
    for (plotting::Series& curve : curves) {
      const double factor = display_unit(known.at(curve.name).unit).factor;
      for (double& value : curve.values) value *= factor;
    }
  }
  return curves;
}

TickSpan tick_span(const Reader& reader) {
  TickSpan span;
  std::vector<std::uint64_t> ticks;                                 // ns, wall clock of their writer
  std::map<std::uint64_t, bool> paused_since;                       // ns, at each status of io_node
  std::map<std::uint32_t, std::pair<StepIndex, StepIndex>> epochs;  // first and last step
  std::map<std::uint32_t, StepIndex> ends;                          // first step that an END names
  wire::Tick tick;
  wire::NodeStatus status;
  read_all(reader, only({Topic::tick, Topic::node_status}), [&](const recording::RecordedMessage& message) {
    if (topic_of(*message.channel) == Topic::tick && transport::decode(message.payload, tick)) {
      const bool is_end = (tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0;
      if (tick.header.phase == wire::Phase::running && !is_end) {
        auto& [first, last] = epochs.try_emplace(tick.header.epoch, tick.header.step, tick.header.step).first->second;
        first = std::min(first, tick.header.step);
        last = std::max(last, tick.header.step);
      }
      if (tick.header.phase == wire::Phase::running && is_end) {
        StepIndex& end = ends.try_emplace(tick.header.epoch, tick.header.step).first->second;
        end = std::min(end, tick.header.step);
      }
      if (message.publish_time_ns != 0) ticks.push_back(message.publish_time_ns);
    } else if (transport::decode(message.payload, status) && status.header.role == wire::Role::io) {
      paused_since[message.publish_time_ns] = is_pause(status);
    }
    return Visit::go_on;
  });
  for (const auto& [epoch, steps] : epochs) {
    span.steps += steps.second - steps.first + 1;
    span.epoch = epoch;
    span.next = steps.second + 1;
    const auto end = ends.find(epoch);
    if (end != ends.end() && steps.second >= end->second) {
      span.behind_end += static_cast<std::uint64_t>(steps.second - std::max(steps.first, end->second) + 1);
    }
  }
  std::sort(ticks.begin(), ticks.end());
  const auto step_ns = static_cast<std::uint64_t>(reader.identity().communication_step.ns);
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const std::uint64_t gap_ns = ticks[i] - ticks[i - 1];
    const bool is_paused = was_paused(paused_since, ticks[i - 1], ticks[i]);
    const std::uint64_t running_ns = is_paused ? std::min(gap_ns, step_ns) : gap_ns;
    span.wall_time += static_cast<double>(running_ns) * 1e-9;
    span.paused_time += static_cast<double>(gap_ns - running_ns) * 1e-9;
  }
  return span;
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
