// SPDX-License-Identifier: Apache-2.0
// The parameters of a scene: every numeric field and every choice of every element and section, with its range and
// whether it may be changed while the session runs. A choice is changed by name; its value, in ticks and in programs,
// is the name's place among the choices, from 0.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/field.h"
#include "core/status.h"
#include "core/time.h"
#include "scene/live_course.h"
#include "scene/scene.h"
#include "scene/units.h"

namespace slew::scene {

struct ParameterInfo {
  std::string path;  // "Bag.mass"; for a triple "Bag.position.x"
  double value = 0;  // SI, value of the scene
  Dimension dimension = Dimension::none;
  Range range;
  Change change = Change::restart;
  std::string obstacle{};  // reason why a generally live parameter has no effect in this scene and is not live
  double ramp = 0;         // s, over which a live change is spread by default
  bool is_integer = false;
  std::span<const std::string_view> choices{};  // names by value; empty: a number

  [[nodiscard]] bool is_choice() const noexcept { return !choices.empty(); }
  // Name of the choice with this number; empty if there is none.
  [[nodiscard]] std::string_view choice_of(double number) const noexcept;
  std::string_view doc;
};

// Length of the mechanics' sub-steps [s].
[[nodiscard]] double mechanics_substep(const SessionDef& session, const multibody::MechanicsDef& mechanics);

// All parameters of a scene in canonical order. Triples give three, .x .y .z; texts and tables none.
[[nodiscard]] std::vector<ParameterInfo> parameters(const Scene& scene);

// A checked change: path, SI value and the time over which it is spread.
struct Assignment {
  Status status;  // reason of a refusal; the other members are then undefined
  std::string path;
  double value = 0;
  SimDuration over;
};

// Values beside which a change is judged where fields must fit: those of the scene, or those of a session, which has
// refusal_of_course() for it.
enum class Beside { scene, session };

// Checks changes of live parameters. Built once for a session; a check does not read files.
class ParameterDirectory {
 public:
  explicit ParameterDirectory(const Scene& scene);

  [[nodiscard]] const std::vector<ParameterInfo>& all() const noexcept { return parameters_; }
  // Null if the parameter does not exist.
  [[nodiscard]] const ParameterInfo* find(std::string_view path) const;

  // "Bag.mass=1500kg", "Cyl_Lift.coupling=linear": refused if unknown (with a suggestion), not live, of a wrong
  // dimension, out of range, none of the choices, or if the loader would refuse the machine with this value. Also
  // refused: a mass, spring or damper that is too fast for the mechanics' explicit integrator
  // (multibody/formulations/element_speeds.h; at the start). The last two beside the other values of the scene only.
  [[nodiscard]] Assignment parse_assignment(std::string_view text, std::optional<SimDuration> over = {},
                                            Beside beside = Beside::scene);
  // The same for a value in SI, as received over the wire. over: the requested time; default: the parameter's own. A
  // choice changes at once, or is refused.
  [[nodiscard]] Assignment check(std::string_view path, double value, std::optional<SimDuration> over = {},
                                 Beside beside = Beside::scene) const;
  // Why a session refuses this value because of a rule between fields, which needs the present values of the others and
  // the changes that follow; empty: it takes it. Of hydraulic components with all changes (find_broken_rule()), of the
  // mechanism with those under way and those that wait for the same step: it is looked at where one of them ends, at
  // most eight times, since that takes a part of a step's time.
  [[nodiscard]] std::string refusal_of_course(std::string_view path, double value,
                                              std::span<const std::pair<std::string, double>> present,
                                              std::span<const LiveChange> changes) const;

 private:
  [[nodiscard]] Assignment parse_choice(const ParameterInfo& parameter, std::string_view name,
                                        std::optional<SimDuration> over, Beside beside) const;

  [[nodiscard]] std::string reason_of_no_parameter(const std::string& name) const;
  [[nodiscard]] std::string obstacle_of_level(const ParameterInfo& parameter, double value) const;
  using Values = std::span<const std::pair<std::string, double>>;
  [[nodiscard]] std::string obstacle_of_machine(Values values) const;
  [[nodiscard]] std::string obstacle_of_speed(Values values) const;
  [[nodiscard]] bool is_of_machine(std::string_view path) const;
  [[nodiscard]] bool may_be_faster(const ParameterInfo& parameter, double from, double to) const;
  [[nodiscard]] std::string refusal_of_machine(const ParameterInfo& parameter, double value, Values present,
                                               std::span<const LiveChange> changes) const;

  SessionDef session_;
  std::vector<PortDef> ports_;
  std::shared_ptr<const hydraulics::HydraulicsDef> circuit_;
  std::shared_ptr<const multibody::MechanicsDef> mechanics_;        // null: no bodies, or no integration in sub-steps
  std::shared_ptr<const multibody::MechanicsDef> whole_mechanics_;  // null: the machine cannot be checked
  std::vector<ParameterInfo> parameters_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::map<std::string, std::string, std::less<>> not_numeric_;  // type by path of fields that are no parameters
  UnitSystem units_;
};

}  // namespace slew::scene
