// SPDX-License-Identifier: Apache-2.0
// `slewring describe SCENE`: the parts of a scene, its number of states, and its nodes with reasons; on request the
// cost of each part, its eigenvalues and its liftable load.
#include <fmt/format.h>

#include <algorithm>

#include "analysis/description/cost.h"
#include "analysis/description/description.h"
#include "analysis/description/eigenvalues.h"
#include "analysis/description/instant.h"
#include "analysis/description/liftable_load.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/json.h"
#include "program/add_scene_options.h"
#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::cli {
namespace {

// s, default length of the run whose cost is measured: some manoeuvre, some seconds of waiting
constexpr double kCostTime = 8;

struct DescribeOptions {
  std::string scene;
  std::vector<std::string> overrides;
  bool is_json = false;
  // results beside the description
  bool has_cost = false, has_eigenvalues = false, is_frictionless = false, has_liftable = false;
  std::string until;      // end of the run whose cost is measured; empty: all of it, at most kCostTime
  std::size_t count = 8;  // eigenvalues of either end
  std::string at = "0 s";
  std::vector<std::string> pose;

  [[nodiscard]] bool has_part() const { return has_cost || has_eigenvalues || has_liftable; }
};

// Prints only the requested parts, in the order of the options.
ExitCode show_parts(const DescribeOptions& options) {
  // the same physics, in the parts that are described
  scene::Overrides overrides = options.overrides;
  overrides.emplace_back("session.solution=split");
  scene::Scene scene = scene::load_file(options.scene, overrides);
  const double at = analysis::read_option("--at", options.at, Dimension::time);
  Json json = {{"name", scene.name}};
  std::vector<std::string> texts;
  if (options.has_cost) {
    const double whole = scene.session.duration > 0 ? std::min(scene.session.duration, kCostTime) : kCostTime;
    const double until =
        options.until.empty() ? whole : analysis::read_option("--until", options.until, Dimension::time);
    const std::vector<std::string> not_paid = analysis::describe(scene).left_out;
    const analysis::CostByPart cost = analysis::measure_cost(scene, options.scene, overrides, until);
    json["cost"] = analysis::report_json(cost, not_paid);
    texts.push_back(analysis::report_text(cost, not_paid, output_width()));
  }
  if (options.has_eigenvalues) {
    const analysis::Eigenvalues eigenvalues = analysis::find_eigenvalues(
        scene, at, options.is_frictionless ? analysis::DryFriction::neglected : analysis::DryFriction::kept);
    json["eigenvalues"] = analysis::report_json(eigenvalues);
    texts.push_back(analysis::report_text(eigenvalues, options.count, output_width()));
  }
  if (options.has_liftable) {
    const std::vector<analysis::LiftableLoad> loads =
        analysis::find_liftable_of_each(scene, {at, options.pose}, analysis::ListedSettings::named);
    json["liftable"] = analysis::report_json(loads.front());
    // the further bodies of the scene's payload
    for (std::size_t i = 1; i < loads.size(); ++i) json["liftable_others"].push_back(analysis::report_json(loads[i]));
    for (const analysis::LiftableLoad& load : loads) texts.push_back(analysis::report_text(load, output_width()));
  }
  if (options.is_json) {
    fmt::print("{}\n", json.dump(2));
    return ExitCode::ok;
  }
  for (std::size_t i = 0; i < texts.size(); ++i) fmt::print("{}{}", i == 0 ? "" : "\n", texts[i]);
  return ExitCode::ok;
}

ExitCode show(const DescribeOptions& options) {
  if (options.has_part()) return show_parts(options);
  const scene::Scene scene = scene::load_file(options.scene, options.overrides);
  const analysis::Description description = analysis::describe(scene);
  if (options.is_json) {
    fmt::print("{}\n", analysis::report_json(description).dump(2));
  } else {
    fmt::print("{}", analysis::report_text(description, output_width()));
  }
  return ExitCode::ok;
}

}  // namespace

void add_describe(options::Command& program) {
  options::Command verb = program.command("describe", "parts of a scene and the nodes it needs, with reasons");
  const auto options = std::make_shared<DescribeOptions>();  // lives as long as the command line's callbacks
  program::add_scene_file(verb, "scene", options->scene).required();
  verb.option("--set", options->overrides, "change a value of the scene; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  verb.flag("--json", options->is_json, "for machines");
  options::Option cost = verb.flag("--cost", options->has_cost, "what each part costs, measured on the scene's run");
  verb.option("--until", options->until, "end of that run (default: the scene's, at most 8 s)")
      .value_name("TIME")
      .needs(cost);
  options::Option eigenvalues = verb.flag("--eigenvalues", options->has_eigenvalues,
                                          "fastest and slowest motions of the whole machine, and their owners");
  options::Option liftable =
      verb.flag("--liftable", options->has_liftable, "largest payload that the cylinders lift, and its limit");
  verb.option("--at", options->at, "time of the scene's own run at which to look").value_name("TIME").show_default();
  verb.option("--count", options->count, "eigenvalues shown of either end").needs(eigenvalues).show_default();
  verb.flag("--frictionless", options->is_frictionless, "eigenvalues without the dry friction of cylinders and joints")
      .needs(eigenvalues);
  verb.option("--pose", options->pose, "joints put elsewhere, with --liftable; repeat or separate by commas")
      .value_name("JOINT=VALUE")
      .comma_separated()
      .needs(liftable);
  verb.footer(
      "Examples:\n"
      "  slewring describe scenes/truck_crane.yaml\n"
      "  slewring describe scenes/truck_crane.yaml --cost\n"
      "  slewring describe scenes/truck_crane.yaml --eigenvalues --at 5s\n"
      "  slewring describe scenes/truck_crane.yaml --liftable --pose 'Pillar_LiftBoom=20 deg'");
  verb.action([options] { return show(*options); });
}

}  // namespace slew::cli
