// SPDX-License-Identifier: Apache-2.0
// `slewring recover REC`: makes a whole recording from the sound parts of a damaged one.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"
#include "recording/recovery.h"
#include "recording/run_directory.h"
#include "session/recorded.h"
#include "session/recorded_extent.h"

namespace slew::cli {
namespace {

struct RecoverOptions {
  std::string recording;
  std::string output;
  bool is_json = false;
};

std::filesystem::path target_of(const RecoverOptions& options, const std::filesystem::path& damaged) {
  if (!options.output.empty()) return options.output;
  std::filesystem::path target = damaged;
  return target.replace_filename(damaged.stem().string() + ".recovered" + damaged.extension().string());
}

std::string lost_text(const recording::LostBytes& lost) {
  return fmt::format("{} from byte {} on: {}", counted(lost.size, "byte", "bytes"), lost.offset, lost.text);
}

Json to_json(const recording::Recovery& recovery, const std::filesystem::path& target,
             const session::RecordedExtent& extent) {
  Json lost = Json::array();
  for (const recording::LostBytes& bytes : recovery.lost) {
    lost.push_back({{"byte", bytes.offset}, {"size", bytes.size}, {"problem", bytes.text}});
  }
  return {{"recovered", target.string()},
          {"was_whole", recovery.was_whole},
          {"was_cut", recovery.was_cut},
          {"chunks", recovery.chunks},
          {"messages", recovery.messages},
          {"epoch", extent.epoch},
          {"first_step", extent.first_step ? Json(*extent.first_step) : Json()},
          {"last_step", extent.last_step},
          {"complete_to", extent.complete_to},
          {"lost_steps", extent.lost},
          {"lost", lost}};
}

std::string steps_text(const session::RecordedExtent& extent) {
  if (extent.last_step < 0 && !extent.first_step) return "none: the recording has no tick";
  const StepIndex first = extent.first_step.value_or(0);
  const std::string of_epoch = extent.epoch > 0 ? fmt::format(" of epoch {}", extent.epoch) : "";
  if (extent.complete_to < first) {
    return fmt::format("none complete{}: step {} is not whole; last step {}", of_epoch, first, extent.last_step);
  }
  return fmt::format("complete{} up to step {}{}, last step {}", first > 0 ? fmt::format(" from step {}", first) : "",
                     extent.complete_to, of_epoch, extent.last_step);
}

void print(const recording::Recovery& recovery, const std::filesystem::path& target,
           const session::RecordedExtent& extent) {
  ReportTable rows({"", ""});
  rows.add({"recovered", target.string()});
  rows.add({"saved",
            fmt::format("{} in {}, until {:.6g} s", counted(recovery.messages, "message", "messages"),
                        counted(recovery.chunks, "chunk", "chunks"), static_cast<double>(recovery.end_time) * 1e-9)});
  rows.add({"steps", steps_text(extent)});
  for (const recording::LostBytes& lost : recovery.lost) rows.add({"lost", lost_text(lost)});
  if (extent.lost > 0) {
    rows.add({"lost", fmt::format("{} in front of the last step",
                                  counted(extent.lost, "tick or sample", "ticks and samples"))});
  }
  if (!extent.first_step && extent.last_step >= 0) {
    rows.add({"lost", "the number of its first step; missing steps are counted from step 0 on"});
  }
  if (recovery.was_cut) rows.add({"lost", "any data after the last step: the end is missing"});
  if (recovery.lost_channels > 0) {
    rows.add({"lost", fmt::format("the names of {}: its messages are there under '{}<number>'",
                                  counted(recovery.lost_channels, "topic", "topics"), recording::kLostChannelTopic)});
  }
  if (recovery.lost.empty() && !recovery.was_cut) rows.add({"lost", "nothing: only index and checks were damaged"});
  print_table(rows);
}

ExitCode run(const RecoverOptions& options) {
  std::filesystem::path damaged = options.recording;
  std::error_code error;
  if (std::filesystem::is_directory(damaged, error)) damaged /= recording::kRecordingFileName;
  const std::filesystem::path target = target_of(options, damaged);
  recording::Recovery recovery;
  require(recording::recover(damaged, target, recovery));
  if (recovery.was_whole) {
    if (options.is_json) {
      fmt::print("{}\n", to_json(recovery, "", {}).dump(2));
    } else {
      fmt::print("{}: every byte is as it was written; there is nothing to recover and nothing was written\n",
                 damaged.string());
    }
    return ExitCode::ok;
  }
  const session::RecordedExtent extent = session::recorded_extent(*session::open_recording(target.string()));
  if (options.is_json) {
    fmt::print("{}\n", to_json(recovery, target, extent).dump(2));
  } else {
    print(recovery, target, extent);
  }
  return recovery.lost.empty() ? ExitCode::ok : ExitCode::losses;
}

}  // namespace

void add_recover(options::Command& program) {
  options::Command verb = program.command("recover", "make a whole recording from the sound parts of a damaged one");
  const auto options = std::make_shared<RecoverOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.option("-o,--output", options->output,
              "file to write, a new one; without it <name>.recovered.mcap beside the recording")
      .value_name("FILE");
  verb.flag("--json", options->is_json, "for machines");
  verb.footer(
      "The damaged file is only read. Index and summary are built from the messages. Exit code 3 when bytes are "
      "lost.\n\n"
      "Example:\n  slewring recover runs/truck_crane-20260501-102030");
  verb.action([options] { return run(*options); });
}

}  // namespace slew::cli
