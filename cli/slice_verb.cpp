// SPDX-License-Identifier: Apache-2.0
// `slewring slice REC --from --to -o FILE` and `slewring merge REC... -o FILE`: a part of a recording as a recording,
// and such parts together as one.
#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/report_table.h"
#include "node/identity.h"
#include "recording/rewriting.h"
#include "session/recorded.h"

namespace slew::cli {
namespace {

constexpr const char* kCodings[] = {"zstd", "columns"};

struct SliceOptions {
  std::string recording;
  std::vector<std::string> parts;  // of merge
  std::string from, to;
  std::string output;
  std::string coding;
  bool is_json = false;
};

recording::WriterLimits limits_of(const SliceOptions& options, const recording::Reader& source) {
  const bool has_columns = options.coding.empty() ? session::has_columns(source) : options.coding == kCodings[1];
  recording::WriterLimits limits;
  limits.coding = has_columns ? recording::ChunkCoding::columns : recording::ChunkCoding::zstd;
  return limits;
}

// Recordings that end at damage: the new file is whole, and lacks what lies behind the damage.
using Damaged = std::vector<std::string>;

// Damage of index or checks alone leaves every message readable.
bool ends_at_damage(const recording::Reader& reader) {
  return reader.damage().has_value() && !reader.has_all_messages();
}

void print_rewritten(const SliceOptions& options, const recording::RewriteCounts& counts, const Damaged& damaged) {
  const double from = static_cast<double>(counts.start_time) * 1e-9, to = static_cast<double>(counts.end_time) * 1e-9;
  if (options.is_json) {
    Json gaps = Json::array();
    for (const std::string& gap : counts.gaps) gaps.push_back(gap);
    Json cut = Json::array();
    for (const std::string& file : damaged) cut.push_back(file);
    fmt::print("{}\n", Json({{"file", options.output},
                             {"bytes", counts.bytes},
                             {"messages", counts.messages},
                             {"from", from},
                             {"to", to},
                             {"gaps", gaps},
                             {"damaged", cut}})
                           .dump(2));
    return;
  }
  ReportTable rows({"", ""});
  rows.add({"file", fmt::format("{} ({:.2f} MB)", options.output, static_cast<double>(counts.bytes) * 1e-6)});
  rows.add({"saved",
            fmt::format("{} from {:.6g} s to {:.6g} s", counted(counts.messages, "message", "messages"), from, to)});
  for (const std::string& gap : counts.gaps) rows.add({"gap", gap});
  for (const std::string& file : damaged) rows.add({"lost", "what lies behind the damage of " + file});
  print_table(rows);
}

ExitCode slice(const SliceOptions& options) {
  recording::SliceDef def;
  const session::TimeRange range = session::recorded_range(options.from, options.to);
  def.from_ns = range.from_ns;
  def.to_ns = range.to_ns;
  // without these the values have no names
  for (const wire::Topic topic : {wire::Topic::session, wire::Topic::variable_directory}) {
    def.whole_topics.emplace_back(node::to_text(topic));
  }
  const auto reader = session::open_recording(options.recording);
  def.limits = limits_of(options, *reader);
  recording::RewriteCounts counts;
  require(recording::slice(*reader, options.output, def, counts));
  // a slice that ends in front of the damage lacks nothing
  const bool is_cut = ends_at_damage(*reader) && def.to_ns > reader->statistics().end_time;
  print_rewritten(options, counts, is_cut ? Damaged{options.recording} : Damaged{});
  return is_cut ? ExitCode::losses : ExitCode::ok;
}

ExitCode merge(const SliceOptions& options) {
  std::vector<std::unique_ptr<recording::Reader>> readers;
  std::vector<const recording::Reader*> parts;
  for (const std::string& part : options.parts) {
    readers.push_back(session::open_recording(part));
    parts.push_back(readers.back().get());
  }
  recording::RewriteCounts counts;
  require(recording::join(parts, options.output, limits_of(options, *parts.front()), counts));
  Damaged damaged;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (ends_at_damage(*parts[i])) damaged.push_back(options.parts[i]);
  }
  print_rewritten(options, counts, damaged);
  return counts.gaps.empty() && damaged.empty() ? ExitCode::ok : ExitCode::losses;
}

void add_output(options::Command& verb, SliceOptions& options) {
  verb.option("-o,--output", options.output, "file to write, a new one").required().value_name("FILE");
  verb.option("--coding", options.coding,
              "zstd: for every MCAP program; columns: smaller, for Slewring; without it that of the recording")
      .one_of({std::begin(kCodings), std::end(kCodings)})
      .value_name("CODING");
  verb.flag("--json", options.is_json, "for machines");
}

}  // namespace

void add_slice(options::Command& program) {
  options::Command verb = program.command("slice", "write a part of a recording as a recording of its own");
  const auto options = std::make_shared<SliceOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.option("--from", options->from, "leave out what lies before, such as '2.5 s'").value_name("TIME");
  verb.option("--to", options->to, "leave out this time and what lies behind").value_name("TIME");
  add_output(verb, *options);
  verb.footer(
      "Session and names of variables are in every slice. Slices that meet are one recording again with 'slewring "
      "merge'. A slice replays when it begins with the session. Exit code 3 when the recording is damaged in this "
      "time.\n\n"
      "Examples:\n"
      "  slewring slice runs/truck_crane-20260501-102030 --from 2s --to 5s -o lift.mcap\n"
      "  slewring slice runs/truck_crane-20260501-102030 --coding zstd -o for_foxglove.mcap");
  verb.action([options] { return slice(*options); });
}

void add_merge(options::Command& program) {
  options::Command verb = program.command("merge", "join parts of one session's recording");
  const auto options = std::make_shared<SliceOptions>();  // lives as long as the command line's callbacks
  verb.option("parts", options->parts, "recordings of one session, in any order").required().value_name("REC");
  add_output(verb, *options);
  verb.footer(
      "Exit code 3 when no part has some of the time between them, or a part ends at damage.\n\n"
      "Example:\n  slewring merge first.mcap second.mcap -o whole.mcap");
  verb.action([options] { return merge(*options); });
}

}  // namespace slew::cli
