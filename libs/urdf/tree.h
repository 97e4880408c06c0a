// SPDX-License-Identifier: Apache-2.0
// The links of a robot as a tree, and the joints that follow others.
#pragma once

#include <functional>
#include <string>

#include "urdf/robot.h"

namespace slew::urdf {

// Receives a line, the problem, and the expected value.
using ReportProblem = std::function<void(int line, std::string what, std::string expected)>;

// Fills root, parent_joint and order. Reports a link with two parents, no root or several, and links in a circle.
void find_tree(Robot& robot, const ReportProblem& report_problem);

// Fills the leader of every <mimic>. Reports a missing leader and joints that follow themselves. A leader without a
// coordinate gives a note, and its follower becomes independent.
void find_leaders(Robot& robot, const ReportProblem& report_problem);

}  // namespace slew::urdf
