// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "core/suggestion.h"
#include "scene/device_readers.h"

namespace slew::scene {
namespace {

using Platform = devices::MotionPlatformDef;

constexpr Range kPlatformStepRange{.min = 0.0005, .max = 0.1, .min_is_open = false, .max_is_open = false};
constexpr double kGravityShare = 0.05;  // of standard gravity, that the scene's may differ: 0.5 m/s2 of heave at rest

void add_washout_fields(std::vector<Field>& fields) {
  using Washout = devices::WashoutDef;
  const std::span<const Field> rows = devices::washout_fields();
  const auto add = [&]<auto Member>(std::string_view key) {
    fields.push_back(lent_as_is<&MotionPlatformDef::platform, &Platform::washout, Member>(rows, key));
  };
  add.operator()<&Washout::force_scale>("force_scale");
  add.operator()<&Washout::rate_scale>("rate_scale");
  add.operator()<&Washout::max_acceleration>("max_acceleration");
  add.operator()<&Washout::max_rate>("max_rate");
  add.operator()<&Washout::translation_frequency>("translation_frequency");
  add.operator()<&Washout::translation_damping>("translation_damping");
  add.operator()<&Washout::return_frequency>("return_frequency");
  add.operator()<&Washout::tilt_frequency>("tilt_frequency");
  add.operator()<&Washout::tilt_damping>("tilt_damping");
  add.operator()<&Washout::tilt_rate>("tilt_rate");
  add.operator()<&Washout::max_tilt>("max_tilt");
  add.operator()<&Washout::rotation_frequency>("rotation_frequency");
  add.operator()<&Washout::rotation_damping>("rotation_damping");
}

void add_hexapod_fields(std::vector<Field>& fields) {
  using Hexapod = devices::HexapodDef;
  const std::span<const Field> rows = devices::hexapod_fields();
  const auto add = [&]<auto Member>(std::string_view key) {
    fields.push_back(lent_as_is<&MotionPlatformDef::platform, &Platform::hexapod, Member>(rows, key));
  };
  add.operator()<&Hexapod::base_joints>("base_joints");
  add.operator()<&Hexapod::platform_joints>("platform_joints");
  add.operator()<&Hexapod::neutral_height>("neutral_height");
  add.operator()<&Hexapod::shortest_leg>("shortest_leg");
  add.operator()<&Hexapod::longest_leg>("longest_leg");
}

void add_limit_fields(std::vector<Field>& fields) {
  const std::span<const Field> rows = devices::motion_platform_fields();
  const auto add = [&]<auto Member>(std::string_view key) {
    fields.push_back(lent_as_is<&MotionPlatformDef::platform, Member>(rows, key));
  };
  add.operator()<&Platform::position_limit>("position_limit");
  add.operator()<&Platform::angle_limit>("angle_limit");
  add.operator()<&Platform::soft_from>("soft_from");
  add.operator()<&Platform::park_height>("park_height");
  add.operator()<&Platform::rise_time>("rise_time");
  add.operator()<&Platform::ramp_time>("ramp_time");
  add.operator()<&Platform::freeze_after>("freeze_after");
  add.operator()<&Platform::hold_time>("hold_time");
}

std::vector<Field> make_motion_platform_fields() {
  using devices::SeatDef;
  const std::span<const Field> seat = devices::seat_fields();
  std::vector<Field> fields = {
      field<&MotionPlatformDef::body>(
          "body",
          {.presence = Presence::required, .reference = "body", .doc = "body that the driver's seat is fixed to"}),
      lent_as_is<&MotionPlatformDef::seat, &SeatDef::point>(seat, "point"),
      lent_as_is<&MotionPlatformDef::seat, &SeatDef::forward>(seat, "forward"),
      lent_as_is<&MotionPlatformDef::seat, &SeatDef::up>(seat, "up"),
      field<&MotionPlatformDef::conditions>("conditions",
                                            {.doc = "conditions on variables that must hold, as 'Input_Enable.value > "
                                                    "0.5'; otherwise the platform goes back to neutral and parks"}),
      field<&MotionPlatformDef::send>(
          "send", {.presence = Presence::required, .doc = "address and port of the platform, as 127.0.0.1:6000"}),
      field<&MotionPlatformDef::every>("every",
                                       {.dimension = Dimension::time,
                                        .range = kPlatformStepRange,
                                        .doc = "step of the washout and time between two packets, by the wall clock"}),
  };
  add_layout_fields<MotionPlatformDef>(fields);
  add_hexapod_fields(fields);
  add_limit_fields(fields);
  add_washout_fields(fields);
  return fields;
}

}  // namespace

std::span<const Field> motion_platform_fields() {
  static const std::vector<Field> fields = make_motion_platform_fields();
  return fields;
}

const devices::PlatformQuantity* MotionPlatformDef::own_quantity(const devices::LayoutFieldDef& field) const {
  const std::string_view variable = field.variable;
  if (!variable.starts_with(name + ".")) return nullptr;
  return devices::find_platform_quantity(variable.substr(name.size() + 1));
}

std::vector<std::string> MotionPlatformDef::body_variables() const {
  std::vector<std::string> names;
  for (const char* quantity :
       {"velocity.x", "velocity.y", "velocity.z", "orientation.w", "orientation.x", "orientation.y", "orientation.z",
        "angular_velocity.x", "angular_velocity.y", "angular_velocity.z"})
    names.push_back(body + "." + quantity);
  return names;
}

void read_platform(MotionPlatformDef& def, Problems& problems) {
  check_address(def.name + ".send", def.send, problems);
  check_conditions(def.name, def.conditions, problems);
  validate(def.name, def.seat, problems);
  def.platform.name = def.name;
  validate(def.platform, problems);
  if (def.platform.freeze_after < 2 * def.every) {
    problems.push_back({def.name + ".freeze_after",
                        fmt::format("{:g} s are less than two steps of the platform", def.platform.freeze_after),
                        fmt::format("{:g} s or more, or a shorter every", 2 * def.every), ""});
  }
  const auto layout = read_layout(def.name, def.layout, problems);
  if (!layout) return;
  check_sent_fields(def.name, *layout, problems);
  std::vector<std::string_view> names;
  for (const devices::PlatformQuantity& quantity : devices::platform_quantities()) names.push_back(quantity.name);
  bool moves_something = false;
  for (const devices::PlacedField& placed : layout->fields) {
    const std::string& variable = placed.def.variable;
    const devices::PlatformQuantity* const own = def.own_quantity(placed.def);
    moves_something = moves_something || own != nullptr;
    if (own != nullptr && !is_same_dimension(placed.def.unit, std::string(own->unit))) {
      problems.push_back({fmt::format("{}.{}.unit", def.name, placed.def.name),
                          fmt::format("'{}' is in {}, not in {}", variable, own->unit, placed.def.unit), "", ""});
    }
    if (!variable.starts_with(def.name + ".") || own != nullptr) continue;
    const std::string quantity = variable.substr(def.name.size() + 1);
    problems.push_back(
        {fmt::format("{}.{}.variable", def.name, placed.def.name),
         fmt::format("a motion platform has no quantity '{}'", quantity),
         "leg_1 to leg_6, surge, sway, heave, roll, pitch, yaw, or another of docs/howto/motion-platform.md",
         closest(quantity, names)});
  }
  if (!moves_something) {
    problems.push_back({def.name, "no field of the packet has a quantity of the platform",
                        fmt::format("fields with variables {}.leg_1 to {}.leg_6", def.name, def.name), ""});
  }
}

void check_platform(const MotionPlatformDef& def, const Triple& gravity, double publish_interval, Problems& problems) {
  const double g = std::hypot(gravity[0], gravity[1], gravity[2]);
  if (std::abs(g - devices::kStandardGravity) > kGravityShare * devices::kStandardGravity) {
    problems.push_back({def.name + ".body",
                        fmt::format("mechanics.gravity is {:.4g} m/s2, and the platform stands in {:.4g} m/s2: a seat "
                                    "at rest would be felt as a fall",
                                    g, devices::kStandardGravity),
                        "mechanics.gravity within 5 % of that, or no motion_platform", ""});
  }
  if (publish_interval * 2 > def.platform.freeze_after) {
    problems.push_back({def.name + ".freeze_after",
                        fmt::format("variables are published every {:g} s, and {:g} s are less than twice as much",
                                    publish_interval, def.platform.freeze_after),
                        "a smaller recording.every or a longer freeze_after", ""});
  }
}

}  // namespace slew::scene
