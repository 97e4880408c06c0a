#include "multibody/forces/validate_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "multibody/forces/matrix_rules.h"

namespace slew::multibody {
namespace {

using math::Vec3;

// printed inertias are rounded: share of the largest moment by which the triangle rule may fail
constexpr double kMatrixTolerance = 1e-6;

class ElementValidator {
 public:
  ElementValidator(const MechanicsDef& m, Problems& problems) : m_(m), problems_(problems) {}

  bool run() {
    for (const PointForceDef& def : m_.point_forces) check_load(def, def.force_table, "force_table");
    for (const PointTorqueDef& def : m_.point_torques) check_load(def, def.torque_table, "torque_table");
    for (const BushingDef& def : m_.bushings) check_bushing(def);
    for (const BeamDef& def : m_.beams) check_connector(def.name, def.frames);
    for (const RopeDef& def : m_.ropes) check_rope(def);
    for (const TyreDummyDef& def : m_.tyre_dummies) check_tyre(def);
    for (const PartDummyDef& def : m_.part_dummies) {
      check_body(def.name, "relative_to", def.relative_to);
      check_body(def.name, "carried_by", def.carried_by);
      check_inertia(def.name, def.inertia);
    }
    for (const ConstraintDummyDef& def : m_.constraint_dummies) check_constraint(def);
    return names_hold_;
  }

 private:
  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }

  bool check_body(const std::string& owner, std::string_view key, const std::string& body) {
    if (number_of_(body) != kNoBody) return true;
    names_hold_ = false;
    add(fmt::format("{}.{}", owner, key), fmt::format("there is no body '{}'", body), "the name of a body, or Ground");
    return false;
  }

  void check_direction(const std::string& path, const Triple& direction) {
    if (norm(Vec3(direction)) > 0) return;
    add(path, "the direction is zero", "a direction");
  }

  template <typename Def>
  void check_load(const Def& def, const Table& table, const char* key) {
    if (check_body(def.name, "body", def.body) && def.body == kGroundName) {
      add(def.name + ".body", "the load acts on Ground, which does not move", "a body");
    }
    check_direction(def.name + ".direction", def.direction);
    check_table(def.name + "." + key, table, TableUse::any, problems_);
  }

  void check_connector(const std::string& name, const ConnectorFrames& frames) {
    const bool is_first_known = check_body(name, "body1", frames.body1);
    const bool is_known = check_body(name, "body2", frames.body2) && is_first_known;
    if (!is_known || frames.body1 != frames.body2) return;
    names_hold_ = false;
    add(name + ".body2", fmt::format("both bodies are '{}'", frames.body1), "two different bodies");
  }

  void check_matrix(const std::string& path, const std::vector<double>& matrix) {
    if (matrix.empty()) return;
    if (matrix.size() != 36) {
      add(path, fmt::format("the matrix has {} numbers", matrix.size()), "36: six rows of six");
      return;
    }
    const auto [row, column] = find_asymmetry(matrix);
    if (row < 0) return;
    add(path, fmt::format("the matrix is not symmetric in row {}, column {}", row + 1, column + 1),
        "a symmetric matrix: one that comes of an energy");
  }

  void check_bushing(const BushingDef& def) {
    check_connector(def.name, def.frames);
    check_matrix(def.name + ".stiffness_matrix", def.stiffness_matrix);
    check_matrix(def.name + ".damping_matrix", def.damping_matrix);
    if (def.damping_matrix.size() == 36 && find_asymmetry(def.damping_matrix).row < 0) {
      std::vector<double> total = def.damping_matrix;
      for (std::size_t i = 0; i < 3; ++i) {
        total[7 * i] += def.damping[i];
        total[7 * (i + 3)] += def.rotational_damping[i];
      }
      if (!is_positive_semidefinite(total)) {
        add(def.name + ".damping_matrix", "some motion gets energy from the dampers",
            "a positive semi-definite matrix, damping and rotational_damping added");
      }
    }
    constexpr const char* kDirections[] = {"x", "y", "z", "about_x", "about_y", "about_z"};
    for (std::size_t i = 0; i < 6; ++i) {
      const auto path = [&](const char* key) { return fmt::format("{}.{}_{}", def.name, key, kDirections[i]); };
      check_table(path("spring_table"), *def.spring_tables.all()[i], TableUse::spring, problems_);
      check_table(path("damper_table"), *def.damper_tables.all()[i], TableUse::damper, problems_);
    }
  }

  void check_rope(const RopeDef& def) {
    for (const std::string& body : def.bodies) check_body(def.name, "bodies", body);
    if (def.points.size() < 2 || def.bodies.size() != def.points.size()) {
      names_hold_ = false;
      add(def.name + ".points", fmt::format("there are {} points for {} bodies", def.points.size(), def.bodies.size()),
          "two points or more, and a body for each");
    } else if (std::count(def.bodies.begin(), def.bodies.end(), def.bodies.front()) ==
               static_cast<std::ptrdiff_t>(def.bodies.size())) {
      add(def.name + ".bodies", fmt::format("all points are on '{}'", def.bodies.front()), "two bodies or more");
    }
    const int springs = (def.stiffness > 0) + (def.axial_rigidity > 0) + !def.spring_table.empty();
    if (springs != 1) {
      add(def.name, springs == 0 ? "the rope has no spring" : "the rope has several springs",
          "one of stiffness, axial_rigidity and spring_table");
    }
    if (def.damping_constant > 0 && !def.damper_table.empty()) {
      add(def.name + ".damper_table", "the rope has a damping_constant as well", "one of the two");
    }
    check_table(def.name + ".spring_table", def.spring_table, TableUse::rope_spring, problems_);
    check_table(def.name + ".damper_table", def.damper_table, TableUse::damper, problems_);
  }

  void check_tyre(const TyreDummyDef& def) {
    if (check_body(def.name, "relative_to", def.relative_to) && def.relative_to == kGroundName) {
      add(def.name + ".relative_to", "the wheel is on Ground, which does not move", "a body");
    }
    check_direction(def.name + ".ground_normal", def.ground_normal);
    check_inertia(def.name, def.inertia);
  }

  void check_constraint(const ConstraintDummyDef& def) {
    const auto joint = std::find_if(m_.joints.begin(), m_.joints.end(),
                                    [&](const JointDef& candidate) { return candidate.name == def.relative_to; });
    if (joint == m_.joints.end()) {
      names_hold_ = false;
      add(def.name + ".relative_to", fmt::format("there is no joint '{}'", def.relative_to), "the name of a joint");
    } else if (joint->type == JointType::spherical_spherical || joint->type == JointType::revolute_spherical ||
               joint->type == JointType::revolute_revolute) {
      add(def.name + ".relative_to", fmt::format("'{}' is a massless link between its bodies", def.relative_to),
          "a joint with its frames on the bodies; give a link with mass a body of its own");
    }
    check_inertia(def.name, def.inertia);
  }

  void check_inertia(const std::string& name, Triple I) {
    std::sort(I.begin(), I.end());
    if (I[0] + I[1] >= I[2] * (1 - kMatrixTolerance)) return;
    add(name + ".inertia", fmt::format("moments {}, {}, {} kg m2 break the triangle rule", I[0], I[1], I[2]),
        "no moment larger than the sum of the other two");
  }

  const MechanicsDef& m_;
  BodyNumbers number_of_{m_};
  Problems& problems_;
  bool names_hold_ = true;
};

}  // namespace

bool check_elements(const MechanicsDef& mechanics, Problems& problems) {
  return ElementValidator(mechanics, problems).run();
}

void check_table(const std::string& path, const Table& table, TableUse use, Problems& problems) {
  if (table.empty()) return;
  const auto add = [&](std::string what, std::string expected) {
    problems.push_back({path, std::move(what), std::move(expected), {}});
  };
  if (table.size() < 2) return add("the table has one point", "two points or more");
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (!(table[i][0] > table[i - 1][0])) return add("the arguments do not increase", "increasing arguments");
  }
  if (use == TableUse::rope_spring && (table[0][0] != 0 || table[0][1] != 0)) {
    return add("a rope's table begins elsewhere than at [0, 0]", "tension over stretch, from [0, 0] on");
  }
  if (use != TableUse::damper) return;
  const bool has_rest = std::any_of(table.begin(), table.end(), [](const auto& p) { return p[0] == 0 && p[1] == 0; });
  const bool drives = std::any_of(table.begin(), table.end(), [](const auto& p) { return p[0] * p[1] < 0; });
  if (drives) return add("the damper drives: a force has the sign against its speed", "forces with their speed's sign");
  if (!has_rest) add("the damper's table has no point [0, 0]", "a point [0, 0]: no force at rest");
}

}  // namespace slew::multibody
