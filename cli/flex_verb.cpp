// SPDX-License-Identifier: Apache-2.0
// `slewring flex build FILE` and `slewring flex report FILE`: makes flexible files from a description of a flexible
// body, and reports on the reduction.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "flex/attachment_comparison.h"
#include "flex/flexible_files.h"
#include "flex/input_error.h"
#include "flex/mode_shape_plot.h"
#include "flex/reduction_report.h"
#include "flex/text_lines.h"
#include "scene/flexible_model.h"
#include "scene/units.h"

namespace slew::cli {
namespace {

namespace fs = std::filesystem;

struct BuildOptions {
  std::string file;
  std::string output;  // folder; empty: the description's
  std::string model, prefix;
  std::vector<std::string> overrides;
  bool is_json = false;
};

struct ReportOptions {
  std::string file;  // description, or the beginning of a set's file names
  std::vector<std::string> overrides;
  std::string modes;    // "1;2"
  std::string highest;  // "50 Hz"
  std::string svg;
  bool is_json = false;
};

// Turns refusals of libs/flex into failures with exit codes. where: put before the text when not empty.
template <typename Call>
auto with_exit_codes(const std::string& where, const Call& call) {
  const std::string before = where.empty() ? "" : where + ": ";
  try {
    return call();
  } catch (const flex::OutputError& error) {
    throw Failure(ExitCode::storage, before + error.what());
  } catch (const flex::InputError& error) {
    throw Failure(ExitCode::bad_input, before + error.what());
  }
}

// Number and size of the existing files of the set.
struct PresentFiles {
  std::uint64_t files = 0, bytes = 0;
};

PresentFiles present(const flex::FlexibleFileSet& set) {
  PresentFiles out;
  for (const std::string& matrix : flex::flexible_matrices()) {
    std::error_code missing;
    const std::uintmax_t bytes = fs::file_size(flex::flexible_file(set, matrix), missing);
    if (missing) continue;
    ++out.files;
    out.bytes += bytes;
  }
  return out;
}

flex::FlexibleFileSet files_of(const BuildOptions& options, const flex::FlexibleBodyDef& def) {
  const fs::path folder = options.output.empty() ? fs::path(options.file).parent_path() : fs::path(options.output);
  if (!folder.empty() && !fs::is_directory(folder))
    throw Failure(ExitCode::bad_input,
                  "there is no folder '" + folder.string() + "'; nothing was written; make it, or name another");
  return {folder, def.model, def.prefix};
}

Json built_json(const flex::FlexibleFileSet& set, std::uint64_t replaced, const flex::Reduction& all,
                const flex::TipCompliance& tip) {
  Json files = Json::array(), hertz = Json::array();
  for (const std::string& matrix : flex::flexible_matrices())
    files.push_back(flex::flexible_file(set, matrix).string());
  for (const double omega : all.body.omega) hertz.push_back(omega / (2 * M_PI));
  return {{"model", set.model},        {"prefix", set.prefix},           {"files", files}, {"replaced", replaced},
          {"mass", all.body.mass},     {"frequencies_hz", hertz},        {"tip", tip.tip}, {"compliance", tip.full},
          {"nodes", all.source.nodes}, {"elements", all.source.elements}};
}

ExitCode build(const BuildOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (!options.model.empty()) overrides.push_back("model=" + options.model);
  if (!options.prefix.empty()) overrides.push_back("prefix=" + options.prefix);
  const scene::FlexibleModel from = scene::load_flexible_file(options.file, overrides);
  const flex::FlexibleFileSet set = files_of(options, from.def);
  const flex::Reduction all = with_exit_codes(options.file, [&] { return flex::reduce(from.model, from.reduction); });
  const flex::TipCompliance tip = with_exit_codes(options.file, [&] { return flex::tip_compliance(from.model, all); });
  const std::uint64_t replaced = present(set).files;
  with_exit_codes("", [&] { flex::write_flexible_files(set, all); });
  if (options.is_json) {
    fmt::print("{}\n", built_json(set, replaced, all, tip).dump(2));
    return ExitCode::ok;
  }
  const PresentFiles now = present(set);
  fmt::print("{}: {}, {:.1f} kB{}\n", flex::flexible_file(set, "*").string(), counted(now.files, "file", "files"),
             static_cast<double>(now.bytes) / 1e3,
             replaced > 0 ? fmt::format("; {} of an older set replaced", counted(replaced, "file", "files")) : "");
  fmt::print("{}", flex::summary_of(all, tip));
  return ExitCode::ok;
}

// Ordinals of the kept modes; empty: all.
std::vector<int> kept_modes(const ReportOptions& options, const flex::ReducedBody& body) {
  if (!options.modes.empty()) {
    return with_exit_codes("--modes", [&] {
      const std::vector<int> ordinals = flex::mode_list(options.modes);
      (void)flex::places_of(ordinals, body.modes());
      return ordinals;
    });
  }
  if (options.highest.empty()) return {};
  scene::UnitSystem units;
  const scene::QuantityResult highest =
      scene::read_quantity(options.highest, scene::Writing::plain, Dimension::frequency, units);
  if (!highest.value) throw Failure(ExitCode::bad_input, "--frequency-up-to: " + highest.problem.text());
  const std::vector<int> ordinals = flex::modes_up_to(body, 2 * M_PI * *highest.value);
  if (ordinals.empty())
    throw Failure(ExitCode::bad_input,
                  fmt::format("--frequency-up-to: there is no mode up to {}; the lowest has {:.4g} Hz", options.highest,
                              body.modes() > 0 ? body.omega[0] / (2 * M_PI) : 0));
  return ordinals;
}

void write_shapes(const ReportOptions& options, const flex::Reduction& all, std::vector<int> kept) {
  if (options.svg.empty()) return;
  if (kept.empty()) {
    kept.resize(all.body.modes());
    std::iota(kept.begin(), kept.end(), 1);
  }
  with_exit_codes("", [&] { flex::write_text(options.svg, flex::mode_shape_svg(all, kept)); });
}

void print_shapes(const ReportOptions& options) {
  if (!options.svg.empty()) fmt::print("\n  mode shapes: {}\n", options.svg);
}

ExitCode report_description(const ReportOptions& options) {
  const scene::FlexibleModel from = scene::load_flexible_file(options.file, options.overrides);
  const flex::Reduction all = with_exit_codes(options.file, [&] { return flex::reduce(from.model, from.reduction); });
  const std::vector<int> kept = kept_modes(options, all.body);
  const flex::ReductionReport report =
      with_exit_codes(options.file, [&] { return flex::report_reduction(from.model, from.reduction, all, kept); });
  const flex::AttachmentComparison attachments = flex::compare_attachments(from.model, from.reduction, all, kept);
  write_shapes(options, all, kept);
  if (options.is_json) {
    Json json = flex::report_json(report);
    json["attachments"] = flex::report_json(attachments);
    fmt::print("{}\n", json.dump(2));
    return ExitCode::ok;
  }
  fmt::print("{}{}", flex::text_of(report), flex::text_of(attachments));
  print_shapes(options);
  return ExitCode::ok;
}

// "Model_Prefix" of a set, from that name or from one of its files.
std::string stem_of(const std::string& file) {
  const bool is_one = fs::path(file).extension() == ".dat" && file.find('_') != std::string::npos;
  return is_one ? file.substr(0, file.rfind('_')) : file;
}

ExitCode report_set(const ReportOptions& options) {
  if (!options.overrides.empty())
    throw Failure(ExitCode::bad_input,
                  "--set changes a description; '" + options.file + "' is a set of flexible files; build it again");
  const flex::Reduction all =
      with_exit_codes("", [&] { return flex::read_flexible_files(flex::find_flexible_files(stem_of(options.file))); });
  const std::vector<int> kept = kept_modes(options, all.body);
  const flex::ReductionReport report = with_exit_codes(options.file, [&] { return flex::report_files(all, kept); });
  write_shapes(options, all, kept);
  if (options.is_json) {
    fmt::print("{}\n", flex::report_json(report).dump(2));
    return ExitCode::ok;
  }
  fmt::print("{}", flex::text_of(report));
  fmt::print(
      "\n  flexible files hold the reduced body only: errors of the frequencies and of the mass, and clamped beside "
      "free,\n"
      "  need the whole model: name the description that the files were built from\n");
  print_shapes(options);
  return ExitCode::ok;
}

ExitCode report(const ReportOptions& options) {
  const std::string extension = fs::path(options.file).extension();
  const bool is_description =
      extension == ".yaml" || extension == ".yml" || (extension != ".dat" && fs::is_regular_file(options.file));
  return is_description ? report_description(options) : report_set(options);
}

void add_build(options::Command& verb) {
  options::Command part = verb.command("build", "write the flexible files of a described body");
  const auto options = std::make_shared<BuildOptions>();  // lives as long as the command line's callbacks
  part.option("file", options->file, "description of the body").required().value_name("FILE");
  part.option("-o,--output", options->output, "folder of the files; without it that of the description")
      .value_name("FOLDER");
  part.option("--model", options->model, "first part of the files' names, instead of the description's")
      .value_name("NAME");
  part.option("--prefix", options->prefix, "second part, instead of the description's").value_name("NAME");
  part.option("--set", options->overrides, "change a value of the description; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  part.flag("--json", options->is_json, "for machines");
  part.footer(
      "A set of the same name is replaced when the new one is whole.\n\n"
      "Example:\n  slewring flex build scenes/beams/jib_boom.yaml --output scenes");
  part.action([options] { return build(*options); });
}

void add_report(options::Command& verb) {
  options::Command part = verb.command("report", "modes that a reduction keeps, and its accuracy");
  const auto options = std::make_shared<ReportOptions>();  // lives as long as the command line's callbacks
  part.option("file", options->file, "description of the body, or a set of flexible files as FOLDER/Model_Prefix")
      .required()
      .value_name("FILE");
  options::Option modes =
      part.option("--modes", options->modes, "modes that are kept, \"1;2\"; without it all").value_name("LIST");
  part.option("--frequency-up-to", options->highest, "keep the modes up to this frequency, \"50 Hz\"")
      .value_name("FREQUENCY")
      .excludes(modes);
  part.option("--set", options->overrides, "change a value of the description; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  part.option("--svg", options->svg, "draw the shapes of the kept modes into this file").value_name("FILE");
  part.flag("--json", options->is_json, "for machines");
  part.footer("Example:\n  slewring flex report scenes/beams/jib_boom.yaml --modes \"1;2\" --svg jib_boom.svg");
  part.action([options] { return report(*options); });
}

}  // namespace

void add_flex(options::Command& program) {
  options::Command verb = program.command("flex", "flexible bodies: from a description to flexible files");
  verb.require_command();
  verb.footer("Example:\n  slewring flex build scenes/beams/jib_boom.yaml --output scenes");
  add_build(verb);
  add_report(verb);
}

}  // namespace slew::cli
