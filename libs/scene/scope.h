// SPDX-License-Identifier: Apache-2.0
// The parameters of a file, a group or one of its instances, and the expressions that use them.
//
// A scope sees its own parameters and those of the scopes around it. A parameter is a scalar; its value may use other
// parameters in any order, but not itself. `${name}` alone is the parameter's value as it is written, so that no number
// changes; other expressions give quantities (expression.h).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/diagnostic.h"
#include "scene/expression.h"
#include "scene/scene.h"
#include "scene/units.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

inline constexpr std::size_t kMaxParameters = 1000;     // of one scope
inline constexpr int kMaxParameterChain = 64;           // parameters that use each other, one by one
inline constexpr std::size_t kMaxListValues = 1000000;  // that lists put into the scene, at all places together

// `${...}`: begins with an expression. `$${`, `$$${`, ...: a text that begins so.
[[nodiscard]] bool is_expression(std::string_view text);
[[nodiscard]] bool is_escaped(std::string_view text);

// What all scopes of a scene share.
struct ScopeContext {
  Report& report;
  std::optional<UnitSystem> units{};  // opened by the first quantity
  int chain = 0;                      // parameters that are being evaluated
  std::size_t list_values = 0;        // that lists have put into the scene
  [[nodiscard]] UnitSystem& unit_system();
};

// One value, a list of values, or a list of lists of values.
[[nodiscard]] bool is_value_of_parameter(const Node& node);
inline constexpr const char* kValueOfParameter = "one value (a quantity, a number or a text), or a list of them";

class Scope final : public ExpressionNames {
 public:
  // around: null for a file's own scope.
  Scope(ScopeContext& context, Scope* around) : context_(context), around_(around) {}

  // Declares every key of a map `parameters:`: one value, a list of values, or a list of such lists (a table). An empty
  // value must be given before it is used. path: "parameters".
  void declare(const Node& parameters, const std::string& path);
  // Replaces the value of a parameter of this scope by one without expression; false: there is none of this name.
  bool give(std::string_view name, Node value);

  // Evaluates the scalar if it is an expression, or every one in the node; problems go to the report.
  void substitute(Node& node, const std::string& path);

  // Evaluates the parameters that nothing used, for their problems.
  void settle_rest();

  // Own parameters that nothing used, with the places of their names.
  struct Unused {
    std::string name;
    Mark mark;
  };
  [[nodiscard]] std::vector<Unused> unused() const;
  [[nodiscard]] std::vector<std::string_view> own_names() const;
  // Own parameters that have a value.
  [[nodiscard]] std::vector<ParameterText> own_values() const;

  // ExpressionNames
  [[nodiscard]] bool has(std::string_view name) const override;
  [[nodiscard]] NamedQuantity value(std::string_view name) override;
  [[nodiscard]] NamedQuantity entry(std::string_view name, std::size_t number) override;
  [[nodiscard]] std::string closest_of(std::string_view name) const override;

 private:
  struct Parameter {
    enum class State { untouched, running, done, faulty };
    std::string name;
    std::string path;
    Mark mark;
    Node value;
    State state = State::untouched;
    bool is_used = false;
  };

  // The parameter of this name with its scope; null: none.
  struct Found {
    Parameter* parameter = nullptr;
    Scope* scope = nullptr;
  };
  [[nodiscard]] Found look_up(std::string_view name);
  // Evaluates it. A problem without text: it is reported already.
  [[nodiscard]] std::optional<ValueProblem> settle(Parameter& parameter);
  [[nodiscard]] NamedQuantity quantity_at(const Node& value, std::string_view name);
  void substitute_scalar(Node& node, const std::string& path);
  [[nodiscard]] bool substitute_name(Node& node, std::string_view name, const Mark& place, const std::string& path);

  ScopeContext& context_;
  Scope* around_;
  std::vector<Parameter> parameters_;  // in the order of the file
  std::map<std::string, std::size_t, std::less<>> numbers_;
};

}  // namespace slew::scene
