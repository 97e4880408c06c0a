// SPDX-License-Identifier: Apache-2.0
#include "urdf/starts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "urdf/placement.h"

namespace slew::urdf {
namespace {

// rad, distance from half a turn within which rounding may change the side of a start
constexpr double kHalfTurn = 1e-9;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// q = a q_leader + b
struct Follower {
  int leader = 0;  // joint
  double a = 1, b = 0;
};

// follows chains of <mimic> to an independent joint
Follower follower_of(const Robot& robot, int joint) {
  Follower follower{.leader = joint};
  while (const auto& mimic = robot.joints[at(follower.leader)].mimic) {
    follower.b += follower.a * mimic->offset;
    follower.a *= mimic->multiplier;
    follower.leader = mimic->leader;
  }
  return follower;
}

struct Interval {
  double low = -kUnlimited, high = kUnlimited;
  [[nodiscard]] bool holds(double q) const { return low <= q && q <= high; }
};

// positions of the leader at which the follower is within its limits
Interval allowed(const Joint& joint, const Follower& follower) {
  if (!joint.is_limited) return {};
  if (follower.a == 0) {
    return joint.lower <= follower.b && follower.b <= joint.upper ? Interval{} : Interval{kUnlimited, -kUnlimited};
  }
  const double one = (joint.lower - follower.b) / follower.a, other = (joint.upper - follower.b) / follower.a;
  return {std::min(one, other), std::max(one, other)};
}

bool is_half_turn(const Joint& joint, double q) {
  return joint.is_angle() && std::abs(std::remainder(q, 2 * M_PI)) > M_PI - kHalfTurn;
}

class Starts {
 public:
  explicit Starts(Robot& robot) : robot_(robot), allowed_(robot.joints.size()) {
    for (std::size_t j = 0; j < robot.joints.size(); ++j) followers_.push_back(follower_of(robot, static_cast<int>(j)));
  }

  void find() {
    // independent joints are not changed
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      if (!robot_.joints[j].mimic) allowed_[j] = allowed(robot_.joints[j], followers_[j]);
    }
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      if (robot_.joints[j].mimic) restrict_leader(j);
    }
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      const Follower& follower = followers_[j];
      put_start(robot_.joints[j], follower.a * start_of(at(follower.leader)) + follower.b);
      if (follower.a == 0) hold(robot_.joints[j]);
    }
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      auto& mimic = robot_.joints[j].mimic;
      const auto& [leader, a, b] = followers_[j];
      if (mimic) *mimic = {robot_.joints[at(leader)].name, leader, a, b, mimic->line};
    }
  }

 private:
  void restrict_leader(std::size_t index) {
    Joint& joint = robot_.joints[index];
    Interval& leader = allowed_[at(followers_[index].leader)];
    const Interval own = allowed(joint, followers_[index]);
    const Interval both{std::max(leader.low, own.low), std::min(leader.high, own.high)};
    if (both.low <= both.high) {
      leader = both;
      return;
    }
    robot_.notes.push_back(
        {joint.line, fmt::format("joint '{}': where '{}' may be it is never within its limits {} and "
                                 "{}, which are not taken over",
                                 joint.name, joint.mimic->joint, joint.lower, joint.upper)});
    joint.is_limited = false;
  }

  [[nodiscard]] double start_of(std::size_t leader) const {
    const Interval& range = allowed_[leader];
    if (range.holds(0)) return 0;
    const double middle = (range.low + range.high) / 2;
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      const Follower& follower = followers_[j];
      if (at(follower.leader) != leader || !is_half_turn(robot_.joints[j], follower.a * middle + follower.b)) continue;
      const double rest = middle - 2 * M_PI * std::round(middle / (2 * M_PI));
      return middle - std::copysign((range.high - range.low) / 4, rest);
    }
    return middle;
  }

  void hold(Joint& joint) {
    robot_.notes.push_back({joint.mimic->line, fmt::format("joint '{}' follows '{}' with the multiplier 0: it is fixed",
                                                           joint.name, joint.mimic->joint)});
    fix(joint);
  }

  static void put_start(Joint& joint, double q) {
    if (joint.is_angle()) joint.turns = 2 * M_PI * std::round(q / (2 * M_PI));
    joint.start = q - joint.turns;
    joint.lower -= joint.turns;
    joint.upper -= joint.turns;
  }

  Robot& robot_;
  std::vector<Follower> followers_;
  std::vector<Interval> allowed_;
};

}  // namespace

void find_starts(Robot& robot) {
  Starts(robot).find();
}

}  // namespace slew::urdf
