// `slewring plot REC VAR...` and `slewring export REC`: a recording's variables as a picture or a table.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iostream>

#include "cli/plotting/csv_export.h"
#include "cli/plotting/svg_plot.h"
#include "cli/recorded.h"
#include "cli/run_report.h"
#include "cli/verbs.h"
#include "cli_support/failure.h"
#include "node/identity.h"

namespace slew::cli {
namespace {

using cli_support::Failure;

struct Options {
  std::string recording;
  std::vector<std::string> variables;
  std::string output;
  std::string title;
  bool is_csv = false;
};

void write_text(const std::string& path, const std::string& text) {
  if (path == "-") {
    std::cout << text << std::flush;
    return;
  }
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) {
    throw Failure(ExitCode::storage, "cannot write " + path + "; nothing was kept; name another file with -o");
  }
}

ExitCode plot(const Options& options) {
  const auto reader = open_recording(options.recording);
  if (options.variables.empty()) {
    const scene::Scene scene = scene::load_text(attachment_text(*reader, "scene.yaml"), reader->identity().scene);
    const std::string path = write_plots(scene, reader->path().string());
    if (path.empty()) {
      throw Failure(ExitCode::bad_input,
                    "the scene of this recording has no plots; nothing was written; name the "
                    "variables to plot");
    }
    fmt::print("{}\n", path);
    return ExitCode::ok;
  }
  const std::vector<plotting::Series> curves = read_series(*reader, options.variables, Units::display);
  plotting::PlotOptions look;
  look.title = options.title.empty() ? reader->identity().scene : options.title;
  look.subtitle = "session " + reader->identity().session_name + ", " + node::time_text(reader->identity().started_ns);
  const std::string path = options.output.empty() ? "plot.svg" : options.output;
  write_text(path, plotting::plot_svg(curves, look));
  if (path != "-") fmt::print("{}\n", path);
  return ExitCode::ok;
}

ExitCode export_table(const Options& options) {
  const auto reader = open_recording(options.recording);
  const std::vector<std::string> all = {"*"};
  const std::vector<plotting::Series> curves =
      read_series(*reader, options.variables.empty() ? all : options.variables, Units::si);
  if (options.output.empty() || options.output == "-") {
    plotting::write_csv(curves, std::cout);
    std::cout << std::flush;
    return ExitCode::ok;
  }
  cli_support::require(plotting::export_csv(curves, options.output));
  fmt::print("{}\n", options.output);
  return ExitCode::ok;
}

}  // namespace

void add_plot(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("plot", "draw variables of a recording as SVG");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  verb->add_option("recording", options->recording, "recording, or the folder of a run")->required()->type_name("REC");
  verb->add_option("variables", options->variables, "names, or patterns with * and ?; without them the scene's plots")
      ->type_name("VAR");
  verb->add_option("-o,--output", options->output, "file to write, - for standard output; without it plot.svg")
      ->type_name("FILE");
  verb->add_option("--title", options->title, "heading; without it the scene's name")->type_name("TEXT");
  verb->footer("Example:\n  slewring plot runs/truck_crane-20260501-102030 'Cyl_*.force' Bag.position.y -o lift.svg");
  verb->callback([&action, options] { action = [options] { return plot(*options); }; });
}

void add_export(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("export", "write variables of a recording as a table");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  verb->add_option("recording", options->recording, "recording, or the folder of a run")->required()->type_name("REC");
  verb->add_option("variables", options->variables, "names, or patterns with * and ?; without them all")
      ->type_name("VAR");
  verb->add_flag("--csv", options->is_csv, "comma-separated values in SI units (the only format of this version)");
  verb->add_option("-o,--output", options->output, "file to write; without it standard output")->type_name("FILE");
  verb->footer("Example:\n  slewring export runs/truck_crane-20260501-102030 --csv -o crane.csv");
  verb->callback([&action, options] { action = [options] { return export_table(*options); }; });
}

}  // namespace slew::cli
