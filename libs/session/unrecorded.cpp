// SPDX-License-Identifier: Apache-2.0
#include "session/unrecorded.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io_node/scene_config.h"
#include "io_node/session_variables.h"
#include "scene/name_pattern.h"
#include "scene/names.h"
#include "scene/sections.h"
#include "session/recorded.h"
#include "transport/roles.h"

namespace slew::session {
namespace {

std::vector<std::string> always_recorded(const scene::Scene& scene) {
  std::vector<std::string> inputs, names;
  for (const scene::InputDef& input : scene.inputs) inputs.push_back(input.name);
  for (wire::VariableEntry& own :
       io_node::own_variables(inputs, io_node::required_roles(scene, io_node::Recording::none))) {
    names.push_back(std::move(own.name));
  }
  return names;
}

bool has_owner(const scene::Scene& scene, std::string_view owner) {
  auto& mutable_scene = const_cast<scene::Scene&>(scene);  // the tables bind to mutable Defs; this code does not write
  const auto fits = [owner](const scene::ElementRef& element) { return scene::fits_pattern(element.name, owner); };
  const auto sections = scene::single_sections(mutable_scene), elements = scene::elements(mutable_scene);
  return std::any_of(sections.begin(), sections.end(), fits) || std::any_of(elements.begin(), elements.end(), fits);
}

bool is_unrecorded(const scene::Scene& scene, const std::string& pattern) {
  // the stresses of a flexible body's elements are too many to be meant by "*"
  const bool is_detail = pattern.find(".Element") != std::string::npos;
  const std::vector<std::string>& recorded = scene.recording.variables;
  return has_owner(scene, std::string_view(pattern).substr(0, pattern.find('.'))) &&
         std::none_of(recorded.begin(), recorded.end(), [&](const std::string& kept) {
           return !(is_detail && kept == "*") && scene::can_meet(pattern, kept);
         });
}

}  // namespace

std::vector<std::string> unrecorded(const scene::Scene& scene, std::span<const std::string> patterns) {
  std::vector<std::string> left_out = scene::unmatched(patterns, always_recorded(scene));
  std::erase_if(left_out, [&scene](const std::string& pattern) { return !is_unrecorded(scene, pattern); });
  return left_out;
}

std::vector<std::string> unrecorded_plots(const scene::Scene& scene) {
  std::vector<std::string> sentences;
  for (const scene::PlotDef& plot : scene.plots) {
    const std::vector<std::string> left_out = unrecorded(scene, plot.variables);
    if (left_out.empty()) continue;
    sentences.push_back(fmt::format("plot {}: {} will not be drawn: the scene records {} only (recording.variables)",
                                    plot.name, fmt::join(left_out, ", "), recorded_patterns_text(scene)));
  }
  return sentences;
}

std::vector<std::string> unmet_patterns(const scene::Scene& scene, const DirectSession& session) {
  std::vector<std::string> names = always_recorded(scene), sentences;
  for (const wire::Role role : transport::physics_roles()) {
    if (session.subsystem(role) == nullptr) continue;
    for (const ElementVariable& variable : session.subsystem(role)->variables()) names.push_back(variable.name);
  }
  const auto add = [&](const std::string& place, const std::string& path, const std::vector<std::string>& patterns) {
    for (const std::string& pattern : scene::unmatched(patterns, names)) {
      sentences.push_back(
          fmt::format("{}{}{}: {}", place, place.empty() ? "" : ": ", path, scene::no_variable_text(pattern, names)));
    }
  };
  add(scene.recording.place, "recording.variables", scene.recording.variables);
  for (const scene::PlotDef& plot : scene.plots) add(plot.place, plot.name + ".variables", plot.variables);
  return sentences;
}

std::vector<std::string> unmet_patterns(const scene::Scene& scene) {
  const std::vector<std::string>& patterns = scene.recording.variables;
  const bool are_all_recorded = patterns.size() == 1 && patterns.front() == "*";
  if (are_all_recorded && scene.plots.empty()) return {};
  return unmet_patterns(scene, DirectSession(scene));
}

std::string recorded_patterns_text(const scene::Scene& scene) {
  return fmt::format("[{}]", fmt::join(scene.recording.variables, ", "));
}

std::string why_missing(const recording::Reader& reader, std::span<const std::string> patterns,
                        std::span<const std::string> names) {
  const scene::Scene scene = scene::load_text(recorded_scene_text(reader), reader.identity().scene);
  const std::vector<std::string> left_out = unrecorded(scene, patterns);
  if (!left_out.empty()) {
    return fmt::format("{} {} not in this recording, whose scene records {} only (recording.variables)",
                       fmt::join(left_out, ", "), left_out.size() == 1 ? "is" : "are", recorded_patterns_text(scene));
  }
  return scene::no_variable_text(patterns.front(), names);
}

}  // namespace slew::session
