// SPDX-License-Identifier: Apache-2.0
#include "urdf/tree.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"

namespace slew::urdf {
namespace {

void find_parents(Robot& robot, const ReportProblem& report_problem) {
  robot.parent_joint.assign(robot.links.size(), -1);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    int& parent = robot.parent_joint[at(joint.child)];
    if (parent >= 0) {
      report_problem(joint.line,
                     fmt::format("link '{}' is the child of joint '{}' already", robot.links[at(joint.child)].name,
                                 robot.joints[at(parent)].name),
                     "a tree: loops are closed in the scene afterwards");
    }
    parent = static_cast<int>(j);
  }
}

// breadth first; children in the order of the file
void find_order(Robot& robot) {
  robot.order = {robot.root};
  for (std::size_t next = 0; next < robot.order.size(); ++next) {
    for (const Joint& joint : robot.joints) {
      if (joint.parent == robot.order[next]) robot.order.push_back(joint.child);
    }
  }
}

}  // namespace

void find_tree(Robot& robot, const ReportProblem& report_problem) {
  int problem_count = 0;
  const ReportProblem counted = [&](int line, std::string what, std::string expected) {
    ++problem_count;
    report_problem(line, std::move(what), std::move(expected));
  };
  find_parents(robot, counted);
  robot.root = -1;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.parent_joint[i] >= 0) continue;
    if (robot.root < 0) {
      robot.root = static_cast<int>(i);
    } else {
      counted(robot.links[i].line,
              fmt::format("link '{}' has no parent, and '{}' has none either", robot.links[i].name,
                          robot.links[at(robot.root)].name),
              "one root");
    }
  }
  if (robot.root < 0) counted(robot.links[0].line, "every link has a parent", "one link without a parent");
  if (problem_count > 0) return;
  find_order(robot);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (std::find(robot.order.begin(), robot.order.end(), static_cast<int>(i)) != robot.order.end()) continue;
    counted(robot.links[i].line, fmt::format("link '{}' is its own ancestor", robot.links[i].name), "a tree");
    return;
  }
}

namespace {

bool follows_itself(const Robot& robot, const Joint& joint) {
  std::size_t steps = 0;
  for (const Joint* next = &joint; next->mimic && next->mimic->leader >= 0; ++steps) {
    if (steps > robot.joints.size()) return true;
    next = &robot.joints[at(next->mimic->leader)];
  }
  return false;
}

}  // namespace

void find_leaders(Robot& robot, const ReportProblem& report_problem) {
  for (Joint& joint : robot.joints) {
    if (!joint.mimic) continue;
    Mimic& mimic = *joint.mimic;
    const auto found = std::find_if(robot.joints.begin(), robot.joints.end(),
                                    [&mimic](const Joint& other) { return other.name == mimic.joint; });
    if (found == robot.joints.end()) {
      report_problem(mimic.line,
                     fmt::format("joint '{}': follows the joint '{}', which is not there", joint.name, mimic.joint),
                     "the name of a joint");
    } else if (!found->has_coordinate()) {
      robot.notes.push_back(
          {mimic.line, fmt::format("joint '{}': <mimic> of '{}', which has no coordinate, is not taken "
                                   "over",
                                   joint.name, mimic.joint)});
      joint.mimic.reset();
    } else {
      mimic.leader = static_cast<int>(found - robot.joints.begin());
    }
  }
  for (const Joint& joint : robot.joints) {
    if (!follows_itself(robot, joint)) continue;
    report_problem(joint.mimic->line, fmt::format("joint '{}': follows itself", joint.name),
                   "a joint that moves by itself at the end of every chain of <mimic>");
  }
}

}  // namespace slew::urdf
