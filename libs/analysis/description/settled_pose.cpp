// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/settled_pose.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/display.h"
#include "multibody/build/equilibrium.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/model.h"

namespace slew::analysis {
namespace {

constexpr double kMoved = 1e-9;  // rad or m: a coordinate that the search changed

std::vector<double> row_positions_at(const multibody::Model& model, const multibody::State& state) {
  multibody::Workspace ws(model);
  multibody::evaluate(model, state, ws);
  return ws.row_x;
}

}  // namespace

std::string settle_free_joints(const multibody::Model& model, std::size_t ports, std::span<const std::string> held,
                               multibody::State& state) {
  multibody::RestOptions options{.held_rows = static_cast<int>(ports), .holds_floating_joints = true};
  for (const std::string& name : held) {
    const int index = multibody::find_joint(model, name);
    const multibody::JointType type = model.joints[static_cast<std::size_t>(index)].type;
    for (int number = 0; number < multibody::coordinate_count(type); ++number) {
      options.coordinates.push_back({index, number});
    }
  }
  const std::vector<double> before = row_positions_at(model, state);
  const multibody::RestSearch found = multibody::find_rest(model, options, state);
  if (!found.is_stable) {
    return fmt::format(
        "{} has no stable equilibrium, and nothing holds it: {} remain; state its coordinate too, or hold "
        "it by an actuator or a prescribed motion",
        found.joint, quantity_text(std::fabs(found.acceleration), found.turns ? "rad/s2" : "m/s2"));
  }
  // limits are not among the static forces
  const std::vector<double> after = row_positions_at(model, state);
  for (std::size_t k = ports; k < model.rows.size(); ++k) {
    const multibody::Row& row = model.rows[k];
    if (std::fabs(after[k] - before[k]) <= kMoved || !multibody::touches_limit(row.law, after[k])) continue;
    if (row.kind != multibody::RowKind::joint) continue;
    const multibody::Joint& joint = model.joints[static_cast<std::size_t>(row.element)];
    return fmt::format(
        "{} would hang at {}, beyond its limit; limits are not part of the static forces; state its "
        "coordinate too",
        multibody::row_name(model, static_cast<int>(k)),
        quantity_text(after[k], multibody::is_angle(joint.type, row.number) ? "rad" : "m"));
  }
  return {};
}

}  // namespace slew::analysis
