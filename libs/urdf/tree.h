// The links of a robot as a tree, and the joints that follow others.
#pragma once

#include <functional>
#include <string>

#include "urdf/robot.h"

namespace slew::urdf {

// Takes a line, what is wrong, and what is expected.
using ReportProblem = std::function<void(int line, std::string what, std::string expected)>;

// Fills root, parent_joint and order. Complains about a link with two parents, about none or several roots, and about
// links in a circle.
void find_tree(Robot& robot, const ReportProblem& report_problem);

// Fills the leader of every <mimic>. Complains about one that is not there and about joints that follow themselves; a
// leader without a coordinate is noted, and its follower moves by itself.
void find_leaders(Robot& robot, const ReportProblem& report_problem);

}  // namespace slew::urdf
