// SPDX-License-Identifier: Apache-2.0
#include "analysis/parameter_sweep/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "core/failure.h"
#include "core/suggestion.h"
#include "scene/parameters.h"

namespace slew::analysis {
namespace {

struct MeasureName {
  std::string_view name;
  MeasureKind kind;
  std::string_view argument;  // second argument; empty: there is none
};

constexpr MeasureName kMeasureNames[] = {{"min", MeasureKind::min, ""},
                                         {"max", MeasureKind::max, ""},
                                         {"mean", MeasureKind::mean, ""},
                                         {"rms", MeasureKind::rms, ""},
                                         {"final", MeasureKind::final, ""},
                                         {"at", MeasureKind::at, "a time"},
                                         {"time_of_min", MeasureKind::time_of_min, ""},
                                         {"time_of_max", MeasureKind::time_of_max, ""},
                                         {"duration_above", MeasureKind::duration_above, "a bound"}};
constexpr const char* kMeasureList =
    "min, max, mean, rms, final, time_of_min, time_of_max of (EXPRESSION), at(EXPRESSION, TIME) or "
    "duration_above(EXPRESSION, BOUND)";

// Variables of the session, parameters of the language, values of the scene.
class MeasureNames final : public scene::ExpressionNames {
 public:
  MeasureNames(const scene::Scene& scene, std::span<const ElementVariable> variables, scene::UnitSystem& units)
      : scene_(scene), variables_(variables), units_(units), values_(scene::parameters(scene)) {}

  // The names of a second argument.
  void leave_out_variables() { variables_ = {}; }

  [[nodiscard]] bool have_dots() const override { return true; }
  [[nodiscard]] bool has(std::string_view name) const override {
    const auto is_it = [name](const auto& one) { return one.name == name; };
    return std::any_of(scene_.parameter_texts.begin(), scene_.parameter_texts.end(), is_it);
  }

  [[nodiscard]] scene::NamedQuantity value(std::string_view name) override {
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      if (variables_[i].name != name) continue;
      const scene::Quantity changing{std::numeric_limits<double>::quiet_NaN(), info(variables_[i].dimension).exponent,
                                     false, true};
      return {changing, std::nullopt, i};
    }
    for (const scene::ParameterText& parameter : scene_.parameter_texts) {
      if (parameter.name == name) return scene::quantity_of(parameter.value, units_);
    }
    for (const scene::ParameterInfo& value : values_) {
      if (value.path != name || value.is_choice()) continue;
      for (const scene::ScriptChange& change : scene_.script.changes) {
        if (change.set != name) continue;
        return {std::nullopt, scene::ValueProblem{
                                  fmt::format("the script changes '{}' from {} s on, and a measure has one value of it",
                                              name, change.at),
                                  "a variable, or the number that is meant", ""}};
      }
      return {scene::Quantity{value.value, info(value.dimension).exponent, false}, std::nullopt};
    }
    if (belongs_to_controller(name)) {
      return {std::nullopt,
              scene::ValueProblem{
                  fmt::format("'{}' belongs to a controller, and no controller takes part in these runs", name),
                  "another variable, such as the input's raw or control", ""}};
    }
    return {std::nullopt, scene::ValueProblem{fmt::format("there is no variable, parameter or value '{}'", name),
                                              "a name of 'slewring variables SCENE'", closest_of(name)}};
  }

  [[nodiscard]] std::string closest_of(std::string_view name) const override {
    std::vector<std::string_view> names;
    for (const ElementVariable& variable : variables_) names.push_back(variable.name);
    for (const scene::ParameterText& parameter : scene_.parameter_texts) names.push_back(parameter.name);
    for (const scene::ParameterInfo& value : values_) names.push_back(value.path);
    return closest(name, names);
  }

 private:
  // Variables of an input that only a controller determines.
  [[nodiscard]] bool belongs_to_controller(std::string_view name) const {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos || !name.substr(dot).starts_with(".loop_")) return false;
    return std::any_of(scene_.inputs.begin(), scene_.inputs.end(),
                       [&](const scene::InputDef& input) { return input.name == name.substr(0, dot); });
  }

  const scene::Scene& scene_;
  std::span<const ElementVariable> variables_;
  scene::UnitSystem& units_;
  std::vector<scene::ParameterInfo> values_;
};

// The texts of a call, and where they begin.
struct MeasureCall {
  const MeasureName* name = nullptr;
  std::vector<std::pair<std::string_view, std::size_t>> arguments;
};

[[noreturn]] void refuse_at(const std::string& option, const std::string& text, std::size_t at,
                            const scene::ValueProblem& problem) {
  std::string message = fmt::format("{} '{}': column {}: {}", option, text, at + 1, problem.what);
  if (!problem.expected.empty()) message += "; expected " + problem.expected;
  if (!problem.suggestion.empty()) message += fmt::format("; did you mean '{}'?", problem.suggestion);
  throw Failure(ExitCode::bad_input, message + "; nothing was run");
}

[[noreturn]] void refuse_measure(const std::string& text, std::size_t at, const scene::ValueProblem& problem) {
  refuse_at("--measure", text, at, problem);
}

// "name(a, b)" with its arguments at the outermost level.
MeasureCall read_call(const std::string& text) {
  const std::string_view all = text;
  const std::size_t open = all.find('(');
  const std::size_t close = all.find_last_not_of(" \t");
  if (open == std::string_view::npos || all[close] != ')') {
    refuse_measure(text, 0, {"is no measure", kMeasureList, ""});
  }
  std::string_view name = all.substr(0, open);
  name = name.substr(0, name.find_last_not_of(" \t") + 1);
  name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
  MeasureCall call;
  std::vector<std::string_view> known;
  for (const MeasureName& one : kMeasureNames) {
    known.push_back(one.name);
    if (one.name == name) call.name = &one;
  }
  if (call.name == nullptr) {
    refuse_measure(text, 0, {fmt::format("there is no measure '{}'", name), kMeasureList, closest(name, known)});
  }
  std::size_t begin = open + 1;
  int depth = 0;
  for (std::size_t i = open + 1; i <= close; ++i) {
    depth += all[i] == '(' ? 1 : all[i] == ')' ? -1 : 0;
    if (depth < 0 && i < close) refuse_measure(text, i, {"this bracket ends the measure", "nothing behind it", ""});
    if (i != close && (depth > 0 || all[i] != ',')) continue;
    call.arguments.emplace_back(all.substr(begin, i - begin), begin);
    begin = i + 1;
  }
  const std::size_t expected = call.name->argument.empty() ? 1 : 2;
  if (call.arguments.size() != expected) {
    refuse_measure(text, 0,
                   {fmt::format("{}() has {} arguments", name, call.arguments.size()),
                    expected == 1 ? "one expression" : fmt::format("an expression and {}", call.name->argument), ""});
  }
  return call;
}

scene::CompiledExpression compiled(const std::string& text, const MeasureCall& call, std::size_t argument,
                                   scene::ExpressionNames& names, scene::UnitSystem& units) {
  const auto& [part, place] = call.arguments[argument];
  scene::CompiledResult result = scene::compile(part, names, units);
  if (!result.expression) refuse_measure(text, place + result.fault.at, result.fault.problem);
  return std::move(*result.expression);
}

// Value of a second argument of this unit.
double constant_of(const std::string& text, const MeasureCall& call, const scene::Exponents& exponent,
                   MeasureNames& names, scene::UnitSystem& units) {
  names.leave_out_variables();
  const scene::CompiledExpression constant = compiled(text, call, 1, names, units);
  if (constant.exponent() != exponent) {
    refuse_measure(text, call.arguments[1].second,
                   {fmt::format("{} is {}", call.name->argument, scene::name_of(constant.exponent())),
                    scene::name_of(exponent), ""});
  }
  return constant.value({});
}

}  // namespace

scene::CompiledExpression compile_of_run(const std::string& option, const std::string& text, const scene::Scene& scene,
                                         std::span<const ElementVariable> variables) {
  scene::UnitSystem units;
  MeasureNames names(scene, variables, units);
  scene::CompiledResult result = scene::compile(text, names, units);
  if (!result.expression) refuse_at(option, text, result.fault.at, result.fault.problem);
  return std::move(*result.expression);
}

Measure parse_measure(const std::string& text, const scene::Scene& scene, std::span<const ElementVariable> variables) {
  const MeasureCall call = read_call(text);
  scene::UnitSystem units;
  MeasureNames names(scene, variables, units);
  Measure measure{
      .text = text, .kind = call.name->kind, .expression = compiled(text, call, 0, names, units), .unit = "s"};
  const scene::Exponents& time = info(Dimension::time).exponent;
  switch (measure.kind) {
    case MeasureKind::time_of_min:
    case MeasureKind::time_of_max:
      return measure;
    case MeasureKind::duration_above:
      measure.argument = constant_of(text, call, measure.expression.exponent(), names, units);
      return measure;
    case MeasureKind::at: {
      measure.argument = constant_of(text, call, time, names, units);
      const double until = scene.session.duration;
      if (measure.argument >= 0 && measure.argument <= until) break;
      refuse_measure(
          text, call.arguments[1].second,
          {fmt::format("the time {} s is outside of the run", measure.argument), fmt::format("0 to {} s", until), ""});
    }
    default:
      break;
  }
  const std::optional<std::size_t> only = measure.expression.only_variable();
  measure.unit =
      only ? std::string(info(variables[*only].dimension).si_unit) : scene::si_unit_of(measure.expression.exponent());
  if (measure.unit == "1") measure.unit.clear();
  if (only) measure.variable = variables[*only].name;
  return measure;
}

void MeasuredRun::add(double t, std::span<const double> values) {
  const double x = measure_->expression.value(values);
  if (!std::isfinite(x) && !undefined_at_) undefined_at_ = t;
  const bool is_smallest = measure_->kind == MeasureKind::min || measure_->kind == MeasureKind::time_of_min;
  if (!is_begun_ || (is_smallest ? x < extreme_ : x > extreme_)) {
    extreme_ = x;
    extreme_t_ = t;
  }
  if (is_begun_) {
    add_interval(t, x);
  } else {
    begin_ = t;
    if (measure_->argument <= t) at_ = x;
  }
  is_begun_ = true;
  last_t_ = t;
  last_x_ = x;
}

void MeasuredRun::add_interval(double t, double x) {
  const double dt = t - last_t_;
  switch (measure_->kind) {
    case MeasureKind::mean:
      integral_ += 0.5 * dt * (last_x_ + x);
      break;
    case MeasureKind::rms:
      integral_ += 0.5 * dt * (last_x_ * last_x_ + x * x);
      break;
    case MeasureKind::at:
      if (!at_ && measure_->argument <= t) at_ = last_x_ + (x - last_x_) * (measure_->argument - last_t_) / dt;
      break;
    case MeasureKind::duration_above: {
      const double before = last_x_ - measure_->argument, after = x - measure_->argument;
      const double above = std::max(before, after), below = std::min(before, after);
      if (above > 0) integral_ += below >= 0 ? dt : dt * above / (above - below);
      break;
    }
    default:
      break;
  }
}

std::optional<double> MeasuredRun::value() const {
  if (!is_begun_ || undefined_at_) return std::nullopt;
  const double length = last_t_ - begin_;
  switch (measure_->kind) {
    case MeasureKind::min:
    case MeasureKind::max:
      return extreme_;
    case MeasureKind::time_of_min:
    case MeasureKind::time_of_max:
      return extreme_t_;
    case MeasureKind::mean:
      return length > 0 ? integral_ / length : last_x_;
    case MeasureKind::rms:
      return length > 0 ? std::sqrt(integral_ / length) : std::fabs(last_x_);
    case MeasureKind::at:
      return at_;
    case MeasureKind::duration_above:
      return integral_;
    case MeasureKind::final:
      break;
  }
  return last_x_;
}

}  // namespace slew::analysis
