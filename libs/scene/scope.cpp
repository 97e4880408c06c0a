// SPDX-License-Identifier: Apache-2.0
#include "scene/scope.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/suggestion.h"
#include "scene/names.h"

namespace slew::scene {
namespace {

constexpr std::size_t kOpening = 2;  // "${"

std::string_view trimmed_name(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

int characters_before(std::string_view text, std::size_t byte) {
  return static_cast<int>(std::count_if(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(byte),
                                        [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

// place of a byte of the scalar's text, which stands on one line
Mark mark_in(const Node& scalar, std::size_t byte) {
  Mark mark = scalar.mark;
  if (mark.column > 0) mark.column += characters_before(scalar.text, byte) + (scalar.is_quoted ? 1 : 0);
  return mark;
}

std::size_t count_values(const Node& node) {
  std::size_t count = 1;
  for (const Node& item : node.items) count += count_values(item);
  return count;
}

// the place of the use, and values that no longer are the file's own text
void move_to(Node& node, const Mark& mark) {
  node.mark = mark;
  if (node.origin == Node::Origin::file) node.origin = Node::Origin::expression;
  for (Node& item : node.items) move_to(item, mark);
}

}  // namespace

bool is_value_of_parameter(const Node& node) {
  const auto is_list_of_values = [](const Node& list) {
    return list.kind == Node::Kind::sequence && std::all_of(list.items.begin(), list.items.end(), [](const Node& item) {
             return item.kind == Node::Kind::scalar;
           });
  };
  const auto is_entry = [&](const Node& item) { return item.kind == Node::Kind::scalar || is_list_of_values(item); };
  return node.kind == Node::Kind::scalar ||
         (node.kind == Node::Kind::sequence && std::all_of(node.items.begin(), node.items.end(), is_entry));
}

bool is_expression(std::string_view text) {
  return text.starts_with("${");
}

bool is_escaped(std::string_view text) {
  const std::size_t dollars = text.find_first_not_of('$');
  return dollars != std::string_view::npos && dollars > 1 && text[dollars] == '{';
}

UnitSystem& ScopeContext::unit_system() {
  if (!units) units.emplace();
  return *units;
}

void Scope::declare(const Node& parameters, const std::string& path) {
  if (parameters.kind != Node::Kind::map) {
    context_.report.add(parameters.mark, path, {"is " + describe(parameters), "a map, such as {L: 2.6 m}", ""});
    return;
  }
  report_duplicates(parameters, path, context_.report);
  if (parameters.entries.size() > kMaxParameters) {
    context_.report.add(parameters.mark, path,
                        {fmt::format("there are {} parameters", parameters.entries.size()),
                         fmt::format("at most {}", kMaxParameters), ""});
    return;
  }
  for (const Node::Entry& entry : parameters.entries) {
    const std::string own_path = path + "." + entry.key;
    if (!is_word(entry.key) || entry.key.size() > kMaxNameLength) {
      context_.report.add(
          entry.mark, own_path,
          {"is not a name", fmt::format("at most {} letters, digits and _, beginning with a letter", kMaxNameLength),
           ""});
      continue;
    }
    if (is_reserved_in_expressions(entry.key)) {
      context_.report.add(entry.mark, own_path, {"the name is reserved in expressions", "another name", ""});
      continue;
    }
    if (entry.value.kind != Node::Kind::empty && !is_value_of_parameter(entry.value)) {
      context_.report.add(entry.value.mark, own_path, {"is " + describe(entry.value), kValueOfParameter, ""});
      continue;
    }
    numbers_.emplace(entry.key, parameters_.size());
    parameters_.push_back({.name = entry.key, .path = own_path, .mark = entry.mark, .value = entry.value});
  }
}

bool Scope::give(std::string_view name, Node value) {
  const auto found = numbers_.find(name);
  if (found == numbers_.end()) return false;
  parameters_[found->second].value = std::move(value);
  parameters_[found->second].state = Parameter::State::done;
  return true;
}

void Scope::substitute(Node& node, const std::string& path) {
  if (node.kind == Node::Kind::scalar) substitute_scalar(node, path);
  for (std::size_t i = 0; i < node.items.size(); ++i) substitute(node.items[i], path);
  for (Node::Entry& entry : node.entries) substitute(entry.value, path.empty() ? entry.key : path + "." + entry.key);
}

void Scope::substitute_scalar(Node& node, const std::string& path) {
  if (is_escaped(node.text)) {
    node.text.erase(0, 1);
    return;
  }
  if (!is_expression(node.text)) return;
  if (node.text.find('}') != node.text.size() - 1) {
    context_.report.add(node.mark, path,
                        {describe(node) + " begins with an expression and is longer",
                         "the expression as the whole value, ${...}, or $${ at the begin of a text", ""});
    return;
  }
  const std::string_view inner = std::string_view(node.text).substr(kOpening, node.text.size() - kOpening - 1);
  const std::string_view name = trimmed_name(inner);
  if (is_word(name) && name != "pi") {
    const std::string own(name);
    const Mark place = mark_in(node, kOpening + static_cast<std::size_t>(name.data() - inner.data()));
    if (substitute_name(node, own, place, path)) return;
  }
  const ExpressionResult result = evaluate(inner, *this, context_.unit_system());
  if (!result.quantity) {
    if (result.fault.problem.what.empty()) return;
    context_.report.add(mark_in(node, kOpening + result.fault.at), path, result.fault.problem);
    return;
  }
  const bool is_ratio = result.quantity->exponent == Exponents{} && !result.quantity->is_bare;
  node.text = text_of(*result.quantity);
  node.is_quoted = false;
  node.origin = is_ratio ? Node::Origin::ratio : Node::Origin::expression;
}

// True: done, with or without a problem.
bool Scope::substitute_name(Node& node, std::string_view name, const Mark& place, const std::string& path) {
  const Found found = look_up(name);
  if (found.parameter == nullptr) return false;  // reported as part of an expression
  found.parameter->is_used = true;
  if (const auto problem = found.scope->settle(*found.parameter)) {
    if (!problem->what.empty()) context_.report.add(place, path, *problem);
    return true;
  }
  const Mark mark = node.mark;
  const Node& value = found.parameter->value;
  if (value.kind == Node::Kind::sequence && context_.chain > 0) {
    context_.report.add(place, path,
                        {fmt::format("parameter '{}' is a list, within another parameter", name),
                         "one value, such as an entry of it", ""});
    return true;
  }
  if (value.kind == Node::Kind::sequence) context_.list_values += count_values(value);
  if (context_.list_values > kMaxListValues) {
    context_.report.add(
        place, path,
        {"the lists of parameters give the scene too many values", fmt::format("at most {}", kMaxListValues), ""});
    return true;
  }
  node = value;
  move_to(node, mark);
  return true;
}

std::optional<ValueProblem> Scope::settle(Parameter& parameter) {
  using State = Parameter::State;
  if (parameter.state == State::done) return std::nullopt;
  if (parameter.state == State::faulty) return ValueProblem{};
  if (parameter.state == State::running) {
    return ValueProblem{fmt::format("parameter '{}' depends on itself", parameter.name),
                        "parameters that use each other in one direction", ""};
  }
  if (parameter.value.kind == Node::Kind::empty) {
    parameter.state = State::faulty;
    return ValueProblem{fmt::format("parameter '{}' has no value", parameter.name),
                        fmt::format("a value at {}, or from the instance", parameter.path), ""};
  }
  if (context_.chain >= kMaxParameterChain) {
    return ValueProblem{fmt::format("more than {} parameters use each other, one by one", kMaxParameterChain),
                        "a shorter chain", ""};
  }
  parameter.state = State::running;
  ++context_.chain;
  const std::size_t problems = context_.report.size();
  substitute(parameter.value, parameter.path);
  --context_.chain;
  parameter.state = context_.report.size() == problems ? State::done : State::faulty;
  return parameter.state == State::done ? std::nullopt : std::optional(ValueProblem{});
}

void Scope::settle_rest() {
  for (Parameter& parameter : parameters_) {
    if (parameter.value.kind == Node::Kind::empty && parameter.state == Parameter::State::untouched) continue;
    const auto problem = settle(parameter);
    if (problem && !problem->what.empty()) context_.report.add(parameter.mark, parameter.path, *problem);
  }
}

std::vector<Scope::Unused> Scope::unused() const {
  std::vector<Unused> found;
  for (const Parameter& parameter : parameters_) {
    if (!parameter.is_used) found.push_back({parameter.name, parameter.mark});
  }
  return found;
}

std::vector<std::string_view> Scope::own_names() const {
  std::vector<std::string_view> names;
  for (const Parameter& parameter : parameters_) names.push_back(parameter.name);
  return names;
}

std::vector<ParameterText> Scope::own_values() const {
  std::vector<ParameterText> values;
  for (const Parameter& parameter : parameters_) {
    if (parameter.value.kind == Node::Kind::sequence) continue;
    if (parameter.state == Parameter::State::done) values.push_back({parameter.name, parameter.value.text});
  }
  return values;
}

Scope::Found Scope::look_up(std::string_view name) {
  for (Scope* scope = this; scope != nullptr; scope = scope->around_) {
    const auto found = scope->numbers_.find(name);
    if (found != scope->numbers_.end()) return {&scope->parameters_[found->second], scope};
  }
  return {};
}

bool Scope::has(std::string_view name) const {
  return numbers_.contains(name) || (around_ != nullptr && around_->has(name));
}

NamedQuantity Scope::value(std::string_view name) {
  const Found found = look_up(name);
  if (found.parameter == nullptr) return {};
  found.parameter->is_used = true;
  if (auto problem = found.scope->settle(*found.parameter)) return {std::nullopt, std::move(problem)};
  return quantity_at(found.parameter->value, name);
}

NamedQuantity Scope::entry(std::string_view name, std::size_t number) {
  const Found found = look_up(name);
  if (found.parameter == nullptr) return {};
  found.parameter->is_used = true;
  if (auto problem = found.scope->settle(*found.parameter)) return {std::nullopt, std::move(problem)};
  const Node& value = found.parameter->value;
  if (value.kind != Node::Kind::sequence) {
    return {std::nullopt, ValueProblem{fmt::format("parameter '{}' is {}, no list", name, describe(value)),
                                       "a parameter with a list", ""}};
  }
  if (number >= value.items.size()) {
    return {std::nullopt,
            ValueProblem{fmt::format("list '{}' has {} entries, counted from 0", name, value.items.size()),
                         fmt::format("a number below {}", value.items.size()), ""}};
  }
  return quantity_at(value.items[number], fmt::format("{}[{}]", name, number));
}

// name: for messages
NamedQuantity Scope::quantity_at(const Node& value, std::string_view name) {
  NamedQuantity result = quantity_of(value.text, context_.unit_system());
  const bool is_text = value.is_quoted && result.quantity && result.quantity->is_bare;
  if (result.problem || is_text) {
    result.quantity.reset();
    result.problem = ValueProblem{fmt::format("parameter '{}' is {}, no quantity", name, describe(value)),
                                  "a parameter with a number", ""};
  } else if (value.origin == Node::Origin::ratio) {
    result.quantity->is_bare = false;
  }
  return result;
}

std::string Scope::closest_of(std::string_view name) const {
  std::vector<std::string_view> names;
  for (const Scope* scope = this; scope != nullptr; scope = scope->around_) {
    for (const std::string_view own : scope->own_names()) names.push_back(own);
  }
  return closest(name, names);
}

}  // namespace slew::scene
