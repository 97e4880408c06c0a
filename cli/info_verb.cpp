// SPDX-License-Identifier: Apache-2.0
// `slewring info REC`: what a recording holds.
#include <fmt/format.h>

#include <cstdlib>

#include "analysis/run_report/flag_report.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"
#include "node/identity.h"
#include "recording/recovery.h"
#include "recording/rewriting.h"
#include "session/recorded.h"
#include "session/recorded_events.h"
#include "session/recorded_place.h"

namespace slew::cli {
namespace {

struct InfoOptions {
  std::string recording;
  bool is_verifying = false;
  bool has_all_events = false;
  bool is_json = false;
};

struct Counts {
  std::uint64_t recorded = 0;
  std::string lost = "?";
};

std::map<std::string, Counts> counts_of(const recording::Reader& reader) {
  std::map<std::string, Counts> counts;
  const recording::TextMap* summary = reader.find_metadata(recording::kSummaryName);
  for (const recording::RecordedChannel& channel : reader.channels()) {
    if (channel.message_count == 0) continue;
    Counts& count = counts[channel.topic];
    count.recorded = channel.message_count;
    if (summary == nullptr) continue;
    const auto lost = summary->find(channel.topic + ".lost");
    if (lost != summary->end()) count.lost = lost->second;
  }
  return counts;
}

// How the file ends, and how the session did when that was not in order.
std::string end_of(const recording::Reader& reader) {
  if (!reader.has_all_messages()) return "cut: " + reader.damage_text();
  const recording::TextMap* recovered = reader.find_metadata(recording::kRecoveryName);
  if (recovered != nullptr) {
    const auto entry = [recovered](const char* key) {
      const auto found = recovered->find(key);
      return found == recovered->end() ? std::string("?") : found->second;
    };
    return fmt::format("recovered from {} ({} bytes){}; lost {}", entry("from"), entry("from_bytes"),
                       entry("was_cut") == "yes" ? ", whose end was missing" : "",
                       entry("lost").empty() ? "nothing in front of it" : entry("lost"));
  }
  if (const recording::TextMap* part = reader.find_metadata(recording::kSliceName)) {
    const auto time = [part](const char* key) {
      const auto found = part->find(key);
      return found == part->end() ? 0 : std::strtod(found->second.c_str(), nullptr) * 1e-9;
    };
    return fmt::format("a slice of {} from {:.6g} s to {:.6g} s", part->count("of") == 0 ? "?" : part->at("of"),
                       time("from_ns"), time("to_ns"));
  }
  const recording::TextMap* summary = reader.find_metadata(recording::kSummaryName);
  if (summary == nullptr || summary->count("end") == 0 || summary->at("exit_code") == "0") return "closed in order";
  // the recorder ends with 6, the session goes on
  if (summary->at("exit_code") == std::to_string(static_cast<int>(ExitCode::storage))) {
    return "closed before the session's end, which went on: " + summary->at("end");
  }
  return fmt::format("closed in order; the session ended with code {}: {}", summary->at("exit_code"),
                     summary->at("end"));
}

// What the recorder left out, a sentence for each time.
std::vector<std::string> gaps_of(const recording::Reader& reader) {
  constexpr std::string_view kLeftOut = "left_out.";
  std::vector<std::string> gaps;
  for (const recording::MetadataRecord& record : reader.metadata()) {
    if (record.name != recording::kGapName) continue;
    const auto entry = [&](const char* key) {
      const auto found = record.entries.find(key);
      return found == record.entries.end() ? std::string("?") : found->second;
    };
    std::string counts;
    for (const auto& [key, count] : record.entries) {
      if (key.starts_with(kLeftOut))
        counts += (counts.empty() ? "" : ", ") + count + " of " + key.substr(kLeftOut.size());
    }
    gaps.push_back(fmt::format("steps {} to {}{}: {} left out, {}", entry("from_step"), entry("to_step"),
                               entry("epoch") == "0" ? "" : " of epoch " + entry("epoch"), counts, entry("cause")));
  }
  return gaps;
}

Json events_json(const recording::Reader& reader) {
  Json events = Json::array();
  for (const session::RecordedEvent& event : session::recorded_events(reader)) {
    events.push_back({{"step", event.step}, {"epoch", event.epoch}, {"text", event.text}});
  }
  return events;
}

// The first ones, unless all are requested.
void add_events(const recording::Reader& reader, bool has_all, ReportTable& rows) {
  constexpr std::size_t kShown = 10;
  const std::vector<session::RecordedEvent> events = session::recorded_events(reader);
  const std::size_t shown = has_all ? events.size() : std::min(kShown, events.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const session::RecordedEvent& event = events[i];
    rows.add({"event", fmt::format("step {}{}: {}", event.step,
                                   event.epoch == 0 ? "" : fmt::format(" of epoch {}", event.epoch), event.text)});
  }
  if (shown < events.size()) rows.add({"event", fmt::format("{} more: --events", events.size() - shown)});
}

// Steps and flags: from the counts of the recorder where it has closed the file.
struct StepCounts {
  session::TickSpan ticks;
  node::FlagCounter flags;
};

// The flags are in the samples: where these were left out, the recorder's counts are all that is known.
StepCounts step_counts(const recording::Reader& reader, bool is_verifying) {
  const bool has_samples = reader.identity().steps == recording::RecordedSteps::all;
  if (!is_verifying || !has_samples) {
    if (auto closing = session::closing_counts(reader)) return {closing->ticks, std::move(closing->flags)};
  }
  return {session::tick_span(reader), analysis::recorded_flags(reader)};
}

// Times of a recording, which may begin later than its session.
struct Length {
  double from = 0, to = 0;  // s
  [[nodiscard]] double duration() const noexcept { return to - from; }
};

Length length_of(const recording::Reader& reader) {
  return {static_cast<double>(session::begin_time_ns(reader)) / 1e9,
          static_cast<double>(reader.statistics().end_time) / 1e9};
}

Json to_json(const recording::Reader& reader, const StepCounts& counts, const Length& length) {
  const recording::SessionIdentity& identity = reader.identity();
  Json topics = Json::object();
  for (const auto& [topic, count] : counts_of(reader)) {
    topics[topic] = {{"recorded", count.recorded}, {"lost", count.lost}};
  }
  return {{"path", reader.path().string()},
          {"bytes", reader.file_bytes()},
          {"scene", identity.scene},
          {"session", identity.session_name},
          {"session_id", identity.session_id},
          {"build", identity.build},
          {"started_ns", identity.started_ns},
          {"step_ns", identity.communication_step.ns},
          {"duration", length.duration()},
          {"from", length.from},
          {"to", length.to},
          {"complete", reader.has_all_messages()},
          {"left_out", session::left_out_text(reader)},
          {"damage", reader.damage_text()},
          {"end", end_of(reader)},
          {"ticks_behind_end", counts.ticks.behind_end},
          {"gaps", gaps_of(reader)},
          {"notes", analysis::explain_flags(counts.flags, reader)},
          {"events", events_json(reader)},
          {"topics", topics}};
}

void print(const recording::Reader& reader, const StepCounts& counts, const Length& length, bool has_all_events) {
  const recording::SessionIdentity& identity = reader.identity();
  const session::TickSpan& span = counts.ticks;
  ReportTable rows({"", ""});
  rows.add(
      {"file", fmt::format("{} ({:.2f} MB)", reader.path().string(), static_cast<double>(reader.file_bytes()) * 1e-6)});
  rows.add({"scene", identity.scene});
  rows.add({"session", identity.session_name + ", " + identity.session_id});
  rows.add({"started", node::time_text(identity.started_ns)});
  rows.add({"build", identity.build});
  rows.add({"step", duration_text(identity.communication_step.seconds())});
  rows.add(
      {"length",
       fmt::format("{}{}, {} in {} of wall time", duration_text(length.duration()),
                   length.from > 0 ? fmt::format(" from {:.6g} s to {:.6g} s", length.from, length.to) : std::string(),
                   counted(static_cast<std::uint64_t>(span.steps), "step", "steps"), duration_text(span.wall_time))});
  rows.add({"end", end_of(reader)});
  if (std::string left_out = session::left_out_text(reader); !left_out.empty()) {
    rows.add({"steps", std::move(left_out)});
  }
  if (span.behind_end > 0) rows.add({"end", session::behind_end_text(span)});
  for (const auto& [topic, count] : counts_of(reader)) {
    rows.add(
        {"topic", fmt::format("{}: {}, {} lost", topic, counted(count.recorded, "message", "messages"), count.lost)});
  }
  for (std::string& gap : gaps_of(reader)) rows.add({"gap", std::move(gap)});
  for (std::string& flagged : analysis::explain_flags(counts.flags, reader)) rows.add({"note", std::move(flagged)});
  add_events(reader, has_all_events, rows);
  for (const recording::AttachmentIndexRecord& attachment : reader.attachments()) {
    rows.add({"attached", fmt::format("{} ({})", attachment.name, counted(attachment.size, "byte", "bytes"))});
  }
  print_table(rows);
}

ExitCode show(const InfoOptions& options) {
  const auto reader = session::open_recording(options.recording);
  if (options.is_verifying) require(reader->verify());
  const StepCounts counts = step_counts(*reader, options.is_verifying);
  const Length length = length_of(*reader);
  if (options.is_json) {
    fmt::print("{}\n", to_json(*reader, counts, length).dump(2));
  } else {
    print(*reader, counts, length, options.has_all_events);
    if (options.is_verifying) fmt::print("every byte was read and every checksum fits\n");
  }
  return ExitCode::ok;
}

}  // namespace

void add_info(options::Command& program) {
  options::Command verb = program.command("info", "what a recording holds");
  const auto options = std::make_shared<InfoOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.flag("--verify", options->is_verifying, "read every byte and compare every checksum; count every message again");
  verb.flag("--events", options->has_all_events,
            "all requests, overruns, changes of shedding and of controllers, not the first ten alone");
  verb.flag("--json", options->is_json, "for machines");
  verb.footer("Example:\n  slewring info runs/truck_crane-20260501-102030");
  verb.action([options] { return show(*options); });
}

}  // namespace slew::cli
