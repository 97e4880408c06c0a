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
#include <vector>

#include "core/field.h"
#include "core/status.h"
#include "core/time.h"
#include "scene/scene.h"
#include "scene/units.h"

namespace slew::scene {

struct ParameterInfo {
  std::string path;  // "Bag.mass"; of a triple "Bag.position.x"
  double value = 0;  // SI, as the scene has it
  Dimension dimension = Dimension::none;
  Range range;
  Change change = Change::restart;
  std::string obstacle{};  // why a parameter that is live elsewhere would change nothing in this scene, and is not
  double ramp = 0;         // s, over which a live change is spread by default
  bool is_integer = false;
  std::span<const std::string_view> choices{};  // names by value; empty: a number

  [[nodiscard]] bool is_choice() const noexcept { return !choices.empty(); }
  // Name of a choice with this number; empty when it has none.
  [[nodiscard]] std::string_view choice_of(double number) const noexcept;
  std::string_view doc;
};

// Length of the mechanics' sub-steps [s].
[[nodiscard]] double mechanics_substep(const SessionDef& session, const multibody::MechanicsDef& mechanics);

// All parameters of a scene in canonical order. Triples give three, .x .y .z; texts and tables none.
[[nodiscard]] std::vector<ParameterInfo> parameters(const Scene& scene);

// A change that may be applied: path, SI value and the time over which it is spread.
struct Assignment {
  Status status;  // why it was refused; the other members then mean nothing
  std::string path;
  double value = 0;
  SimDuration over;
};

// Checks changes of live parameters. Built once for a session; a check does not read files.
class ParameterDirectory {
 public:
  explicit ParameterDirectory(const Scene& scene);

  [[nodiscard]] const std::vector<ParameterInfo>& all() const noexcept { return parameters_; }
  // Null when there is none.
  [[nodiscard]] const ParameterInfo* find(std::string_view path) const;

  // "Bag.mass=1500kg", "Cyl_Lift.coupling=linear": refused when unknown (with a suggestion), not live, of a wrong
  // dimension, out of range, none of the choices, a value with which the loader would refuse the machine, or a mass,
  // spring or damper with which the mechanics' explicit integrator could not follow what it moves
  // (multibody/forces/element_speeds.h; at the start, the rest as the scene has it).
  [[nodiscard]] Assignment parse_assignment(std::string_view text, std::optional<SimDuration> over = {});
  // The same for a value that is already in SI, as it comes over the wire. over: the time that is asked for; without
  // one it is the parameter's own. A choice is made at once, or refused.
  [[nodiscard]] Assignment check(std::string_view path, double value, std::optional<SimDuration> over = {}) const;

 private:
  [[nodiscard]] Assignment parse_choice(const ParameterInfo& parameter, std::string_view name,
                                        std::optional<SimDuration> over) const;

  [[nodiscard]] std::string obstacle_of_machine(const ParameterInfo& parameter, double value) const;
  [[nodiscard]] std::string obstacle_of_speed(const ParameterInfo& parameter, double value) const;

  SessionDef session_;
  std::shared_ptr<const multibody::MechanicsDef> mechanics_;  // null: no bodies, or nobody integrates in sub-steps
  std::shared_ptr<const multibody::MechanicsDef> whole_mechanics_;  // null: it cannot be judged
  std::vector<ParameterInfo> parameters_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::map<std::string, std::string, std::less<>> not_numeric_;  // path of a field that is no parameter: its type
  UnitSystem units_;
};

}  // namespace slew::scene
