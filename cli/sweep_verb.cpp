// SPDX-License-Identifier: Apache-2.0
// `slewring sweep SCENE`: measures of many runs with varied values, as table, files and a page.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "analysis/parameter_sweep/parameter_sweep.h"
#include "analysis/sweep/batch.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/text_output.h"
#include "program/add_scene_options.h"
#include "scene/scene.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

struct SweepOptions {
  analysis::ParameterSweepOptions settings;
  std::string sample = "grid", engine = "local";
  int samples = 0;
  bool is_json = false, is_quiet = false;
};

struct SweepRowOptions {
  std::string job, result;
  scene::Overrides settings;
};

void read_sampling(SweepOptions& options) {
  using analysis::Sampling;
  analysis::ParameterSweepOptions& settings = options.settings;
  for (const Sampling sampling : {Sampling::grid, Sampling::random, Sampling::lhs}) {
    if (to_text(sampling) == options.sample) settings.sampling = sampling;
  }
  const bool is_grid = settings.sampling == Sampling::grid;
  if (is_grid == (options.samples > 0)) {
    throw Failure(ExitCode::bad_input,
                  is_grid
                      ? "--samples is for --sample random and lhs; nothing was run; the rows of a grid come from "
                        "the counts of --vary"
                      : "--sample " + options.sample + " needs the number of rows; nothing was run; give --samples");
  }
  settings.samples = static_cast<std::size_t>(options.samples);
}

void read_engine(SweepOptions& options) {
  analysis::SweepOptions& engine = options.settings.engine;
  engine.engine = options.engine == "slurm" ? analysis::Engine::slurm
                  : options.engine == "mpi" ? analysis::Engine::mpi
                                            : analysis::Engine::local;
  if (engine.engine == analysis::Engine::local && engine.workers > analysis::kMostWorkers) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("--workers {}: one machine runs at most {}; nothing was run; give fewer, or use --engine "
                              "slurm or mpi",
                              engine.workers, analysis::kMostWorkers));
  }
}

void write_files(const analysis::ParameterSweep& sweep) {
  const std::filesystem::path folder = sweep.folder;
  write_text((folder / "rows.csv").string(), report_csv(sweep));
  write_text((folder / "rows.json").string(), report_json(sweep).dump(2) + '\n');
  write_text((folder / "index.html").string(), report_html(sweep));
}

ExitCode run_sweep_verb(SweepOptions options) {
  if (options.settings.job.scene.input == "keyboard") {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: every row needs the same input; nothing was run; write it into a .csv file");
  }
  read_sampling(options);
  read_engine(options);
  session::count_interrupts();
  for (const std::string& warning : scene::load_scene(options.settings.job.scene).warnings)
    std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
  analysis::ParameterSweep sweep;
  {
    ProgressLine line(options.is_quiet);
    sweep = analysis::run_parameter_sweep(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  write_files(sweep);
  fmt::print("{}", options.is_json ? report_json(sweep).dump(2) + '\n' : report_text(sweep, output_width()));
  if (!options.is_json) {
    for (const char* name : {"rows.csv", "rows.json", "index.html"}) {
      fmt::print("{}\n", (std::filesystem::path(sweep.folder) / name).string());
    }
  }
  std::fflush(stdout);
  if (session::interrupts() > 0) return static_cast<ExitCode>(session::interrupt_code());
  return sweep.failed() > 0 ? ExitCode::failed : ExitCode::ok;
}

ExitCode run_sweep_row(const SweepRowOptions& options) {
  const std::optional<Json> job = analysis::read_result(options.job);
  if (!job) throw Failure(ExitCode::bad_input, options.job + " is no job of a sweep");
  analysis::write_result(options.result, to_json(analysis::run_row(analysis::sweep_job_from(*job), options.settings)));
  return ExitCode::ok;
}

void add_sweep_subject(options::Command& verb, SweepOptions& options) {
  analysis::ParameterSweepOptions& settings = options.settings;
  program::add_scene_file(verb, "scene", settings.job.scene.file).required();
  verb.option("--vary", settings.variations,
              "a value of the scene as for --set, or a parameter, and its range, such as 'Bag.mass=200kg..1500kg:50', "
              "or its values, 'L=2m,3m'; repeat for more")
      .one_value_each()
      .value_name("PATH=VALUES")
      .required();
  verb.option("--measure", settings.job.measures,
              "a number of each run: max, min, mean, rms, final, time_of_max or time_of_min of (EXPRESSION), "
              "at(EXPRESSION, TIME), duration_above(EXPRESSION, BOUND); repeat for more")
      .one_value_each()
      .value_name("MEASURE")
      .required();
  verb.option("--sample", options.sample,
              "grid: the product of all values; random: independent values; lhs: Latin hypercube")
      .one_of({"grid", "random", "lhs"})
      .value_name("KIND")
      .show_default();
  verb.option("--samples", options.samples, "rows of random and lhs")
      .between(1, static_cast<int>(analysis::kMostSweepRows))
      .value_name("N");
  verb.option("--seed", settings.seed, "of random and lhs: the same seed gives the same rows")
      .value_name("S")
      .show_default();
  verb.option("--set", settings.job.scene.overrides, "change a value of the scene for all rows; repeat for more")
      .one_value_each()
      .value_name("PATH=VALUE");
  verb.option("--until", settings.job.scene.duration,
              "how long to simulate, such as '5 s'; without it the scene's duration")
      .value_name("TIME");
  verb.option("--input", settings.job.scene.input, "script (the scene's own), none, or a .csv, .yaml or .lcm file")
      .value_name("SOURCE")
      .show_default();
}

void add_sweep_running(options::Command& verb, SweepOptions& options) {
  analysis::SweepOptions& engine = options.settings.engine;
  verb.option("-o,--output", engine.folder, "folder of the results; a sweep that was ended continues there")
      .value_name("DIR")
      .required();
  verb.flag("--anew", engine.is_fresh, "discard the rows that the folder has");
  verb.option("--workers", engine.workers, "processes at once; of slurm and mpi the tasks of the array or the ranks")
      .between(1, analysis::kMostParts)
      .value_name("N")
      .show_default();
  verb.option("--engine", options.engine,
              "local: processes of this machine; slurm: a job array (sbatch); mpi: ranks of mpirun. The folder must be "
              "one that all machines see")
      .one_of({"local", "slurm", "mpi"})
      .value_name("ENGINE")
      .show_default();
  verb.flag("--json", options.is_json, "print the results as JSON and nothing else");
  verb.flag("--quiet", options.is_quiet, "no progress");
}

}  // namespace

void add_sweep(options::Command& program) {
  options::Command verb = program.command("sweep", "many runs of a scene with varied values, and measures of each");
  const auto options = std::make_shared<SweepOptions>();  // lives as long as the command line's callbacks
  add_sweep_subject(verb, *options);
  add_sweep_running(verb, *options);
  verb.footer(
      "Each row is a process of its own. Ctrl-C keeps the rows that are done; the same command continues.\n"
      "Exit code 0: every row has its measures; 1: a row failed, its code and message are in the table.\n"
      "Measures, statistics, files: docs/howto/sweep.md.\n\n"
      "Examples:\n"
      "  slewring sweep scenes/truck_crane.yaml --until 5s --vary Bag.mass=200kg..1500kg:20 "
      "--measure 'max(Cyl_Lift.force)' -o sweep\n"
      "  slewring sweep scenes/truck_crane.yaml --until 5s --sample lhs --samples 100 --vary Bag.mass=200kg..1500kg "
      "--vary Cyl_Lift.seal_friction=0.5kN..3kN --measure 'rms(Bag.position.x - 4 m)' -o lhs");
  verb.action([options] { return run_sweep_verb(*options); });
}

// the process of one row; not a verb for users
void add_sweep_row(options::Command& program) {
  options::Command verb = program.command("sweep-row", "one row of a sweep");
  verb.hide();
  const auto options = std::make_shared<SweepRowOptions>();
  verb.option("job", options->job, "file of the sweep's job").required();
  verb.option("--set", options->settings, "value of the row").one_value_each();
  verb.option("--result", options->result, "file to write").required();
  verb.action([options] { return run_sweep_row(*options); });
}

// the process of one part of a batch; not a verb for users
void add_sweep_part(options::Command& program) {
  options::Command verb = program.command("sweep-part", "one part of a sweep on an engine");
  verb.hide();
  const auto batch = std::make_shared<std::string>();
  verb.option("batch", *batch, "file of the batch").required();
  verb.action([batch] {
    analysis::run_batch_part(*batch);
    return ExitCode::ok;
  });
}

}  // namespace slew::cli
