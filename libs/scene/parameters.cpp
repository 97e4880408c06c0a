// SPDX-License-Identifier: Apache-2.0
#include "scene/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/suggestion.h"
#include "hydraulics/live_rules.h"
#include "multibody/build/validate.h"
#include "multibody/formulations/element_speeds.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/body_inertia.h"
#include "multibody/model/field_tables.h"
#include "multibody/model/model.h"
#include "multibody/model/parameters.h"
#include "scene/field_reader.h"
#include "scene/ports.h"
#include "scene/script.h"
#include "scene/sections.h"

namespace slew::scene {
namespace {

constexpr std::string_view kAxes[] = {".x", ".y", ".z"};

ParameterInfo about(const Field& field, std::string path, double value) {
  return {.path = std::move(path),
          .value = value,
          .dimension = field.type == FieldType::integer ? Dimension::none : field.dimension,
          .range = field.range,
          .change = field.change,
          .ramp = field.ramp,
          .is_integer = field.type == FieldType::integer,
          .choices = field.choices,
          .doc = field.doc};
}

void add_field(std::vector<ParameterInfo>& all, const Field& field, const std::string& path, void* def) {
  switch (field.type) {
    case FieldType::number:
      all.push_back(about(field, path, *static_cast<const double*>(field.member(def))));
      break;
    case FieldType::integer:
      all.push_back(about(field, path, static_cast<double>(*static_cast<const std::int64_t*>(field.member(def)))));
      break;
    case FieldType::triple:
      for (std::size_t i = 0; i < 3; ++i) {
        all.push_back(about(field, path + std::string(kAxes[i]), (*static_cast<const Triple*>(field.member(def)))[i]));
      }
      break;
    case FieldType::choice:
      all.push_back(about(field, path, field.get_choice(def)));
      break;
    default:
      break;
  }
}

// The tables bind to mutable Defs; they are only read here.
std::vector<ElementRef> everything(const Scene& scene) {
  auto& mutable_scene = const_cast<Scene&>(scene);
  std::vector<ElementRef> all = single_sections(mutable_scene);
  for (ElementRef& element : elements(mutable_scene)) all.push_back(element);
  return all;
}

// Why a live field of this element would change nothing in this scene: the mechanism has no row that it belongs to.
// Empty: it changes something.
std::string obstacle(const Scene& scene, const ElementRef& element, const Field& field) {
  const auto restart = [&](std::string_view with) {
    return fmt::format("; start it again with --set {}.{}=VALUE", element.name, with);
  };
  if (element.section == "mechanics" && !scene.has_mechanics()) return "the scene has no bodies";
  if (element.section == "session" && scene.ports.empty()) return "the scene has no cylinder that is coupled";
  const multibody::ElementType* const type = multibody::find_type(element.section, element.type);
  if (type != nullptr && type->obstacle_of_change != nullptr) return type->obstacle_of_change(element.def, field);
  if (element.section != "joints") return {};
  const auto& joint = *static_cast<const multibody::JointDef*>(element.def);
  const int number = multibody::coordinate_of_key(joint.type, field.key);
  const std::string_view suffix = multibody::suffix_of(joint.type, number);
  const std::string_view key = field.key.substr(0, field.key.size() - suffix.size());
  const bool is_of_limits = key == "limit_stiffness" || key == "limit_damping";
  if (is_of_limits && !multibody::has_limits(multibody::axis_of(joint, number)))
    return "the joint has no limits" + restart(fmt::format("limit_max{}", suffix));
  if (multibody::has_row(multibody::axis_of(joint, number))) return {};
  return "the scene gives the joint neither friction nor limits, so none is computed" + restart(field.key);
}

Assignment refused(std::string text) {
  Assignment assignment;
  assignment.status = Status::error(ExitCode::bad_input, std::move(text));
  return assignment;
}

}  // namespace

std::string_view ParameterInfo::choice_of(double number) const noexcept {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (number == static_cast<double>(i)) return choices[i];
  }
  return {};
}

std::vector<ParameterInfo> parameters(const Scene& scene) {
  std::vector<ParameterInfo> all;
  for (const ElementRef& element : everything(scene)) {
    for (const Field& field : element.fields) {
      const std::size_t first = all.size();
      add_field(all, field, std::string(element.name) + "." + std::string(field.key), element.def);
      if (field.change != Change::live) continue;
      const std::string reason = obstacle(scene, element, field);
      if (reason.empty()) continue;
      for (std::size_t i = first; i < all.size(); ++i) {
        all[i].change = Change::restart;
        all[i].obstacle = reason;
      }
    }
  }
  return all;
}

double mechanics_substep(const SessionDef& session, const multibody::MechanicsDef& mechanics) {
  constexpr double kRounding = 1e-9;
  return session.step / std::max(1.0, std::ceil(session.step / mechanics.max_substep * (1 - kRounding)));
}

ParameterDirectory::ParameterDirectory(const Scene& scene)
    : session_(scene.session),
      ports_(scene.ports),
      circuit_(std::make_shared<const hydraulics::HydraulicsDef>(hydraulics::copy_of(scene.hydraulics))),
      parameters_(parameters(scene)) {
  // without the tables of files, or the files of flexible bodies, no mechanism can be built
  const multibody::MechanicsDef& parts = scene.mechanics;
  const bool is_whole = std::all_of(scene.table_files.begin(), scene.table_files.end(),
                                    [](const TableFile& table) { return !table.found.empty(); }) &&
                        std::all_of(parts.flexible_bodies.begin(), parts.flexible_bodies.end(),
                                    [](const multibody::FlexibleBodyDef& body) { return body.modes != nullptr; }) &&
                        std::all_of(parts.segmented_bodies.begin(), parts.segmented_bodies.end(),
                                    [](const multibody::SegmentedBodyDef& body) { return body.chain != nullptr; });
  if (is_whole && scene.has_mechanics() && session_.solution == Solution::split) {
    mechanics_ = std::make_shared<const multibody::MechanicsDef>(scene.mechanics);
  }
  // the files of flexible bodies may be missing, and without them the machine cannot be checked
  if (scene.has_mechanics() && !scene.has_flexible_bodies()) {
    whole_mechanics_ =
        mechanics_ != nullptr ? mechanics_ : std::make_shared<const multibody::MechanicsDef>(scene.mechanics);
  }
  for (std::size_t i = 0; i < parameters_.size(); ++i) index_.emplace(parameters_[i].path, i);
  for (const ElementRef& element : everything(scene)) {
    for (const Field& field : element.fields) {
      std::string path = std::string(element.name) + "." + std::string(field.key);
      if (!index_.contains(path)) not_numeric_.emplace(std::move(path), expected_value(field));
    }
  }
}

const ParameterInfo* ParameterDirectory::find(std::string_view path) const {
  const auto found = index_.find(path);
  return found == index_.end() ? nullptr : &parameters_[found->second];
}

// Reason why the session, or a port that follows it or may do so later, cannot use this value of a coupling level;
// empty: it can, or the parameter is no level.
std::string ParameterDirectory::obstacle_of_level(const ParameterInfo& parameter, double value) const {
  if (!parameter.path.ends_with(".coupling")) return {};
  const bool is_of_session = parameter.path == "session.coupling";
  const auto number = static_cast<int>(value);
  const auto own = static_cast<coupling::PortLevel>(number);
  const bool follows = !is_of_session && own == coupling::PortLevel::session;
  const coupling::Level level = is_of_session ? static_cast<coupling::Level>(number)
                                : follows     ? session_.coupling
                                              : coupling::level_of(own);
  for (const PortDef& port : ports_) {
    const std::string_view why = obstacle_of(port, level);
    if (!why.empty() && (is_of_session || parameter.path == port.name + ".coupling"))
      return fmt::format("{}: {}", port.name, why);
  }
  return follows ? std::string() : std::string(obstacle_of(session_, level));
}

// Whether this change alone may make the mechanism too fast for its integrator.
bool ParameterDirectory::may_be_faster(const ParameterInfo& parameter, double from, double to) const {
  if (mechanics_ == nullptr || !multibody::is_explicit(multibody::step_rule(*mechanics_).integrator)) return false;
  const bool is_mass = parameter.path.ends_with(".mass");
  // a shorter rope of the same section is stiffer
  const bool is_length = parameter.path.ends_with(".free_length");
  return to != from && (is_length || is_mass == (to < from));
}

// Costs some hundred evaluations of the mechanism.
std::string ParameterDirectory::obstacle_of_speed(Values values) const {
  multibody::Model model = multibody::build_model(*mechanics_);
  bool may_be_fast = false;
  for (const auto& [path, value] : values) {
    const std::optional<multibody::Parameter> found = multibody::find_parameter(model, path);
    if (!found) continue;
    may_be_fast = may_be_fast || multibody::may_speed_up(found->kind);
    multibody::set_parameter(model, *found, value);
  }
  if (!may_be_fast) return {};
  const multibody::Integrator rule = multibody::step_rule(*mechanics_).integrator;
  const double h = mechanics_substep(session_, *mechanics_);
  const std::optional<multibody::TooFast> fast = multibody::find_too_fast_element(model, rule, h);
  if (!fast) return {};
  const Problem problem = multibody::problem_of(*fast, rule, h);
  return problem.path + ": " + problem.what + "; expected " + problem.expected;
}

namespace {

// Sets the element's field named by the path. False: there is none.
bool assign(Scene& scene, std::string_view path, double value) {
  for (const ElementRef& element : elements(scene)) {
    if (!path.starts_with(element.name) || path.size() <= element.name.size() || path[element.name.size()] != '.') {
      continue;
    }
    const std::string_view key = path.substr(element.name.size() + 1);
    for (const Field& field : element.fields) {
      if (field.type == FieldType::number && field.key == key) {
        *static_cast<double*>(field.member(element.def)) = value;
        return true;
      }
      if (field.type != FieldType::triple || !key.starts_with(field.key)) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        if (key.substr(field.key.size()) != kAxes[i]) continue;
        (*static_cast<Triple*>(field.member(element.def)))[i] = value;
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool ParameterDirectory::is_of_machine(std::string_view path) const {
  const multibody::MechanicsDef& mechanics = *whole_mechanics_;
  Scene probe;
  probe.mechanics = mechanics;
  return assign(probe, path, 0);
}

// Problem that the loader would report for the machine with these values, at its start.
std::string ParameterDirectory::obstacle_of_machine(Values values) const {
  Scene changed;
  changed.session = session_;
  changed.mechanics = *whole_mechanics_;
  for (const auto& [path, value] : values) {
    for (multibody::BodyDef& body : changed.mechanics.bodies) {
      if (path != body.name + ".mass") continue;
      // a live mass changes the inertia about the centre in proportion: what the scene gives about the origin is no sum
      // of the old inertia and the new mass
      const math::Mat3 I = multibody::inertia_about_center(body);
      body.inertia = {I(0, 0), I(1, 1), I(2, 2)};
      body.products = {I(0, 1), I(0, 2), I(1, 2)};
      body.inertia_about = multibody::InertiaPoint::center_of_mass;
    }
    assign(changed, path, value);
  }
  Problems problems;
  multibody::validate(changed.mechanics, problems);
  if (problems.empty()) return {};
  const Problem& first = problems.front();
  return first.path + ": " + first.what + "; expected " + first.expected;
}

// Why no number is at this path.
std::string ParameterDirectory::reason_of_no_parameter(const std::string& name) const {
  const ParameterInfo* part = find(name + ".x");
  if (part != nullptr && part->change == Change::live && part->obstacle.empty())
    return fmt::format("{0} is three numbers, which change one by one; expected {0}.x, {0}.y or {0}.z", name);
  if (const auto other = not_numeric_.find(name); other != not_numeric_.end())
    return fmt::format("{} takes {} and cannot be changed while the session runs; start it again with --set {}=VALUE",
                       name, other->second, name);
  std::vector<std::string_view> live;
  for (const ParameterInfo& candidate : parameters_) {
    if (candidate.change == Change::live) live.push_back(candidate.path);
  }
  const auto own = std::find_if(live.begin(), live.end(), [&](std::string_view candidate) {
    return candidate.starts_with(name) && candidate.substr(name.size()).starts_with('.');
  });
  if (own != live.end())
    return fmt::format("'{}' alone is no parameter; expected one of its own, such as {}", name, *own);
  const std::string suggestion = closest(name, live);
  if (!suggestion.empty()) return fmt::format("no parameter '{}'; did you mean '{}'?", name, suggestion);
  const std::string example = live.empty() ? std::string() : fmt::format(", such as {}", live.front());
  return fmt::format("no parameter '{}'; expected Element.key{}", name, example);
}

Assignment ParameterDirectory::check(std::string_view path, double value, std::optional<SimDuration> over,
                                     Beside beside) const {
  const std::string name(path);
  const std::string restart = "cannot be changed while the session runs; start it again with --set " + name + "=VALUE";
  const ParameterInfo* parameter = find(path);
  if (parameter == nullptr) return refused(reason_of_no_parameter(name));
  if (!parameter->obstacle.empty()) return refused(name + " would change nothing: " + parameter->obstacle);
  if (parameter->change == Change::restart) {
    return refused(name + (parameter->is_choice() ? " takes " + choice_list(parameter->choices) + " and " : " ") +
                   restart);
  }
  if (parameter->is_choice() && parameter->choice_of(value).empty()) {
    return refused(
        fmt::format("{}: {} is none of its choices; expected {}", name, value, choice_list(parameter->choices)));
  }
  if (const std::string level = obstacle_of_level(*parameter, value); !level.empty()) {
    return refused(fmt::format("{}: {}", name, level));
  }
  if (parameter->is_choice() && over && over->ns > 0) {
    return refused(name + " is a choice and changes at once; leave out the time to spread it over");
  }
  if (!parameter->range.contains(value) || !std::isfinite(value)) {
    const std::string range = range_text(parameter->range, parameter->dimension);
    return refused(fmt::format("{}: {} is out of range; expected {}", name, with_unit(value, parameter->dimension),
                               range.empty() ? "a finite number" : range));
  }
  if (beside == Beside::scene) {
    std::string refusal = refusal_of_machine(*parameter, value, {}, {});
    if (!refusal.empty()) return refused(std::move(refusal));
  }
  Assignment assignment;
  assignment.path = name;
  assignment.value = value;
  assignment.over = whole_steps(over.value_or(duration_of_seconds(parameter->ramp)), session_.step_duration());
  return assignment;
}

namespace {

// steps at which the mechanism is looked at, for a request
constexpr std::size_t kMostBuilds = 8;

struct RampOfValue {
  std::string path;
  double from = 0, to = 0;
  StepIndex begin = 0, steps = 1;
  [[nodiscard]] StepIndex last() const noexcept { return begin + std::max<StepIndex>(1, steps) - 1; }
  [[nodiscard]] double at(StepIndex n) const noexcept {
    if (n >= last()) return to;
    return from + (to - from) * (static_cast<double>(n - begin + 1) / static_cast<double>(steps));
  }
};

}  // namespace

// The refusal of a value of the mechanism beside those of a session: at the first step of the changes, and where each
// of those that begin there ends. Without changes: beside the scene's.
std::string ParameterDirectory::refusal_of_machine(const ParameterInfo& parameter, double value, Values present,
                                                   std::span<const LiveChange> changes) const {
  if (whole_mechanics_ == nullptr && mechanics_ == nullptr) return {};
  const bool has_no_rules = whole_mechanics_ == nullptr || !is_of_machine(parameter.path);
  std::map<std::string, double, std::less<>> now;
  for (const auto& [path, at_present] : present) {
    const ParameterInfo* const other = find(path);
    if (other != nullptr && other->value != at_present) now.insert_or_assign(path, at_present);
  }
  const auto value_of = [&](const std::string& path, double otherwise) {
    const auto found = now.find(path);
    return found == now.end() ? otherwise : found->second;
  };
  std::vector<RampOfValue> ramps;
  for (const LiveChange& change : changes) {
    const ParameterInfo* const other = find(change.path);
    if (other == nullptr || change.step != changes.front().step) continue;
    std::erase_if(ramps, [&](const RampOfValue& ramp) { return ramp.path == change.path; });
    ramps.push_back({change.path, value_of(change.path, other->value), change.value, change.step, change.steps});
  }
  if (changes.empty()) ramps.push_back({parameter.path, parameter.value, value});
  const double from = value_of(parameter.path, parameter.value);
  const bool may_be_fast = mechanics_ != nullptr && (may_be_faster(parameter, from, value) || ramps.size() > 1);
  if (has_no_rules && !may_be_fast) return {};
  std::vector<StepIndex> steps = {ramps.front().begin};
  for (const RampOfValue& ramp : ramps) steps.push_back(ramp.last());
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  if (steps.size() > kMostBuilds) steps.resize(kMostBuilds);
  for (const StepIndex n : steps) {
    std::map<std::string, double, std::less<>> then = now;
    for (const RampOfValue& ramp : ramps) then.insert_or_assign(ramp.path, ramp.at(n));
    const std::vector<std::pair<std::string, double>> values(then.begin(), then.end());
    std::string why = has_no_rules ? std::string() : obstacle_of_machine(values);
    if (why.empty() && may_be_fast) why = obstacle_of_speed(values);
    if (why.empty()) continue;
    const SimDuration step = session_.step_duration();
    const std::string when =
        n > ramps.front().begin ? fmt::format("at {:g} s: ", start_of(n, step).seconds()) : std::string();
    return fmt::format("{}: {} is refused: {}{}", parameter.path, with_unit(value, parameter.dimension), when, why);
  }
  return {};
}

std::string ParameterDirectory::refusal_of_course(std::string_view path, double value,
                                                  std::span<const std::pair<std::string, double>> present,
                                                  std::span<const LiveChange> changes) const {
  const ParameterInfo* const parameter = find(path);
  if (parameter == nullptr || changes.empty()) return {};
  const std::optional<BrokenRule> broken = find_broken_rule(*circuit_, present, changes);
  if (!broken) return refusal_of_machine(*parameter, value, present, changes);
  const SimDuration step = session_.step_duration();
  const bool is_later = broken->step > changes.front().step;
  const std::string when = is_later ? fmt::format(" at {:g} s", start_of(broken->step, step).seconds()) : std::string();
  return fmt::format("{}: {} is refused: {}{}: {}; expected {}", path, with_unit(value, parameter->dimension),
                     broken->problem.path, when, broken->problem.what, broken->problem.expected);
}

Assignment ParameterDirectory::parse_choice(const ParameterInfo& parameter, std::string_view name,
                                            std::optional<SimDuration> over, Beside beside) const {
  while (name.starts_with(' ')) name.remove_prefix(1);
  while (name.ends_with(' ')) name.remove_suffix(1);
  const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), name);
  if (found != parameter.choices.end()) {
    return check(parameter.path, static_cast<double>(found - parameter.choices.begin()), over, beside);
  }
  const std::string meant = closest(name, {parameter.choices.begin(), parameter.choices.end()});
  return refused(fmt::format("{}: '{}' is none of its choices; expected {}{}", parameter.path, name,
                             choice_list(parameter.choices), meant.empty() ? "" : "; did you mean '" + meant + "'?"));
}

Assignment ParameterDirectory::parse_assignment(std::string_view text, std::optional<SimDuration> over, Beside beside) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return refused(
        fmt::format("'{}' is not an assignment; expected Element.key=value, such as 'Bag.mass=1500kg'", text));
  }
  const std::string_view path = text.substr(0, equals);
  const ParameterInfo* parameter = find(path);
  // an unknown or fixed parameter is refused for that reason, at any value
  if (parameter == nullptr || parameter->change == Change::restart) return check(path, 0);
  if (parameter->is_choice()) return parse_choice(*parameter, text.substr(equals + 1), over, beside);
  const QuantityResult quantity = read_quantity(text.substr(equals + 1), Writing::plain, parameter->dimension, units_);
  if (!quantity.value) {
    std::string refusal = std::string(path) + ": " + quantity.problem.what + "; expected " + quantity.problem.expected;
    if (!quantity.problem.suggestion.empty()) refusal += "; did you mean '" + quantity.problem.suggestion + "'?";
    return refused(std::move(refusal));
  }
  return check(path, *quantity.value == 0 ? 0.0 : *quantity.value, over, beside);  // -0 is 0
}

}  // namespace slew::scene
