// `slewring replay REC [--verify]`.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/display.h"
#include "cli/recorded.h"
#include "cli/replay.h"
#include "cli/verbs.h"
#include "cli_support/failure.h"
#include "node/driver.h"
#include "node/identity.h"

namespace slew::cli {
namespace {

struct Options {
  std::string recording;
  std::string assets;
  bool is_verifying = false;
  bool is_json = false;
};

nlohmann::json to_json(const ReplayResult& result) {
  return {{"steps", result.steps},         {"epochs", result.epochs},         {"compared", result.compared},
          {"different", result.different}, {"unrecorded", result.unrecorded}, {"compute_time", result.compute_time},
          {"equal", result.is_equal()},    {"problem", result.problem}};
}

ExitCode run(const Options& options) {
  node::install_signal_handlers();
  const auto reader = open_recording(options.recording);
  const ReplayResult result = replay(*reader, options.is_verifying ? OnDifference::stop : OnDifference::count,
                                     options.assets.empty() ? recorded_assets(options.recording) : options.assets);
  if (const int stop = node::stop_requested.load(); stop != 0) return static_cast<ExitCode>(stop);
  if (options.is_json) {
    fmt::print("{}\n", to_json(result).dump(2));
  } else {
    fmt::print("{} computed again in {} ({} a step), {} compared, {} different\n",
               counted(static_cast<std::uint64_t>(result.steps), "step", "steps"), duration_text(result.compute_time),
               duration_text(result.compute_time / static_cast<double>(std::max<StepIndex>(1, result.steps))),
               counted(result.compared, "hash", "hashes"), result.different);
    if (result.unrecorded > 0) {
      fmt::print("not in the recording and not compared: {}\n", counted(result.unrecorded, "sample", "samples"));
    }
  }
  const bool is_same_build = reader->identity().build == node::build_id();
  if (!result.is_equal()) {
    std::fflush(stdout);
    std::fprintf(stderr, "slewring: %s%s\n", result.problem.c_str(),
                 is_same_build ? ""
                               : ("; the recording was made by build " + reader->identity().build + ", this is " +
                                  node::build_id() + ": replay it with its own build")
                                     .c_str());
  }
  if (!options.is_verifying) return ExitCode::ok;
  if (!result.is_equal()) return ExitCode::failed;
  if (result.unrecorded > 0) return ExitCode::losses;
  if (!options.is_json) fmt::print("equal bit for bit\n");
  return ExitCode::ok;
}

}  // namespace

void add_replay(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("replay", "compute a recorded session again from its ticks");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  verb->add_option("recording", options->recording, "recording, or the folder of a run")->required()->type_name("REC");
  verb->add_flag("--verify", options->is_verifying,
                 "stop at the first step whose state differs, or at a gap, with exit code 1");
  verb->add_option("--assets", options->assets,
                   "folder with the scene's files; without it the copies that lie beside the recording")
      ->type_name("FOLDER");
  verb->add_flag("--json", options->is_json, "for machines");
  verb->footer(
      "Without --verify differences are counted and told, and the exit code is 0.\n\n"
      "Example:\n  slewring replay runs/truck_crane-20260501-102030 --verify");
  verb->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace slew::cli
