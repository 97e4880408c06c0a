// SPDX-License-Identifier: Apache-2.0
// `slewring export REC`: a recording's variables as a table, or as structs for MATLAB.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>

#include "bridge/log_export.h"
#include "cli/lcm_scene.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/text_output.h"
#include "plotting/csv_export.h"
#include "plotting/mat_export.h"
#include "session/recorded.h"
#include "session/recorded_place.h"

namespace slew::cli {
namespace {

struct ExportOptions {
  std::string recording;
  std::vector<std::string> variables;
  std::vector<std::string> only;
  std::string from, to;
  std::string output;
  std::string lcm;
  bridge::Settings for_lcm;
  bool is_csv = false;
  bool is_mat = false;
  bool is_input = false;
  bool may_replace = false;
};

void check_values(const recording::Reader& reader, const std::vector<plotting::Series>& curves) {
  for (const plotting::Series& curve : curves) {
    if (!curve.time.empty()) return;
  }
  throw Failure(ExitCode::bad_input,
                fmt::format("the recording has no value of these variables in this time; it goes from {:.6g} s to "
                            "{:.6g} s; nothing was written",
                            static_cast<double>(session::begin_time_ns(reader)) * 1e-9,
                            static_cast<double>(reader.statistics().end_time) * 1e-9));
}

// Replaces a file only on request, and never leaves a part of one.
ExitCode write_file(const ExportOptions& options, const std::function<Status(const std::filesystem::path&)>& write) {
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::status(options.output, error);
  const bool is_device = std::filesystem::exists(there) && !std::filesystem::is_regular_file(there);
  require(replace_file(options.output, write));
  if (!is_device) fmt::print("{}\n", options.output);
  return ExitCode::ok;
}

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

// The format by the file's ending where no option states it; a name without an ending is of a table.
void choose_format(ExportOptions& options) {
  const std::string ending = ending_of(options.output);
  if (options.output.starts_with("/dev/")) return;
  const bool is_stated = options.is_csv || options.is_mat || options.is_input;
  if (is_stated && options.is_mat != (ending == ".mat") && (ending == ".mat" || ending == ".csv")) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("--{} does not write what '{}' ends in; nothing was written; leave the option out, or "
                              "give the file another ending",
                              options.is_mat   ? "mat"
                              : options.is_csv ? "csv"
                                               : "input",
                              options.output));
  }
  if (is_stated) return;
  options.is_mat = ending == ".mat";
  if (options.is_mat || ending.empty() || ending == ".csv" || ending == ".txt") return;
  throw Failure(ExitCode::bad_input,
                fmt::format("'{}' ends neither in .csv nor in .mat, the formats of tables; nothing was written; state "
                            "--csv or --mat for a file of this name",
                            options.output));
}

void check_output(const ExportOptions& options) {
  const bool is_standard_output = options.output.empty() || options.output == "-";
  if (is_standard_output) {
    if (!options.is_mat) return;
    throw Failure(ExitCode::bad_input, "a MAT-file needs a name; nothing was written; give one with -o FILE.mat");
  }
  std::error_code ignored;
  if (options.may_replace || !std::filesystem::is_regular_file(options.output, ignored)) return;
  throw Failure(ExitCode::bad_input, options.output +
                                         ": the file exists already; it was left as it is; choose another name, or "
                                         "replace it with --force");
}

// A session that was reset or loaded has another time than its recording; played back it begins with its own.
void to_session_time(const recording::Reader& reader, const session::EpochTimes& of,
                     std::vector<plotting::Series>& curves) {
  const std::int64_t begin_ns = of.first_step * reader.identity().communication_step.ns;
  const std::int64_t later_ns = static_cast<std::int64_t>(of.from_ns) - begin_ns;
  if (later_ns == 0) return;
  fmt::print(stderr,
             "the time of the recording from {} s to {} s is epoch {} of the session, behind a reset or a load; the "
             "table has the session's own time, from {} s on\n",
             static_cast<double>(of.from_ns) / 1e9, static_cast<double>(of.to_ns) / 1e9, of.epoch,
             static_cast<double>(begin_ns) / 1e9);
  for (plotting::Series& curve : curves) {
    for (double& at : curve.time) at = static_cast<double>(std::llround(at * 1e9) - later_ns) / 1e9;
  }
}

// The operator's inputs in the format of `run --input` and scripts: raw values by input.
std::string input_text(const recording::Reader& reader, const session::TimeRange& range) {
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(reader), reader.identity().scene);
  if (scene.inputs.empty()) {
    throw Failure(ExitCode::bad_input, "the scene of this recording has no inputs; nothing was written");
  }
  std::vector<std::string> names;
  for (const scene::InputDef& input : scene.inputs) names.push_back(input.name + ".raw");
  std::vector<plotting::Series> curves = session::read_series(reader, names, session::Units::si, range);
  plotting::keep_common_instants(curves);
  check_values(reader, curves);
  to_session_time(reader, session::only_epoch(reader, range), curves);
  const std::vector<double>& time = curves.front().time;
  if (time.front() > 0) {
    fmt::print(stderr, "the table begins at {} s; played back, the inputs are neutral before\n", time.front());
  }
  std::string text = "time";
  for (const scene::InputDef& input : scene.inputs) text += "," + input.name;
  const auto add_row = [&](double at, std::size_t i) {
    text += fmt::format("\n{}", at);
    for (const plotting::Series& curve : curves) text += fmt::format(",{}", curve.values[i]);
  };
  const std::int64_t step_ns = reader.identity().communication_step.ns;
  for (std::size_t i = 0; i < time.size(); ++i) {
    add_row(time[i], i);
    // a tick holds its values over its step; from there a line leads to the next one that was recorded
    const auto changes = [i](const plotting::Series& curve) { return curve.values[i] != curve.values[i + 1]; };
    if (i + 1 == time.size() || std::none_of(curves.begin(), curves.end(), changes)) continue;
    const std::int64_t end_ns = std::llround(time[i] * 1e9) + step_ns, next_ns = std::llround(time[i + 1] * 1e9);
    add_row(end_ns < next_ns ? static_cast<double>(end_ns) / 1e9 : time[i + 1], i);
  }
  return text + "\n";
}

ExitCode export_input(const ExportOptions& options, const std::vector<std::string>& patterns) {
  if (!patterns.empty()) {
    throw Failure(ExitCode::bad_input, "--input writes every input; nothing was written; leave the variables out");
  }
  const auto reader = session::open_recording(options.recording);
  const std::string text = input_text(*reader, session::recorded_range(options.from, options.to));
  if (options.output.empty() || options.output == "-") {
    write_text("-", text);
    return ExitCode::ok;
  }
  return write_file(options, [&](const std::filesystem::path& path) { return put_text(path, text); });
}

// The session as its observers saw it.
void write_log(const ExportOptions& options, const recording::Reader& reader, const scene::Scene& scene,
               std::ofstream& file) {
  bridge::LogExport log(
      options.for_lcm, reader.identity().session_name, lcm_scene(scene),
      [&file](std::string_view bytes) { file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
  const session::TimeRange range = session::recorded_range(options.from, options.to);
  log.choose(range.from_ns, range.to_ns);
  observer::SessionView view;
  session::watch_recording(reader, view, log.receiver(view));
  if (log.events() == 0)
    throw Failure(ExitCode::bad_input, "the recording has no variables in this time; nothing was written");
  if (log.incomplete() > 0) {
    fmt::print(stderr,
               "warning: {} messages of the signal lists are left out: the recording lacks values of their steps\n",
               log.incomplete());
  }
  for (const std::string& input : log.missing_inputs()) {
    fmt::print(stderr, "warning: {}.raw is not recorded (recording.variables): the log has no inputs for {}\n", input,
               input);
  }
}

ExitCode export_lcm(ExportOptions options) {
  bridge::require_lcm();
  if (!options.variables.empty() || !options.only.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--lcm writes every variable; nothing was written; leave the names out, or choose some with "
                  "--signals NAME=var,var");
  }
  if (!options.output.empty()) {
    throw Failure(ExitCode::bad_input, "--lcm FILE and -o exclude each other; nothing was written; leave -o out");
  }
  if (options.lcm == "-") throw Failure(ExitCode::bad_input, "an event log needs a name; nothing was written");
  options.output = options.lcm;
  check_output(options);
  require_writable(options.output);
  const auto reader = session::open_recording(options.recording);
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(*reader), reader->identity().scene);
  const session::EpochTimes epoch = session::only_epoch(*reader, session::recorded_range(options.from, options.to));
  if (epoch.epoch > 0) {
    fmt::print(stderr, "the log is of epoch {} of the session, behind a reset or a load, at the session's own time\n",
               epoch.epoch);
  }
  return write_file(options, [&](const std::filesystem::path& path) {
    std::ofstream file(path, std::ios::binary);
    write_log(options, *reader, scene, file);
    file.close();
    return file.good() ? Status::ok()
                       : Status::error(ExitCode::storage, options.output + ": cannot be written; is the disk full?");
  });
}

ExitCode export_variables(ExportOptions options) {
  if (!options.lcm.empty()) return export_lcm(std::move(options));
  choose_format(options);
  check_output(options);
  std::vector<std::string> patterns = options.variables;
  patterns.insert(patterns.end(), options.only.begin(), options.only.end());
  if (options.is_input) return export_input(options, patterns);
  if (patterns.empty()) patterns = {"*"};
  const session::TimeRange range = session::recorded_range(options.from, options.to);
  const auto reader = session::open_recording(options.recording);
  const std::vector<plotting::Series> curves = session::read_series(*reader, patterns, session::Units::si, range);
  check_values(*reader, curves);
  if (const std::size_t epochs = session::epoch_times(*reader, range).size(); epochs > 1) {
    fmt::print(stderr,
               "the session was reset or loaded within this time: the table has {} epochs one behind the other, in the "
               "time of the recording, and is no input for 'run --input'\n",
               epochs);
  }
  if (options.output.empty() || options.output == "-") {
    plotting::write_csv(curves, std::cout);
    std::cout << std::flush;
    return ExitCode::ok;
  }
  return write_file(options, [&](const std::filesystem::path& path) {
    if (!options.is_mat) return plotting::export_csv(curves, path);
    const recording::SessionIdentity& identity = reader->identity();
    return plotting::export_mat(curves,
                                {identity.scene, identity.session_name, identity.session_id, identity.build,
                                 identity.communication_step.seconds()},
                                path);
  });
}

}  // namespace

void add_export(options::Command& program) {
  options::Command verb = program.command("export", "write variables of a recording as a table or for MATLAB");
  const auto options = std::make_shared<ExportOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.option("variables", options->variables, "names, or patterns with * and ?; without them all").value_name("VAR");
  verb.option("--only", options->only, "the same, one at a time; repeat for more").value_name("VAR").repeatable();
  options::Option csv =
      verb.flag("--csv", options->is_csv, "comma-separated values in SI units; the default but for a FILE.mat");
  options::Option mat = verb.flag("--mat", options->is_mat,
                                  "MAT-file for MATLAB, Octave and scipy.io: a struct with name, unit, time and "
                                  "value for each variable, SI units");
  options::Option input =
      verb.flag("--input", options->is_input,
                "the operator's inputs, in the format of 'run --input FILE'; as often as variables were recorded, "
                "each value held for a step, straight lines between");
  options::Option lcm =
      verb.option("--lcm", options->lcm,
                  "an LCM event log: the messages of 'slewring bridge lcm' at the session's times, and "
                  "the inputs for 'run --input FILE.lcm'")
          .value_name("FILE");
  csv.excludes(mat);
  input.excludes(mat);
  for (const options::Option& other : {csv, mat, input}) lcm.excludes(other);
  for (options::Option& option : add_lcm_options(verb, options->for_lcm)) option.needs(lcm);
  verb.option("--from", options->from, "leave out what lies before, such as '2.5 s'").value_name("TIME");
  verb.option("--to", options->to, "leave out what lies behind").value_name("TIME");
  verb.option("-o,--output", options->output, "file to write, by its ending .csv or .mat; without it standard output")
      .value_name("FILE");
  verb.flag("--force", options->may_replace, "replace a file that exists");
  verb.footer(
      "Examples:\n"
      "  slewring export runs/truck_crane-20260501-102030 --csv -o crane.csv\n"
      "  slewring export runs/truck_crane-20260501-102030 --mat --only 'Cyl_*' --from 2s --to 5s -o lift.mat\n"
      "  slewring export runs/truck_crane-20260501-102030 --input -o levers.csv\n"
      "  slewring export runs/truck_crane-20260501-102030 --lcm crane.lcm");
  verb.action([options] { return export_variables(*options); });
}

}  // namespace slew::cli
