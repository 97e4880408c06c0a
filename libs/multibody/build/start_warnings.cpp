// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/display.h"
#include "multibody/build/assembly.h"
#include "multibody/build/start_groups.h"
#include "multibody/build/validate.h"
#include "multibody/flexible/deflection.h"
#include "multibody/formulations/formulation.h"
#include "multibody/model/body_inertia.h"
#include "multibody/model/topology.h"
#include "multibody/motions/motion_pieces.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// ratio by which a body's mass may extend beyond its points
constexpr double kLargestGyration = 3;

// that a body starts undeformed because it falls: the weight would strain it in its joints alone
void note_fall(const Model& model, const std::string& path, Problems& warnings) {
  if (norm(model.gravity) == 0) return;
  warnings.push_back({path,
                      "the body starts undeformed: no joint, force element or touching contact connects it to Ground, "
                      "and its weight does not strain it while it falls",
                      "nothing to do", ""});
}

}  // namespace

void find_start_deflections(const Model& model, Problems& warnings) {
  const StartGroups groups = find_start_groups(model);
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const FlexiblePart& part = model.parts[p];
    if (groups.parts[p] == StartRest::falls && !part.is_start_given) {
      note_fall(model, part.name + ".flex_modes", warnings);
    }
    if (groups.parts[p] == StartRest::held && !model.rests_in_loops && !part.is_start_given) {
      warnings.push_back(
          {part.name + ".flex_modes",
           "the body starts undeformed, moves as a rigid one that the joints allow, and swings: in a mechanism with "
           "loops a static equilibrium is computed only where actuators and loops hold all its joints",
           "nothing to do, or damping that ends it", ""});
    }
    const std::span<const double> q(model.start_q.data() + part.q, part.modes);
    const LargestDeflection largest = largest_deflection(*part.source, part.watched, q);
    const double share = largest.size / part.length;
    if (!(share > kSmallDeflection)) continue;
    warnings.push_back(
        {part.name + ".flex_modes",
         fmt::format("node {} is {:.3g} m off at the start, {:.0f} % of the body's length: the theory is "
                     "one of small deflections",
                     largest.node, largest.size, 100 * share),
         fmt::format("deflections below {:.0f} %", 100 * kSmallDeflection), ""});
  }
}

namespace {

// values of modes that the scene gives and loops do not leave
void find_moved_modes(const MechanicsDef& mechanics, const Model& model, Problems& warnings) {
  constexpr double kMoved = 1e-9;  // of the largest value of the body
  // rounding of the poses, of which the joints may be open by as much: largest turn of a node, or motion over the
  // length
  constexpr double kRounding = kFrameTolerance;
  const auto compare = [&](const FlexiblePart& part, const char* key, const std::vector<double>& wanted,
                           const double* found) {
    double largest = 0, moved = 0, turned = 0;
    std::size_t place = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      largest = std::max({largest, std::fabs(wanted[k]), std::fabs(found[k])});
      turned = std::max(turned, std::fabs(found[k] - wanted[k]) * largest_turn(*part.source, part.length, k));
      if (std::fabs(found[k] - wanted[k]) <= moved) continue;
      moved = std::fabs(found[k] - wanted[k]);
      place = k;
    }
    if (!(moved > kMoved * largest) || !(turned > kRounding)) return;
    warnings.push_back({part.name + "." + key,
                        fmt::format("the loops leave no such start: the value of mode {} is {:.6g} instead of {:.6g}",
                                    place + 1, found[place], wanted[place]),
                        "values that the joints of the loops allow", ""});
  };
  for (const FlexibleBodyDef& def : mechanics.flexible_bodies) {
    for (const FlexiblePart& part : model.parts) {
      if (part.name != def.body || part.modes == 0) continue;
      compare(part, "modal_coordinates", def.start, &model.start_q[static_cast<std::size_t>(part.q)]);
      compare(part, "modal_rates", def.start_rates, &model.start_u[static_cast<std::size_t>(part.u)]);
    }
  }
}

void find_start_bends(const Model& model, Problems& warnings) {
  Workspace ws(model);
  observe(model, start_state(model), ws);
  const StartGroups groups = find_start_groups(model);
  for (std::size_t p = 0; p < model.segmented.size(); ++p) {
    const SegmentedPart& part = model.segmented[p];
    if (groups.segmented[p] == StartRest::falls) note_fall(model, part.name + ".segments", warnings);
    if (groups.segmented[p] == StartRest::held && part.start == SegmentStart::at_rest) {
      warnings.push_back({part.name + ".segments",
                          part.is_free
                              ? "the body starts undeformed, moves as a rigid one that the joints allow, and "
                                "swings: in a mechanism with loops no static equilibrium is computed"
                              : "the body starts undeformed, moves as a rigid one that the joints allow, and "
                                "swings: no static equilibrium is computed if joints hold more of it than its root",
                          "nothing to do, or damping that ends it", ""});
    }
    const LargestBend bend = largest_bend(model, part, ws);
    if (!(bend.angle > kLargestBend)) continue;
    warnings.push_back({part.name + ".segments",
                        fmt::format("segments are turned by {:.3g} rad against each other at the start, at connector "
                                    "{} of {}: a connector is good for small turns",
                                    bend.angle, bend.connector + 1, part.source->connectors.size()),
                        fmt::format("so many segments that none turns by more than {} rad", kLargestBend), ""});
  }
}

struct Overshoot {
  bool is_found = false;
  double from = 0, to = 0;  // s, interval of the points
  double value = 0;
  double least = 0, largest = 0;  // of the two points and their neighbours
};

// The value by which a spline is farthest out of the range of four points in a row; found: by more than that range.
Overshoot widest_overshoot(const math::CubicSpline& spline, const Table& points) {
  constexpr int kSamples = 32;
  Overshoot widest;
  double most = 1;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    double least = points[i][1], largest = least;
    for (std::size_t k = i > 0 ? i - 1 : 0; k < std::min(i + 3, points.size()); ++k) {
      least = std::min(least, points[k][1]), largest = std::max(largest, points[k][1]);
    }
    for (int k = 1; k < kSamples; ++k) {
      const double x = points[i][0] + (points[i + 1][0] - points[i][0]) * k / kSamples;
      const double y = math::value_at(spline, x).y, out = std::max(y - largest, least - y);
      if (!(out > most * (largest - least)) || !(out > kFrameTolerance)) continue;
      most = largest > least ? out / (largest - least) : std::numeric_limits<double>::infinity();
      widest = {true, points[i][0], points[i + 1][0], y, least, largest};
    }
  }
  return widest;
}

// Shortest time in which a table goes one way and then back [s]; infinite: it does not. Ways below a share of the
// largest value are none.
double shortest_pulse(const Table& table) {
  constexpr double kNoticed = 1e-3;
  double least = 0, largest = 0;
  for (const auto& point : table) least = std::min(least, point[1]), largest = std::max(largest, point[1]);
  const double noticed = kNoticed * (largest - least);
  double shortest = std::numeric_limits<double>::infinity();
  // extremes since the last turn, and the way there: 1 up, -1 down, 0 none yet
  std::size_t top = 0, bottom = 0;
  int way = 0;
  for (std::size_t k = 1; k < table.size(); ++k) {
    if (table[k][1] > table[top][1]) top = k;
    if (table[k][1] < table[bottom][1]) bottom = k;
    const bool rises = way <= 0 && table[k][1] - table[bottom][1] > noticed;
    if (!rises && !(way >= 0 && table[top][1] - table[k][1] > noticed)) continue;
    const std::size_t turn = rises ? bottom : top;
    if (way != 0) {
      std::size_t begin = turn;
      while (std::fabs(table[begin][1] - table[turn][1]) <= noticed) --begin;
      shortest = std::min(shortest, table[k][0] - table[begin][0]);
    }
    way = rises ? 1 : -1;
    top = bottom = k;
  }
  return shortest;
}

}  // namespace

void find_short_pulses(const MechanicsDef& mechanics, double substep, Problems& warnings) {
  constexpr double kRounding = 1e-9;
  const auto look = [&](const std::string& path, const Table& table) {
    const double pulse = shortest_pulse(table);
    if (!(pulse < 2 * substep * (1 - kRounding))) return;
    warnings.push_back({path,
                        fmt::format("it rises and falls within {:.3g} s, and sub-steps of {:.3g} s look at it at their "
                                    "ends and middles only: the impulse may be wrong by its whole size",
                                    pulse, substep),
                        fmt::format("mechanics.max_substep of at most {:.2g} s, or a longer pulse of the same impulse",
                                    rounded_down(pulse / 2, 2)),
                        ""});
  };
  for (const PointForceDef& def : mechanics.point_forces) look(def.name + ".force_table", def.force_table);
  for (const PointTorqueDef& def : mechanics.point_torques) look(def.name + ".torque_table", def.torque_table);
}

void find_fast_motions(const MechanicsDef& mechanics, double substep, Problems& warnings) {
  const MotionResolution resolution = motion_resolution(mechanics.formulation, step_rule(mechanics).integrator);
  for (const MotionDef& def : mechanics.motions) {
    const FastMotion found = find_fast_motion(motion_law(def, 0), resolution, substep);
    if (!found.is_found) continue;
    warnings.push_back(
        {def.name,
         fmt::format("the motion is too fast for sub-steps of {:.3g} s, which are divided into {} parts "
                     "at most: from {:.6g} s on what hangs on it moves wrongly",
                     substep, kMostMotionPieces, found.time),
         fmt::format("mechanics.max_substep of at most {:.2g} s, or a slower motion", rounded_down(found.longest, 2)),
         ""});
  }
}

void find_overshoots(const MechanicsDef& mechanics, Problems& warnings) {
  for (const MotionDef& def : mechanics.motions) {
    if (def.points.size() < 2) continue;
    const Overshoot found = widest_overshoot(motion_law(def, 0).spline, def.points);
    if (!found.is_found) continue;
    const bool is_speed = def.shape == MotionShape::speed;
    const std::string unit = std::string(def.kind == MotionKind::rotation ? "rad" : "m") + (is_speed ? "/s" : "");
    warnings.push_back({def.name + ".points",
                        fmt::format("the cubic spline through the points reaches {:.4g} {} between {:.6g} s and {:.6g} "
                                    "s, where the points go from {:.4g} to {:.4g} {}: it overshoots beside a jump",
                                    found.value, unit, found.from, found.to, found.least, found.largest, unit),
                        "more points beside the jump, of a change that is smooth, or a *_ramp", ""});
  }
}

void find_start_changes(const MechanicsDef& mechanics, Problems& warnings) {
  AssemblyReport report;
  const Model model = build_model(mechanics, {}, report);
  Workspace ws(model);
  State state = start_state(model);
  for_each_mode(model, [&](std::size_t q, std::size_t) { state.q[q] = 0; });
  straighten_segments(model, state.q, state.u);
  observe(model, state, ws);
  Problems ignored;
  const std::vector<Pose> wanted = start_poses(mechanics, ignored);
  for (std::size_t b = 1; b < wanted.size(); ++b) {
    const BodyPose found = body_pose(model, ws, static_cast<int>(b));
    const double shift = math::norm(Vec3(found.position) - wanted[b].p);
    const auto [w, x, y, z] = found.orientation;
    const double turn = math::rotation_angle(math::rotation_of({w, x, y, z}) * math::transpose(wanted[b].R));
    if (shift <= kFrameTolerance && turn <= kFrameTolerance) continue;
    warnings.push_back(
        {model.bodies[b].name + ".position",
         fmt::format("the joints were open at the start: this body was moved by {:.3g} m and turned by {:.3g} rad",
                     shift, turn),
         "poses that fit the joints", ""});
  }
  if (!model.has_closing_rows()) find_start_deflections(model, warnings);
  find_moved_modes(mechanics, model, warnings);
  find_start_bends(model, warnings);
  for (const AssemblyReport::Singular& row : report.singular) {
    if (!row.is_at_rest) continue;
    warnings.push_back({row.joint,
                        fmt::format("the loop that it closes with {} starts at rest in a singular position: it can go "
                                    "on in more than one way, and rounding selects",
                                    row.others),
                        "a start that is 1e-3 rad or more off this position, on the side to which it shall go", ""});
  }
  const Description description = describe(model);
  for (const CutDescription& cut : description.cuts) {
    for (const std::string& row : cut.redundant) {
      warnings.push_back({cut.joint, row + " is redundant: other joints hold it already",
                          "nothing to do: motion is right, reactions are the smallest that fit", ""});
    }
  }
  for (const std::string& gear : description.idle_gears) {
    warnings.push_back({gear, "the gear is redundant: joints or other gears hold its ratio already",
                        "nothing to do: motion is right, this gear carries no force", ""});
  }
}

void find_unlikely_inertia(const MechanicsDef& mechanics, Problems& warnings) {
  const BodyNumbers number_of(mechanics);
  std::vector<double> extent(mechanics.bodies.size() + 1, 0);
  const auto see = [&](const std::string& owner, const Triple& point) {
    const int number = number_of(owner);
    if (number == kGround || number == kNoBody) return;
    const BodyDef& body = mechanics.bodies[static_cast<std::size_t>(number) - 1];
    double& reach = extent[static_cast<std::size_t>(number)];
    reach = std::max(reach, math::norm(Vec3(point) - Vec3(body.center_of_mass)));
  };
  for (const JointDef& joint : mechanics.joints) see(joint.body1, joint.point1), see(joint.body2, joint.point2);
  for (const TranslationalForceDef& force : mechanics.translational_forces) {
    see(force.body1, force.point1), see(force.body2, force.point2);
  }
  for (std::size_t b = 0; b < mechanics.bodies.size(); ++b) {
    const BodyDef& body = mechanics.bodies[b];
    if (body.type != BodyType::rigid) continue;
    const double largest = math::symmetric_eigenvalues(inertia_about_center(body))[2];
    const double gyration = std::sqrt(std::max(0.0, largest) / body.mass);
    // a body with all points in its centre gives no size
    if (extent[b + 1] == 0 || gyration <= kLargestGyration * extent[b + 1]) continue;
    warnings.push_back({body.name + ".inertia",
                        fmt::format("the radius of gyration is {:.3g} m, all points on the body are within {:.3g} m of "
                                    "its centre of mass",
                                    gyration, extent[b + 1]),
                        "the inertia about inertia_about, in kg m2", ""});
  }
}

namespace {

// angle between two axes, of either direction, below which they are one [rad]
constexpr double kOneAxis = 1e-2;
// way along a body with modes, as a share of its length, that a point may lie from its node
constexpr double kAtNode = 5e-2;

std::string in_scene(Vec3 v) {
  const auto rounded = [](double x) { return std::fabs(x) < 5e-7 ? 0.0 : x; };
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", rounded(v[0]), rounded(v[1]), rounded(v[2]));
}

// the hinge between two bodies; null: none
const JointDef* hinge_between(const MechanicsDef& mechanics, const std::string& a, const std::string& b) {
  const auto found = std::find_if(mechanics.joints.begin(), mechanics.joints.end(), [&](const JointDef& joint) {
    const bool is_hinge = joint.type == JointType::revolute || joint.type == JointType::cylindrical;
    return is_hinge && ((joint.body1 == a && joint.body2 == b) || (joint.body1 == b && joint.body2 == a));
  });
  return found == mechanics.joints.end() ? nullptr : &*found;
}

}  // namespace

void find_axes_beside_hinges(const MechanicsDef& mechanics, Problems& warnings) {
  for (const RotationalForceDef& force : mechanics.rotational_forces) {
    const JointDef* const hinge = hinge_between(mechanics, force.body1, force.body2);
    if (hinge == nullptr) continue;
    const bool is_first = hinge->body1 == force.body1;
    const math::Mat3 own = math::rotation_xyz(is_first ? hinge->orientation1 : hinge->orientation2);
    const math::Mat3 other = math::rotation_xyz(is_first ? hinge->orientation2 : hinge->orientation1);
    const Vec3 across = cross(Vec3(force.f1), Vec3(force.g1)), axis = across * (1 / norm(across)), wanted = own.c[2];
    if (norm(cross(axis, wanted)) < kOneAxis) continue;
    warnings.push_back(
        {force.name,
         fmt::format("its axis f1 x g1 is {} in '{}', and its bodies turn against each other about {}, the axis of "
                     "'{}': {}",
                     in_scene(axis), force.body1, in_scene(wanted), hinge->name,
                     std::fabs(dot(axis, wanted)) < kOneAxis ? "it carries no torque about that"
                                                             : "its angle is not that of the joint"),
         fmt::format("f1: {}, g1: {}, f2: {}, whose angle is that of the joint", in_scene(own.c[0]), in_scene(own.c[1]),
                     in_scene(other.c[0])),
         ""});
  }
}

namespace {

struct PlaceOnNodes {
  std::int64_t node = 0;  // the nearest
  double along = 0;       // m, from there towards another node
  double length = 0;      // m, diagonal of the box around the nodes
};

PlaceOnNodes place_on(const ModalBody& modes, Vec3 point) {
  const ModalNode* nearest = &modes.nodes.front();
  Vec3 low = nearest->position, high = low;
  for (const ModalNode& node : modes.nodes) {
    if (norm(node.position - point) < norm(nearest->position - point)) nearest = &node;
    for (int k = 0; k < 3; ++k) {
      low.lanes[k] = std::min(low[k], node.position[k]);
      high.lanes[k] = std::max(high[k], node.position[k]);
    }
  }
  PlaceOnNodes place{nearest->id, 0, norm(high - low)};
  for (const ModalNode& node : modes.nodes) {
    const Vec3 way = node.position - nearest->position;
    if (norm(way) > 0) place.along = std::max(place.along, dot(point - nearest->position, way) / norm(way));
  }
  return place;
}

}  // namespace

// A point beside the nodes is an arm, and meant so: only the way towards another node counts.
void find_points_between_nodes(const MechanicsDef& mechanics, Problems& warnings) {
  const auto look = [&](const std::string& path, const std::string& body, const Triple& point) {
    for (const FlexibleBodyDef& flexible : mechanics.flexible_bodies) {
      if (flexible.body != body || flexible.modes->modes() == 0) continue;
      const PlaceOnNodes place = place_on(*flexible.modes, Vec3(point));
      if (!(place.along > kAtNode * place.length)) continue;
      warnings.push_back(
          {path,
           fmt::format("the point lies {:.4g} m from the nearest node of '{}' towards another one, and "
                       "the body bends as if it held on to that node, {}",
                       place.along, body, place.node),
           fmt::format("a node within {:.2g} m: move the point, or make the model with more nodes (line: "
                       "{{..., nodes: N}}), one of them here",
                       kAtNode * place.length),
           ""});
    }
  };
  for (const JointDef& joint : mechanics.joints) {
    look(joint.name + ".point1", joint.body1, joint.point1), look(joint.name + ".point2", joint.body2, joint.point2);
  }
  for (const TranslationalForceDef& force : mechanics.translational_forces) {
    look(force.name + ".point1", force.body1, force.point1), look(force.name + ".point2", force.body2, force.point2);
  }
  MechanicsDef copy = mechanics;  // a row visits points that it may change
  for_each_force_type(copy, [&](auto row, const auto& /*type*/, auto& defs) {
    for (auto& def : defs) {
      row.visit_points(def, [&](const std::string& body, const Triple* point) {
        if (point != nullptr) look(def.name, body, *point);
      });
    }
  });
}

}  // namespace slew::multibody
