// SPDX-License-Identifier: Apache-2.0
#include "multibody/joints/joint_gauge.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "core/index.h"
#include "multibody/constraints/constraint.h"

namespace slew::multibody {
namespace {

// a joint with coordinates, between the links of its bodies
Constraint closed_joint(const Model& model, int index) {
  Constraint constraint = constraint_between(model, index);
  constraint.rows = rows_of(model.joints[at(index)].type, math::Mat3::identity(), math::Vec3());
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    if (model.drives[k].joint != index) continue;
    constraint.rows.push_back(coordinate_row(model.joints[at(index)].type, model.drives[k].number));
    constraint.rows.back().drive = static_cast<int>(k);
  }
  return constraint;
}

// NaN stays
bool is_larger(double value, double largest) noexcept {
  return !std::isnan(largest) && !(value <= largest);
}

}  // namespace

std::vector<Constraint> joint_constraints(const Model& model) {
  std::vector<Constraint> constraints;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    // not a joint of the scene; its frames move apart as the body bends
    if (joint.type == JointType::node) continue;
    if (joint.cut >= 0) {
      const Cut& cut = model.cuts[at(joint.cut)];
      Constraint constraint = cut;
      constraint.rows.insert(constraint.rows.end(), cut.redundant.begin(), cut.redundant.end());
      constraints.push_back(std::move(constraint));
    } else if (joint.link > 0) {
      constraints.push_back(closed_joint(model, static_cast<int>(i)));
    }
  }
  return constraints;
}

JointGauge::JointGauge(const Model& model) : constraints_(joint_constraints(model)) {}

JointGap JointGauge::measure(const Workspace& ws) const noexcept {
  JointGap largest;
  std::array<RowValue, kMaxJointRows> values;
  for (const Constraint& constraint : constraints_) {
    const std::size_t rows = constraint.rows.size();
    evaluate(constraint, ws.motion[at(constraint.link1)], ws.motion[at(constraint.link2)], ws.drives,
             {values.data(), rows});
    for (std::size_t k = 0; k < rows; ++k) {
      if (is_larger(std::fabs(values[k].g), largest.position)) {
        largest.position = std::fabs(values[k].g);
        largest.joint = constraint.joint;
      }
      if (is_larger(std::fabs(values[k].rate), largest.rate)) largest.rate = std::fabs(values[k].rate);
    }
  }
  return largest;
}

}  // namespace slew::multibody
