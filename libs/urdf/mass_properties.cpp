// SPDX-License-Identifier: Apache-2.0
#include "urdf/mass_properties.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "multibody/model/body_inertia.h"

namespace slew::urdf {

using math::Mat3;
using math::Vec3;

namespace {

// p1 <= p2 <= p3
struct Principal {
  double p1 = 0, p2 = 0, p3 = 0;
  [[nodiscard]] double missed_share() const { return p3 > 0 ? std::max(p3 - p1 - p2, -p1) / p3 : 1; }
};

Principal principal_of(const Mat3& tensor) {
  const auto [a, b, c] = math::symmetric_eigenvalues(tensor);
  return {a, b, c};
}

bool is_sound(double mass, const Mat3& tensor) {
  return mass > 0 && multibody::is_inertia(tensor);
}

bool is_sound(const Inertial& inertial) {
  return is_sound(inertial.mass, tensor_of(inertial));
}

void put_tensor(const Mat3& I, Inertial& inertial) {
  inertial.moments = {I(0, 0), I(1, 1), I(2, 2)};
  inertial.products = {I(0, 1), I(0, 2), I(1, 2)};
}

// direction of the largest moment: (I - p1)(I - p2) times any vector
Vec3 axis_of_largest(const Mat3& I, const Principal& p) {
  const Mat3 left = (I - Mat3::diagonal(p.p1, p.p1, p.p1)) * (I - Mat3::diagonal(p.p2, p.p2, p.p2));
  Vec3 longest = left.c[0];
  for (const Vec3& column : left.c) {
    if (dot(column, column) > dot(longest, longest)) longest = column;
  }
  const double length = norm(longest);
  return length > 0 ? longest * (1 / length) : Vec3();
}

// (2)
void raise_small_moments(Inertial& inertial) {
  const Mat3 I = tensor_of(inertial);
  const Principal p = principal_of(I);
  const double raise = std::max((p.p3 - p.p1 - p.p2) / 2, -p.p1);
  const Vec3 axis = axis_of_largest(I, p);
  put_tensor(I + (Mat3::identity() - outer(axis, axis)) * raise, inertial);
}

class Settling {
 public:
  Settling(Robot& robot, RootMount mount, const Repairs& repairs, std::vector<Note>& changes,
           const ReportProblem& report_problem)
      : robot_(robot), mount_(mount), repairs_(repairs), changes_(changes), report_problem_(report_problem) {}

  void run() {
    const std::vector<Group> groups = find_groups(robot_);
    for (const int head : robot_.order) {
      if (groups[at(head)].head != head) continue;
      std::vector<int> members;
      for (const int link : robot_.order) {
        if (groups[at(link)].head == head && robot_.links[at(link)].inertial) members.push_back(link);
      }
      settle_group(groups, head, members);
    }
    fix_what_weighs_nothing();
    fix_what_turns_freely();
    rebind_followers();
  }

 private:
  [[nodiscard]] std::string name(int link) const { return robot_.links[at(link)].name; }

  void settle_group(const std::vector<Group>& groups, int head, const std::vector<int>& members) {
    const auto is_bad = [this](int link) { return !is_sound(*robot_.links[at(link)].inertial); };
    if (std::none_of(members.begin(), members.end(), is_bad)) return;
    if (mount_ == RootMount::fixed && head == robot_.root) {
      for (const int link : members) {
        if (is_bad(link)) leave_to_ground(link);
      }
      return;
    }
    if (members.size() > 1 && take_together(groups, members)) return;
    for (const int link : members) {
      if (is_bad(link)) repair(link);
    }
  }

  void leave_to_ground(int link) {
    Link& part = robot_.links[at(link)];
    robot_.notes.push_back(
        {part.inertial->line, fmt::format("link '{}': no body has its mass properties; it is part of "
                                          "Ground, where they have no effect",
                                          part.name)});
    part.inertial.reset();
  }

  // the sum of the group in its heaviest link
  bool take_together(const std::vector<Group>& groups, const std::vector<int>& members) {
    const auto weighs_less = [this](int a, int b) {
      return robot_.links[at(a)].inertial->mass < robot_.links[at(b)].inertial->mass;
    };
    const int carrier = *std::max_element(members.begin(), members.end(), weighs_less);
    Lump all;
    for (const int link : members) {
      add_lump(all, lump_of(*robot_.links[at(link)].inertial),
               inverse(groups[at(carrier)].pose) * groups[at(link)].pose);
    }
    if (!(all.mass > 0) || !is_sound(all.mass, central_inertia(all))) return false;
    Inertial sum;
    sum.mass = all.mass;
    sum.line = robot_.links[at(carrier)].inertial->line;
    sum.origin.xyz = (all.h * (1 / all.mass)).array();
    put_tensor(central_inertia(all), sum);
    std::vector<std::string> names;
    for (const int link : members) {
      names.push_back(name(link));
      robot_.links[at(link)].inertial.reset();
    }
    robot_.links[at(carrier)].inertial = sum;
    robot_.notes.push_back({sum.line, fmt::format("links {}: fixed to each other, and no body has the mass properties "
                                                  "of each alone; their sum is that of '{}'",
                                                  fmt::join(names, ", "), name(carrier))});
    return true;
  }

  void repair(int link) {
    Link& part = robot_.links[at(link)];
    Inertial& inertial = *part.inertial;
    const std::string what = fault_of(inertial);
    const double share = principal_of(tensor_of(inertial)).missed_share();
    if (inertial.mass > 0 && share > repairs_.share && repairs_.is_repairing) {
      report_problem_(inertial.line, fmt::format("link '{}': {}", part.name, what),
                      fmt::format("moments of a real body; --repair-share is {}", repairs_.share));
      return;
    }
    if (!repairs_.is_repairing) {
      report_problem_(inertial.line, fmt::format("link '{}': {}", part.name, what),
                      inertial.mass > 0
                          ? "no principal moment below 0 or larger than the sum of the other two; --repair "
                            "raises those that are too small"
                          : "a mass; --repair leaves the inertia out");
      return;
    }
    if (inertial.mass > 0) {
      raise_small_moments(inertial);
      const Principal p = principal_of(tensor_of(inertial));
      changes_.push_back({inertial.line, fmt::format("link '{}': {}; they are now {:.6g}, {:.6g}, {:.6g} kg m2",
                                                     part.name, what, p.p1, p.p2, p.p3)});
    } else {
      changes_.push_back({inertial.line, fmt::format("link '{}': {}; the inertia is left out", part.name, what)});
      part.inertial.reset();
    }
  }

  static std::string fault_of(const Inertial& inertial) {
    if (!(inertial.mass > 0)) return "the mass is 0 and the inertia is not";
    const Principal p = principal_of(tensor_of(inertial));
    return fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m2 {} by {:.3g} % of the largest", p.p1, p.p2, p.p3,
                       p.p1 < 0 && -p.p1 > p.p3 - p.p1 - p.p2 ? "are negative" : "break the triangle rule",
                       100 * p.missed_share());
  }

  // groups without mass, from the tips inwards, so that the load of a fixed joint is known
  void fix_what_weighs_nothing() {
    const std::vector<Group> groups = find_groups(robot_);
    std::vector<char> has_mass(robot_.links.size(), 0), carries_mass(robot_.links.size(), 0);
    for (const int link : robot_.order) {
      if (robot_.links[at(link)].inertial) has_mass[at(groups[at(link)].head)] = 1;
    }
    for (auto link = robot_.order.rbegin(); link != robot_.order.rend(); ++link) {
      const int head = groups[at(*link)].head;
      if (head != *link) continue;
      const int joint = robot_.parent_joint[at(head)];
      if (joint < 0) continue;
      if (has_mass[at(head)] != 0 || carries_mass[at(head)] != 0) {
        carries_mass[at(groups[at(robot_.joints[at(joint)].parent)].head)] = 1;
      }
    }
    for (const int head : robot_.order) {
      if (groups[at(head)].head != head || has_mass[at(head)] != 0) continue;
      if (head == robot_.root) {
        if (mount_ == RootMount::floating) refuse_root(head);
        continue;
      }
      fix_massless(head, carries_mass[at(head)] != 0);
    }
  }

  void refuse_root(int link) {
    report_problem_(robot_.links[at(link)].line, fmt::format("link '{}' floats and has no mass", name(link)),
                    "an <inertial> in it or in a link fixed to it");
  }

  void fix_massless(int link, bool carries_mass) {
    Joint& joint = robot_.joints[at(robot_.parent_joint[at(link)])];
    if (!carries_mass) {
      robot_.notes.push_back(
          {joint.line, fmt::format("joint '{}' moves '{}', which has no mass and carries none: it is "
                                   "fixed",
                                   joint.name, name(link))});
      fix(joint);
    } else if (repairs_.is_merging) {
      changes_.push_back(
          {joint.line, fmt::format("joint '{}' is fixed: '{}' moves and has no mass", joint.name, name(link))});
      fix(joint);
    } else {
      report_problem_(
          robot_.links[at(link)].line, fmt::format("link '{}' moves and has no mass", name(link)),
          fmt::format("an <inertial> in it or in a link fixed to it; --merge fixes its joint '{}'", joint.name));
    }
  }

  // a point mass on its own axis
  void fix_what_turns_freely() {
    const std::vector<double> resistance = resistance_of_joints(robot_);
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      Joint& joint = robot_.joints[j];
      if (!joint.has_coordinate() || resistance[j] > 0) continue;
      const std::string what = fmt::format("what hangs on joint '{}' has no inertia about its axis", joint.name);
      if (repairs_.is_merging) {
        changes_.push_back({joint.line, what + ": it is fixed"});
        fix(joint);
      } else if (carries_mass(joint.child)) {
        report_problem_(joint.line, what, "an inertia about the axis; --merge fixes the joint");
      }
    }
  }

  // links without mass are reported already
  [[nodiscard]] bool carries_mass(int link) const {
    return std::any_of(robot_.order.begin(), robot_.order.end(), [&](int other) {
      if (!robot_.links[at(other)].inertial) return false;
      for (int above = other; above != robot_.root; above = robot_.joints[at(robot_.parent_joint[at(above)])].parent) {
        if (above == link) return true;
      }
      return false;
    });
  }

  // if the leader of others is fixed, the first of them leads
  void rebind_followers() {
    std::vector<std::pair<int, Mimic>> leaders(robot_.joints.size(), {-1, {}});
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      std::optional<Mimic>& mimic = robot_.joints[j].mimic;
      if (!mimic || robot_.joints[at(mimic->leader)].has_coordinate()) continue;
      auto& [leader, first] = leaders[at(mimic->leader)];
      if (leader < 0) {
        leader = static_cast<int>(j);
        first = *mimic;
        mimic.reset();
        continue;
      }
      const double a = mimic->multiplier / first.multiplier, b = mimic->offset - first.offset * a;
      *mimic = {robot_.joints[at(leader)].name, leader, a, b, mimic->line};
    }
  }

  Robot& robot_;
  RootMount mount_;
  const Repairs& repairs_;
  std::vector<Note>& changes_;
  const ReportProblem& report_problem_;
};

}  // namespace

void settle_mass_properties(Robot& robot, RootMount mount, const Repairs& repairs, std::vector<Note>& changes,
                            const ReportProblem& report_problem) {
  Settling(robot, mount, repairs, changes, report_problem).run();
}

}  // namespace slew::urdf
