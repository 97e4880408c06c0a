// `slewring recover REC`: a whole recording of what is sound in a damaged one.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/display.h"
#include "cli/recorded.h"
#include "cli/verbs.h"
#include "cli_support/failure.h"
#include "node/identity.h"
#include "recorder_node/stream_gaps.h"
#include "recording/recovery.h"
#include "recording/run_directory.h"
#include "transport/codec.h"

namespace slew::cli {
namespace {

using wire::Role;
using wire::Topic;

struct Options {
  std::string recording;
  std::string output;
  bool is_json = false;
};

// How far the session of a recording goes without a gap: ticks and samples of every node.
struct Extent {
  std::uint32_t epoch = 0;       // the newest
  StepIndex complete_to = -1;    // in it; -1: not even step 0
  StepIndex last = -1;           // newest tick
  std::uint64_t lost_steps = 0;  // of ticks and samples in front of the newest that is there, all epochs
};

Extent extent_of(const recording::Reader& reader) {
  recording::MessageFilter filter;
  for (const Topic topic : {Topic::tick, Topic::mechanism, Topic::actuators}) {
    filter.topics.emplace_back(node::to_text(topic));
  }
  std::map<std::uint32_t, std::map<std::string, recorder::StreamGaps>> epochs;
  cli_support::require(reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    wire::Header header;
    if (!transport::decode_header(message.payload, header) || header.phase != wire::Phase::running) {
      return recording::Reader::Visit::go_on;
    }
    std::ignore = epochs[header.epoch][message.channel->topic].arrived(header.step);
    return recording::Reader::Visit::go_on;
  }));
  Extent extent;
  for (auto& [epoch, streams] : epochs) {
    extent.epoch = epoch;
    extent.last = extent.complete_to = -1;
    bool is_first = true;
    for (auto& [topic, stream] : streams) {
      const StepIndex complete = stream.next() - 1;
      extent.complete_to = is_first ? complete : std::min(extent.complete_to, complete);
      is_first = false;
      extent.last = std::max(extent.last, stream.newest());
      stream.close_at(stream.newest());
      extent.lost_steps += stream.lost();
    }
  }
  return extent;
}

std::filesystem::path target_of(const Options& options, const std::filesystem::path& damaged) {
  if (!options.output.empty()) return options.output;
  std::filesystem::path target = damaged;
  return target.replace_filename(damaged.stem().string() + ".recovered" + damaged.extension().string());
}

std::string lost_text(const recording::LostBytes& lost) {
  return fmt::format("{} from byte {} on: {}", counted(lost.size, "byte", "bytes"), lost.offset, lost.text);
}

nlohmann::json to_json(const recording::Recovery& recovery, const std::filesystem::path& target, const Extent& extent) {
  nlohmann::json lost = nlohmann::json::array();
  for (const recording::LostBytes& bytes : recovery.lost) {
    lost.push_back({{"byte", bytes.offset}, {"size", bytes.size}, {"problem", bytes.text}});
  }
  return {{"recovered", target.string()},    {"was_whole", recovery.was_whole},
          {"was_cut", recovery.was_cut},     {"chunks", recovery.chunks},
          {"messages", recovery.messages},   {"epoch", extent.epoch},
          {"last_step", extent.last},        {"complete_to", extent.complete_to},
          {"lost_steps", extent.lost_steps}, {"lost", lost}};
}

void print(const recording::Recovery& recovery, const std::filesystem::path& target, const Extent& extent) {
  std::vector<std::vector<std::string>> rows = {
      {"recovered", target.string()},
      {"saved",
       fmt::format("{} in {}, until {:.6g} s", counted(recovery.messages, "message", "messages"),
                   counted(recovery.chunks, "chunk", "chunks"), static_cast<double>(recovery.end_time) * 1e-9)},
      {"steps", fmt::format("complete up to step {}{}, last step {}", extent.complete_to,
                            extent.epoch > 0 ? fmt::format(" of epoch {}", extent.epoch) : "", extent.last)}};
  for (const recording::LostBytes& lost : recovery.lost) rows.push_back({"lost", lost_text(lost)});
  if (extent.lost_steps > 0) {
    rows.push_back({"lost", fmt::format("{} in front of the last step",
                                        counted(extent.lost_steps, "tick or sample", "ticks and samples"))});
  }
  if (recovery.was_cut)
    rows.push_back({"lost", "what was recorded behind the last step, if anything: the end is missing"});
  if (recovery.lost_channels > 0) {
    rows.push_back(
        {"lost", fmt::format("the names of {}: its messages are there under '{}<number>'",
                             counted(recovery.lost_channels, "topic", "topics"), recording::kLostChannelTopic)});
  }
  if (recovery.lost.empty() && !recovery.was_cut)
    rows.push_back({"lost", "nothing: only index and checks were damaged"});
  fmt::print("{}", table_text(rows, ""));
}

ExitCode run(const Options& options) {
  std::filesystem::path damaged = options.recording;
  std::error_code error;
  if (std::filesystem::is_directory(damaged, error)) damaged /= recording::kRecordingFileName;
  const std::filesystem::path target = target_of(options, damaged);
  recording::Recovery recovery;
  cli_support::require(recording::recover(damaged, target, recovery));
  if (recovery.was_whole) {
    if (options.is_json) {
      fmt::print("{}\n", to_json(recovery, "", {}).dump(2));
    } else {
      fmt::print("{}: every byte is as it was written; there is nothing to recover and nothing was written\n",
                 damaged.string());
    }
    return ExitCode::ok;
  }
  const Extent extent = extent_of(*open_recording(target.string()));
  if (options.is_json) {
    fmt::print("{}\n", to_json(recovery, target, extent).dump(2));
  } else {
    print(recovery, target, extent);
  }
  return recovery.lost.empty() ? ExitCode::ok : ExitCode::losses;
}

}  // namespace

void add_recover(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("recover", "make a whole recording of what is sound in a damaged one");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  verb->add_option("recording", options->recording, "recording, or the folder of a run")->required()->type_name("REC");
  verb->add_option("-o,--output", options->output,
                   "file to write, a new one; without it <name>.recovered.mcap beside the recording")
      ->type_name("FILE");
  verb->add_flag("--json", options->is_json, "for machines");
  verb->footer(
      "The damaged file is only read. Index and summary are built from the messages. Exit code 3 when bytes are "
      "lost.\n\n"
      "Example:\n  slewring recover runs/truck_crane-20260501-102030");
  verb->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace slew::cli
