// SPDX-License-Identifier: Apache-2.0
#include "analysis/tradeoff/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/failure.h"
#include "scene/sections.h"

namespace slew::analysis {
namespace {

constexpr std::string_view kStep = "session.step", kCoupling = "session.coupling",
                           kTolerance = "hydraulics.relative_tolerance", kMaxSubstep = "mechanics.max_substep";
constexpr const char* kSteps[] = {"0.25ms", "0.5ms", "1ms", "2ms", "5ms", "10ms", "20ms"};
constexpr const char* kSubsteps[] = {"0.1ms", "0.25ms", "0.5ms", "1ms", "2ms", "5ms"};
constexpr const char* kTolerances[] = {"1e-2", "1e-3", "1e-4", "1e-5", "1e-6"};
// steps in the product of a modest grid
constexpr std::string_view kProductSteps[] = {"0.5ms", "1ms", "2ms", "5ms", "10ms"};
constexpr std::string_view kProductTolerances[] = {"1e-3", "1e-4"};

std::vector<std::string> names_of(std::string_view section, std::string_view key) {
  for (const scene::SingleTable& table : scene::single_tables()) {
    if (table.section != section) continue;
    for (const Field& field : table.fields) {
      if (field.key == key) return {field.choices.begin(), field.choices.end()};
    }
  }
  return {};
}

template <std::size_t N>
std::vector<std::string> list_of(const char* const (&values)[N]) {
  return {std::begin(values), std::end(values)};
}

void append_product(std::span<const Axis> axes, const Settings& chosen, std::vector<Settings>& rows) {
  if (axes.empty()) {
    rows.push_back(chosen);
    return;
  }
  for (const std::string& value : axes.front().values) {
    Settings more = chosen;
    more.emplace_back(axes.front().path, value);
    append_product(axes.subspan(1), more, rows);
  }
}

std::vector<Settings> without_repetitions(std::vector<Settings> rows) {
  std::set<Settings> seen;
  std::erase_if(rows, [&seen](const Settings& row) { return !seen.insert(row).second; });
  return rows;
}

// the values of an axis that are in a list
template <std::size_t N>
Axis narrowed(const Axis& axis, const std::string_view (&to)[N]) {
  Axis narrow{axis.path, {}};
  std::copy_if(
      axis.values.begin(), axis.values.end(), std::back_inserter(narrow.values),
      [&](const std::string& value) { return std::find(std::begin(to), std::end(to), value) != std::end(to); });
  return narrow;
}

}  // namespace

Axis parse_axis(const std::string& text) {
  const std::size_t equals = text.find('=');
  Axis axis;
  if (equals != std::string::npos && equals > 0) {
    axis.path = text.substr(0, equals);
    std::string value;
    int depth = 0;
    bool is_quoted = false;
    for (const char c : text.substr(equals + 1) + ',') {
      if (c == '"') is_quoted = !is_quoted;
      if (!is_quoted) depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
      if (c != ',' || is_quoted || depth > 0) {
        value += c;
        continue;
      }
      if (!value.empty()) axis.values.push_back(std::exchange(value, {}));
    }
  }
  if (axis.values.empty()) {
    throw Failure(ExitCode::bad_input, fmt::format("--axis {}: is no axis; nothing was run; expected a path and its "
                                                   "values, such as session.step=0.5ms,1ms,2ms, or a parameter "
                                                   "of the scene and its values",
                                                   text));
  }
  return axis;
}

std::vector<Axis> default_axes(const scene::Scene& scene) {
  std::vector<Axis> axes;
  const auto add = [&axes](std::string_view path, std::vector<std::string> values) {
    if (!values.empty()) axes.push_back({std::string(path), std::move(values)});
  };
  add(kStep, list_of(kSteps));
  if (!scene.ports.empty()) add(kCoupling, names_of("session", "coupling"));
  if (scene.has_mechanics()) {
    add("mechanics.formulation", names_of("mechanics", "formulation"));
    std::vector<std::string> integrators = names_of("mechanics", "integrator");
    std::erase(integrators, "own");
    add("mechanics.integrator", integrators);
    add(kMaxSubstep, list_of(kSubsteps));
  }
  if (scene.has_hydraulics()) {
    add("hydraulics.solver", names_of("hydraulics", "solver"));
    add(kTolerance, list_of(kTolerances));
  }
  for (const multibody::BodyDef& body : scene.mechanics.bodies) {
    if (body.type == multibody::BodyType::flexible) add(body.name + ".flex_modes", {"none", "\"1\"", "\"1;2\""});
  }
  if (!scene.mechanics.contacts.empty()) add("session.contact", {"off"});
  return axes;
}

std::vector<Settings> default_grid(std::span<const Axis> axes, GridSize size) {
  std::vector<Settings> rows = {{}};
  for (const Axis& axis : axes) {
    for (const std::string& value : axis.values) rows.push_back({{axis.path, value}});
  }
  std::vector<Axis> product;
  for (const Axis& axis : axes) {
    if (size == GridSize::full || axis.path == kCoupling) {
      product.push_back(axis);
    } else if (axis.path == kStep) {
      product.push_back(narrowed(axis, kProductSteps));
    } else if (axis.path == kTolerance) {
      product.push_back(narrowed(axis, kProductTolerances));
    }
  }
  if (product.size() > 1) append_product(product, {}, rows);
  return without_repetitions(std::move(rows));
}

std::vector<Settings> product_grid(std::span<const Axis> axes) {
  std::vector<Settings> rows = {{}};
  append_product(axes, {}, rows);
  return without_repetitions(std::move(rows));
}

scene::Overrides overrides_of(const Settings& settings) {
  scene::Overrides overrides;
  for (const auto& [path, value] : settings) overrides.push_back(path + '=' + value);
  return overrides;
}

std::string text_of(const Settings& settings) {
  if (settings.empty()) return "as it is";
  std::string text;
  for (const auto& [path, value] : settings) {
    // sections are identified by their keys, elements by their names
    const bool is_section =
        std::any_of(scene::single_tables().begin(), scene::single_tables().end(),
                    [&, &p = path](const auto& table) { return p.starts_with(std::string(table.section) + '.'); });
    const std::string_view shown = is_section ? std::string_view(path).substr(path.find('.') + 1) : path;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", shown, value);
  }
  return text;
}

}  // namespace slew::analysis
