// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/display.h"
#include "multibody/build/assembly.h"
#include "multibody/build/start_rules.h"
#include "multibody/build/validate_flexible.h"
#include "multibody/build/validate_gears.h"
#include "multibody/build/validate_motions.h"
#include "multibody/constraints/gear_fields.h"
#include "multibody/contacts/contact_elements.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/forces/validate_elements.h"
#include "multibody/formulations/body_penalty.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/integrators.h"
#include "multibody/formulations/singularity.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/body_inertia.h"
#include "multibody/model/field_tables.h"
#include "multibody/model/topology.h"
#include "multibody/motions/motion_fields.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

// no machine has a part with this radius of gyration; beyond it double precision loses masses beside moments
constexpr double kLargestRadius = 1e6;  // m
// directions f1 and g1 are exact in practice; a larger angle means a wrong number
constexpr double kRightAngleTolerance = 1e-3;
// transverse moments of a cylinder as CAD prints them
constexpr double kTransverseTolerance = 1e-2;

class Validator {
 public:
  // expanded: with_nodes() of the given mechanics, or this itself
  Validator(const MechanicsDef& given, const MechanicsDef& expanded, Problems& problems)
      : given_(given), m_(expanded), problems_(problems) {}

  void check_numbers() {
    check_section();
    check_ranges();
  }

  void run() {
    check_numbers();
    check_names();
    for (const BodyDef& body : given_.bodies) {
      if (body.type == BodyType::rigid) check_inertia(body);
    }
    for (const JointDef& joint : m_.joints) {
      const int axes = joint.type == JointType::spherical ? 1 : coordinate_count(joint.type);
      for (int number = 0; number < axes; ++number) check_axis(joint, number);
    }
    for (const TranslationalForceDef& force : m_.translational_forces) check_line(force), check_tables(force);
    for (const RotationalForceDef& force : m_.rotational_forces) check_angle(force), check_tables(force);
    for (const ForceDummyDef& dummy : m_.force_dummies) check_dummy(dummy);
    for (const StaticDummyDef& dummy : m_.static_dummies) check_dummy(dummy);
    if (!check_elements(m_, problems_)) references_hold_ = false;
    if (!check_motions(m_, problems_)) references_hold_ = false;
    if (!check_gears(m_, problems_)) references_hold_ = false;
    if (!references_hold_) return;
    const std::size_t before = problems_.size();
    const std::vector<Pose> poses = start_poses(m_, problems_);
    const std::vector<TreeEdge> tree = find_tree(m_, problems_);
    if (problems_.size() == before) {
      check_start(m_, poses, tree, problems_);
      check_element_starts(m_, poses, problems_);
      check_motion_starts(m_, poses, problems_);
      check_gear_starts(m_, poses, tree, problems_);
    }
    if (problems_.empty()) validate_contacts(m_, problems_);
    if (problems_.empty()) find_singular_joints(given_, problems_);
    if (problems_.empty()) check_loops();
    if (problems_.empty()) check_mode_speeds(given_, problems_);
    if (problems_.empty()) check_segment_speeds(given_, problems_);
  }

 private:
  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }

  void check_section() {
    check_integrator();
    if (m_.formulation != Formulation::penalty || !(m_.penalty_frequency > 0)) return;
    const double longest = longest_penalty_step(m_.penalty_damping, m_.penalty_frequency);
    if (m_.max_substep <= longest) return;
    add("mechanics.penalty_frequency",
        fmt::format("{:.4g} rad/s with penalty_damping {:.4g} is unstable in sub-steps of {:.4g} s",
                    m_.penalty_frequency, m_.penalty_damping, m_.max_substep),
        fmt::format("at most {:.6g} rad/s, or max_substep of at most {:.3g} s",
                    rounded_down(longest * m_.penalty_frequency / m_.max_substep), rounded_down(longest)));
  }

  void check_integrator() {
    if (m_.integrator == Integrator::own) return;
    std::vector<std::string_view> names;
    for (const Integrator integrator : integrators_of(m_.formulation)) {
      if (integrator == m_.integrator) return;
      names.push_back(key_of(integrator));
    }
    add("mechanics.integrator",
        fmt::format("the formulation '{}' has no integrator '{}'", key_of(m_.formulation), key_of(m_.integrator)),
        fmt::format("{} or own", fmt::join(names, ", ")));
  }

  // ranges of the field tables, for Defs made in code
  void check_ranges() {
    check_fields("mechanics", mechanics_fields(), const_cast<MechanicsDef*>(&m_));
    const auto check_all = [this](const auto& defs, std::size_t section, auto type_of) {
      for (const auto& def : defs) {
        const ElementType& type = sections()[section].types[type_of(def)];
        check_fields(def.name, type.fields, const_cast<void*>(static_cast<const void*>(&def)));
      }
    };
    const auto first = [](const auto&) { return std::size_t{0}; };
    const auto second = [](const auto&) { return std::size_t{1}; };
    check_all(given_.bodies, 0, [](const BodyDef& body) { return static_cast<std::size_t>(body.type); });
    check_all(given_.joints, 1, [](const JointDef& joint) { return static_cast<std::size_t>(joint.type); });
    check_all(m_.translational_forces, 2, first);
    check_all(m_.rotational_forces, 2, second);
    check_all(m_.force_dummies, 3, first);
    check_all(m_.static_dummies, 3, second);
    check_all(m_.shapes, 4, [](const ShapeDef& shape) { return static_cast<std::size_t>(shape.type); });
    check_all(m_.contacts, 5, first);
    check_all(m_.frictions, 6, first);
    check_all(m_.motions, 7, motion_type_index);
    check_all(m_.gears, 8, [](const GearDef& gear) { return static_cast<std::size_t>(gear.kind); });
    for_each_element_list(m_, [&](const auto& defs, std::span<const Field> fields) {
      for (const auto& def : defs) check_fields(def.name, fields, const_cast<void*>(static_cast<const void*>(&def)));
    });
  }

  void check_fields(const std::string& owner, std::span<const Field> fields, void* def) {
    for (const Field& row : fields) {
      if (row.type == FieldType::choice) continue;
      if (row.type == FieldType::number) {
        const double value = *static_cast<double*>(row.member(def));
        // an unset limit is infinite, which no scene can write
        if (!row.range.contains(value) && !std::isinf(value)) report_range(owner, row, value);
        if (std::isinf(value) && !is_open_ended(row.key)) report_range(owner, row, value);
      } else if (row.type == FieldType::integer) {
        const double value = static_cast<double>(*static_cast<std::int64_t*>(row.member(def)));
        if (!row.range.contains(value)) report_range(owner, row, value);
      } else if (row.type == FieldType::triple) {
        const Triple& triple = *static_cast<Triple*>(row.member(def));
        if (is_open_ended(row.key) && !is_given(triple)) continue;
        for (const double value : triple) {
          if (!row.range.contains(value)) report_range(owner, row, value);
        }
      }
    }
  }

  static bool is_open_ended(std::string_view key) {
    return key.starts_with("limit_m") || key == "max_length" || key == "min_angle" || key == "max_angle" ||
           key == "unit" || key == "offset" || key == "from" || key == "flex_frequency_limit" ||
           key.starts_with("initial_");
  }

  void report_range(const std::string& owner, const Field& row, double value) {
    const std::string unit(info(row.dimension).si_unit);
    const bool is_positive = row.range.min == 0 && std::isinf(row.range.max);
    add(fmt::format("{}.{}", owner, row.key), fmt::format("{} {} is out of range", value, unit),
        is_positive                    ? fmt::format("a number {} 0", row.range.min_is_open ? ">" : ">=")
        : std::isfinite(row.range.min) ? fmt::format("{} to {} {}", row.range.min, row.range.max, unit)
                                       : std::string("a finite number"));
  }

  void check_names() {
    const auto reference = [this](const std::string& owner, std::string_view key, const std::string& body) {
      if (number_of_(body) != kNoBody) return;
      references_hold_ = false;
      const std::string nodes = nodes_beside(given_, body);
      add(fmt::format("{}.{}", owner, key), fmt::format("there is no body '{}'", body),
          nodes.empty() ? "the name of a body, or Ground" : nodes);
    };
    for (const BodyDef& body : m_.bodies) reference(body.name, "relative_to", body.relative_to);
    const auto two_bodies = [this, &reference](const auto& def) {
      reference(def.name, "body1", def.body1);
      reference(def.name, "body2", def.body2);
      if (def.body1 == def.body2) {
        references_hold_ = false;
        add(def.name + ".body2", fmt::format("both bodies are '{}'", def.body1), "two different bodies");
      }
    };
    for (const JointDef& joint : m_.joints) two_bodies(joint);
    for (const TranslationalForceDef& force : m_.translational_forces) two_bodies(force);
    for (const RotationalForceDef& force : m_.rotational_forces) two_bodies(force);
    for (const StaticDummyDef& dummy : m_.static_dummies) reference(dummy.name, "relative_to", dummy.relative_to);
    check_payload();
    check_unique();
  }

  void check_payload() {
    if (m_.payload.empty()) return;
    const auto found = std::find_if(given_.bodies.begin(), given_.bodies.end(),
                                    [this](const BodyDef& body) { return body.name == m_.payload; });
    if (found == given_.bodies.end()) {
      add("mechanics.payload", fmt::format("there is no body '{}'", m_.payload), "the name of a rigid body that moves");
    } else if (found->type != BodyType::rigid) {
      add("mechanics.payload", fmt::format("'{}' is not a rigid body, whose mass could be changed", m_.payload),
          "the name of a rigid body that moves");
    } else if (is_held_by_ground(m_.payload)) {
      add("mechanics.payload", fmt::format("'{}' is fixed to Ground and does not move", m_.payload),
          "the name of a rigid body that moves");
    }
  }

  // fixed joints alone lead from it to Ground
  [[nodiscard]] bool is_held_by_ground(std::string_view body) const {
    std::vector<std::string_view> held = {kGroundName};
    for (std::size_t k = 0; k < held.size(); ++k) {
      for (const JointDef& joint : m_.joints) {
        if (joint.type != JointType::fixed || (joint.body1 != held[k] && joint.body2 != held[k])) continue;
        const std::string_view other = joint.body1 == held[k] ? joint.body2 : joint.body1;
        if (std::find(held.begin(), held.end(), other) == held.end()) held.push_back(other);
      }
    }
    return std::find(held.begin(), held.end(), body) != held.end();
  }

  void check_unique() {
    std::vector<std::string_view> names = {kGroundName};
    const auto collect = [&names](const auto& defs) {
      for (const auto& def : defs) names.push_back(def.name);
    };
    collect(given_.bodies);
    collect(given_.joints);
    collect(m_.translational_forces);
    collect(m_.rotational_forces);
    collect(m_.force_dummies);
    collect(m_.static_dummies);
    collect(m_.motions);
    collect(m_.gears);
    for_each_element_list(m_, [&](const auto& defs, std::span<const Field>) { collect(defs); });
    std::sort(names.begin(), names.end());
    for (std::size_t i = 1; i < names.size(); ++i) {
      if (names[i] != names[i - 1]) continue;
      references_hold_ = false;
      add(std::string(names[i]), fmt::format("the name '{}' is taken", names[i]),
          "a name of its own for every element");
    }
  }

  void check_inertia(const BodyDef& body) {
    const auto [xx, yy, zz] = body.inertia;
    const auto [a, b, c] = math::symmetric_eigenvalues(inertia_about_center(body));
    const double tolerance = kInertiaTolerance * std::max({xx, yy, zz, std::abs(c)});
    const double radius = std::sqrt(std::abs(c) / body.mass);
    if (!(radius <= kLargestRadius)) {
      add(body.name + ".mass", fmt::format("with {:.6g} kg the radius of gyration is {:.3g} m", body.mass, radius),
          fmt::format("a mass that fits the inertia: a radius of at most {:g} m", kLargestRadius));
      return;
    }
    const std::string point = body.inertia_about == InertiaPoint::body_origin ? " (taken to the centre of mass)" : "";
    if (a < -tolerance) {
      add(body.name + ".inertia",
          fmt::format("the tensor{} is not positive: smallest principal moment {:.6g} kg m2", point, a),
          "moments and products of a real body; products are the tensor's elements, minus the integral of x y dm");
    } else if (a + b < c - tolerance) {
      add(body.name + ".inertia",
          fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m2{} break the triangle rule", a, b, c, point),
          "no moment larger than the sum of the other two");
    }
  }

  void check_axis(const JointDef& joint, int number) {
    const JointAxisDef axis = axis_of(joint, number);
    const std::string_view suffix = suffix_of(joint.type, number);
    const auto report_problem = [&](std::string_view key, std::string what, std::string expected) {
      add(fmt::format("{}.{}{}", joint.name, key, suffix), std::move(what), std::move(expected));
    };
    if (axis.limit_min >= axis.limit_max) {
      report_problem("limit_min",
                     fmt::format("lower limit {} is not below the upper limit {}", axis.limit_min, axis.limit_max),
                     "limit_min < limit_max");
    }
    if (axis.bristle_stiffness > 0 && axis.coulomb_friction == 0) {
      report_problem("bristle_stiffness", "the bristles have no dry friction to hold with", "coulomb_friction > 0");
    }
    if (axis.bristle_stiffness == 0 && (axis.bristle_damping > 0 || axis.breakaway_ratio > 1)) {
      add(joint.name, "bristle_damping or breakaway_ratio without bristles", "bristle_stiffness > 0");
    }
    if (!has_limits(axis) && (axis.limit_stiffness > 0 || axis.limit_damping > 0)) {
      report_problem(axis.limit_stiffness > 0 ? "limit_stiffness" : "limit_damping",
                     "nothing reads this key: the joint has no limits", "limit_min or limit_max, or no such key");
    }
    if (has_limits(axis) && axis.limit_stiffness == 0) {
      report_problem("limit_stiffness", "the joint has limits but they have no stiffness",
                     "limit_stiffness > 0, or no limits");
    }
  }

  // a table takes the place of its constant
  template <typename Force>
  void check_tables(const Force& force) {
    check_table(force.name + ".spring_table", force.spring_table, TableUse::spring, problems_);
    check_table(force.name + ".damper_table", force.damper_table, TableUse::damper, problems_);
    if (!force.spring_table.empty() && force.spring_constant > 0)
      add(force.name + ".spring_table", "the force has a spring_constant as well", "one of the two");
    if (!force.damper_table.empty() && force.damping_constant > 0)
      add(force.name + ".damper_table", "the force has a damping_constant as well", "one of the two");
  }

  void check_line(const TranslationalForceDef& force) {
    if (force.min_length > force.max_length ||
        (force.end_spring_constant > 0 && force.min_length >= force.max_length)) {
      add(force.name + ".min_length",
          fmt::format("smallest length {} m is not below the largest {} m", force.min_length, force.max_length),
          "min_length < max_length");
    }
  }

  void check_angle(const RotationalForceDef& force) {
    const Vec3 f1(force.f1), g1(force.g1), f2(force.f2);
    for (const auto& [key, direction] : {std::pair{"f1", f1}, {"g1", g1}, {"f2", f2}}) {
      if (math::norm(direction) > 0) continue;
      add(fmt::format("{}.{}", force.name, key), "the direction is zero", "a direction");
      return;
    }
    const double cosine = math::dot(f1, g1) / (math::norm(f1) * math::norm(g1));
    if (std::abs(cosine) > kRightAngleTolerance) {
      add(force.name + ".g1", fmt::format("f1 and g1 enclose {:.4g} deg", std::acos(cosine) * 180 / M_PI),
          "two directions at a right angle; the axis is f1 x g1");
    }
    if (force.min_angle > force.max_angle || (force.end_spring_constant > 0 && force.min_angle >= force.max_angle)) {
      add(force.name + ".min_angle",
          fmt::format("smallest angle {} rad is not below the largest {} rad", force.min_angle, force.max_angle),
          "min_angle < max_angle");
    }
  }

  void check_dummy(const ForceDummyDef& dummy) {
    const bool is_found = std::any_of(m_.translational_forces.begin(), m_.translational_forces.end(),
                                      [&](const auto& force) { return force.name == dummy.relative_to; });
    if (!is_found) {
      references_hold_ = false;
      add(dummy.name + ".relative_to", fmt::format("there is no translational force '{}'", dummy.relative_to),
          "the name of a translational force");
    }
    if (dummy.center_of_mass[1] != 0 || dummy.center_of_mass[2] != 0) {
      add(dummy.name + ".center_of_mass", "the centre of mass is off the line of force",
          "y = z = 0: two points do not define the directions of y and z");
    }
    const auto [xx, yy, zz] = dummy.inertia;
    if (std::abs(yy - zz) > kTransverseTolerance * std::max(yy, zz)) {
      add(dummy.name + ".inertia", fmt::format("Iyy {} and Izz {} kg m2 differ by more than 1 %", yy, zz),
          "Iyy = Izz: two points do not define the directions of y and z");
    }
    if (xx > yy + zz + kInertiaTolerance * std::max({xx, yy, zz})) {
      add(dummy.name + ".inertia", fmt::format("moments {}, {}, {} kg m2 break the triangle rule", xx, yy, zz),
          "no moment larger than the sum of the other two");
    }
  }

  void check_dummy(const StaticDummyDef& dummy) {
    auto I = dummy.inertia;
    std::sort(I.begin(), I.end());
    if (I[0] + I[1] < I[2] * (1 - kInertiaTolerance)) {
      add(dummy.name + ".inertia", fmt::format("moments {}, {}, {} kg m2 break the triangle rule", I[0], I[1], I[2]),
          "no moment larger than the sum of the other two");
    }
  }

  // loops that cannot be closed, and speeds that they do not allow
  void check_loops() {
    AssemblyReport report;
    const Model model = build_model(given_, {}, report);
    if (!report.is_settled) {
      add(model.segmented.empty() ? model.parts.front().name : model.segmented.front().name,
          "the flexible bodies have no static equilibrium under the load of the start",
          "a load below the buckling load, or a start of its own");
    }
    for (const AssemblyReport::Row& row : report.locking) {
      add(row.gear,
          fmt::format("neither '{}' nor '{}' can move: the loop of joints holds them in another ratio", row.what,
                      model.joints[static_cast<std::size_t>(row.joint)].name),
          "the ratio of the loop, or no gear in it");
    }
    if (!report.locking.empty()) return;
    for (const AssemblyReport::Row& row : report.held_twice) {
      if (!row.gear.empty()) {
        add(row.gear, "the prescribed motions hold both joints of this gear already",
            "one motion for a chain of gears");
        continue;
      }
      add(model.joints[static_cast<std::size_t>(row.joint)].name,
          fmt::format("the prescribed motions hold what this joint holds: {}", row.what),
          "fewer prescribed motions than the loop has freedoms");
    }
    if (!report.held_twice.empty()) return;
    for (const AssemblyReport::Row& row : report.open) {
      if (!row.gear.empty()) {
        add(row.gear, fmt::format("the gear misses its ratio by {:.3g} after all bodies were moved", row.violation),
            "ratios, offsets and poses that loops and other gears allow");
        continue;
      }
      add(model.joints[static_cast<std::size_t>(row.joint)].name,
          fmt::format("the joint cannot be closed: {} is off by {:.3g} after all bodies were moved", row.what,
                      row.violation),
          "poses, points and lengths that let all joints of the loop close");
    }
    check_turns(model);
    for (const AssemblyReport::Speed& speed : report.speeds) {
      add(speed.joint + ".initial_velocity",
          fmt::format("the loops do not allow {:.6g}; with the other speeds given it is {:.6g}", speed.wanted,
                      speed.found),
          "speeds that fit each other: those that are not given follow from the others");
    }
    // speeds that do not fit are refused above
    if (!report.speeds.empty() || !report.open.empty()) return;
    for (const AssemblyReport::Singular& row : report.singular) {
      if (row.goes_on) continue;
      add(row.joint,
          fmt::format("the loop that it closes with {} starts in a singular position, from which it can go on in more "
                      "than one way, and the start speeds fit none of them",
                      row.others),
          "start speeds of one more of its joints, which fit the way it shall go, or a start that is 1e-3 rad or more "
          "off this position");
    }
  }

  // an end damper that lies where the angle has jumped by a whole turn is never touched
  void check_turns(const Model& model) {
    for (const AngleElement& element : model.angles) {
      const ElementLaw& law = element.law;
      if (element.is_coaxial || !(law.end_spring > 0)) continue;
      const bool is_above = std::isfinite(law.max) && law.max > M_PI;
      if (!is_above && !(std::isfinite(law.min) && law.min < -M_PI)) continue;
      add(element.name + (is_above ? ".max_angle" : ".min_angle"),
          fmt::format("the end damper is at {:.4g} deg, where the angle never is: revolute joints about the force's "
                      "axis do not connect its bodies, and without them the angle is between -180 and 180 deg",
                      (is_above ? law.max : law.min) * 180 / M_PI),
          "a range within 180 deg, or a revolute joint about the axis between the bodies");
    }
  }

  const MechanicsDef& given_;
  const MechanicsDef& m_;
  BodyNumbers number_of_{m_};
  Problems& problems_;
  bool references_hold_ = true;
};

}  // namespace

void validate(const MechanicsDef& mechanics, Problems& problems) {
  Problems own;
  if (!check_flexible_bodies(mechanics, own)) {
    Validator(mechanics, mechanics, own).check_numbers();
  } else if (!has_parts(mechanics)) {
    Validator(mechanics, mechanics, own).run();
  } else {
    Validator(mechanics, with_nodes(mechanics), own).run();
  }
  problems.insert(problems.end(), own.begin(), own.end());
}

}  // namespace slew::multibody
