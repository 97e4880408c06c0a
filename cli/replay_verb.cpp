// SPDX-License-Identifier: Apache-2.0
// `slewring replay REC [--verify]`.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "cli/run_session.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "node/driver.h"
#include "node/identity.h"
#include "program/add_session_options.h"
#include "session/recorded.h"
#include "session/replay.h"

namespace slew::cli {
namespace {

constexpr std::uint32_t kLastEpoch = UINT32_MAX;

struct ReplayOptions {
  std::string recording;
  std::string assets;
  bool is_verifying = false;
  bool is_json = false;
  std::string until;
  std::uint32_t epoch = kLastEpoch;
  std::string saved;  // file for the state there
  bool may_replace = false;
  bool goes_on = false;
  session::RunOptions run;
};

Json to_json(const session::ReplayResult& result) {
  Json gaps = Json::array();
  for (const std::string& gap : result.gaps) gaps.push_back(gap);
  return {{"steps", result.steps},
          {"epochs", result.epochs},
          {"compared", result.compared},
          {"different", result.different},
          {"unrecorded", result.unrecorded},
          {"compute_time", result.compute_time},
          {"unreached_steps", result.unreached_steps},
          {"unreached_hashes", result.unreached_hashes},
          {"equal", result.is_equal() && result.is_whole()},
          {"gaps", gaps},
          {"problem", result.problem}};
}

// ---- until a time, and on from there --------------------------------------------------------------------------

class ScratchFile {
 public:
  ScratchFile()
      : path_((std::filesystem::temp_directory_path() / fmt::format("slewring-{}.saved", getpid())).string()) {}
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

// The next step at which all nodes have exchanged.
StepIndex step_until(const recording::Reader& reader, const std::string& assets, const std::string& until) {
  const scene::Scene scene = session::recorded_scene(reader, assets);
  const auto step_ns = static_cast<std::uint64_t>(scene.session.step_duration().ns);
  const auto step = static_cast<StepIndex>((session::recorded_time_ns("--until", until) + step_ns - 1) / step_ns);
  const StepIndex unit = scene.exchange_unit();
  return (step + unit - 1) / unit * unit;
}

void print_gaps(const session::ReplayResult& result) {
  std::fflush(stdout);
  for (const std::string& gap : result.gaps) std::fprintf(stderr, "slewring: %s\n", printable_lines(gap).c_str());
}

ExitCode run_until(const ReplayOptions& options) {
  node::install_signal_handlers();
  const auto reader = session::open_recording(options.recording);
  const std::string assets = options.assets.empty() ? session::recorded_assets(options.recording) : options.assets;
  session::ReplayEnd end;
  end.step = step_until(*reader, assets, options.until);
  if (options.epoch != kLastEpoch) end.epoch = options.epoch;
  const session::ReplayResult result = session::replay(*reader, session::OnDifference::stop, assets, &end);
  if (const int stop = node::stop_requested.load(); stop != 0) return static_cast<ExitCode>(stop);
  if (!result.is_equal()) {
    throw Failure(ExitCode::failed, result.problem + "; nothing was saved or started" +
                                        (result.different > 0 ? "; replay it with its own build" : ""));
  }
  print_gaps(result);
  end.saved.build = node::build_id();
  if (!options.is_json) {
    fmt::print("{} computed again until t = {:.6g} s, {} compared, none different\n",
               counted(static_cast<std::uint64_t>(result.steps), "step", "steps"), end.saved.time(),
               counted(result.compared, "hash", "hashes"));
    std::fflush(stdout);
  }
  if (!options.saved.empty()) {
    require(io_node::write_saved(options.saved, end.saved,
                                 options.may_replace ? io_node::Replace::existing : io_node::Replace::never));
    if (!options.is_json) fmt::print("saved: {}\n", options.saved);
  }
  if (!options.goes_on) return ExitCode::ok;
  const ScratchFile scratch;
  session::RunOptions run = options.run;
  run.scene.from = options.saved.empty() ? scratch.path() : options.saved;
  run.scene.assets = assets;
  run.is_json = options.is_json;
  if (options.saved.empty()) require(io_node::write_saved(run.scene.from, end.saved, io_node::Replace::existing));
  const io_node::SessionScene session = io_node::load_session_scene(run.scene);
  return run_session(std::move(run), session);
}

ExitCode run(const ReplayOptions& options) {
  if (options.until.empty() && (options.goes_on || !options.saved.empty())) {
    throw Failure(ExitCode::bad_input, "--then-live and --save need a time; nothing was done; set it with --until");
  }
  if (options.until.empty() && options.epoch != kLastEpoch) {
    throw Failure(ExitCode::bad_input, "--epoch belongs to a time; nothing was done; set it with --until");
  }
  if (!options.until.empty() && !options.goes_on && options.saved.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--until alone leaves nothing; nothing was done; go on with --then-live, or keep the state with "
                  "--save FILE");
  }
  if (!options.until.empty()) return run_until(options);
  node::install_signal_handlers();
  const auto reader = session::open_recording(options.recording);
  const session::ReplayResult result =
      session::replay(*reader, options.is_verifying ? session::OnDifference::stop : session::OnDifference::count,
                      options.assets.empty() ? session::recorded_assets(options.recording) : options.assets);
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
    if (result.unreached_steps > 0 || result.unreached_hashes > 0) {
      fmt::print("in the recording and not reached: {}, {}, from {} on; nothing is known of them\n",
                 counted(result.unreached_steps, "step", "steps"), counted(result.unreached_hashes, "hash", "hashes"),
                 result.end);
    }
  }
  print_gaps(result);
  // a gap is no build's fault
  const bool may_be_build = result.different > 0 && reader->identity().build != node::build_id();
  if (!result.is_equal()) {
    std::fflush(stdout);
    std::fprintf(stderr, "slewring: %s%s\n", printable_lines(result.problem).c_str(),
                 may_be_build ? ("; the recording was made by build " + reader->identity().build + ", this is " +
                                 node::build_id() + ": replay it with its own build")
                                    .c_str()
                              : "");
  }
  if (!options.is_verifying) return ExitCode::ok;
  if (!result.is_equal() || !result.gaps.empty()) return ExitCode::failed;
  if (result.unrecorded > 0 || !result.is_whole()) return ExitCode::losses;
  if (!options.is_json) fmt::print("equal bit for bit\n");
  return ExitCode::ok;
}

}  // namespace

void add_replay(options::Command& program) {
  options::Command verb = program.command("replay", "compute a recorded session again from its ticks");
  const auto options = std::make_shared<ReplayOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.flag(
      "--verify", options->is_verifying,
      "stop at the first step whose state differs, with exit code 1; 1 too when ticks are missing, behind which it "
      "goes on where the recording has the states of a later step; 3 when recorded steps were not reached");
  verb.option("--assets", options->assets,
              "folder with the scene's files; without it the copies that lie beside the recording")
      .value_name("FOLDER");
  verb.flag("--json", options->is_json, "for machines");
  verb.option("--until", options->until,
              "compute up to this time of the session, such as '2.5 s', comparing; after a "
              "reset or a load this is not the time of the recording")
      .value_name("TIME")
      .group("Going on");
  verb.option("--epoch", options->epoch,
              "with --until: epoch of that time; 0 is the one before the first reset or load; without it the last one")
      .value_name("N")
      .group("Going on");
  verb.flag("--then-live", options->goes_on, "run a session from there, as 'slewring run --from' does")
      .group("Going on");
  verb.option("--save", options->saved, "keep the state there in a file for 'slewring run --from'")
      .value_name("FILE")
      .group("Going on");
  verb.flag("--force", options->may_replace, "replace that file if it exists").group("Going on");
  verb.option("--input", options->run.scene.input,
              "with --then-live: script (the recorded scene's own, which goes on), none, keyboard, or a file")
      .value_name("SOURCE")
      .show_default()
      .group("Going on");
  verb.option("--duration", options->run.scene.duration, "with --then-live: end of the session's time; 0: none")
      .value_name("TIME")
      .group("Going on");
  verb.option("--pace", options->run.scene.pace, "with --then-live: real or free")
      .one_of({"real", "free"})
      .value_name("PACE")
      .group("Going on");
  verb.option("--set", options->run.scene.overrides,
              "with --then-live: change a live parameter at that time, or the controller of an input from there on, "
              "such as "
              "Input_Lift.controller=sampled")
      .value_name("PATH=VALUE")
      .one_value_each()
      .group("Going on");
  verb.flag("--record,!--no-record", options->run.scene.is_recording, "with --then-live: record it (default)")
      .group("Going on");
  verb.flag("--in-process", options->run.is_in_process, "with --then-live: all nodes in this process")
      .group("Going on");
  program::add_session_options(verb, options->run.session, false);
  add_running_options(verb, options->run);
  verb.footer(
      "Without --verify differences are counted and reported, and the exit code is 0.\n\n"
      "Examples:\n"
      "  slewring replay runs/truck_crane-20260501-102030 --verify\n"
      "  slewring replay runs/truck_crane-20260501-102030 --until 8s --then-live --input keyboard");
  verb.action([options] { return run(*options); });
}

}  // namespace slew::cli
