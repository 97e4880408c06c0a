// SPDX-License-Identifier: Apache-2.0
#include "tests/peers/multibody/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "build_paths.h"
#include "multibody/constraints/loops.h"
#include "scene/scene.h"
#include "tests/properties/multibody/random_loops.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"

namespace slew::multibody::testing {
namespace {

using math::Vec3;

// largest |a - b| and largest |b| of one quantity of all bodies
struct Spread {
  double difference = 0, largest = 0;
  void add(Vec3 a, Vec3 b) {
    grow(difference, norm(a - b));
    grow(largest, norm(b));
  }
  void add(double a, double b) { add(Vec3(a, 0, 0), Vec3(b, 0, 0)); }
};

// of an angular and a linear quantity, with 1 m between them and at least 1 SI unit of either
double relative(const Spread& angular, const Spread& linear) {
  const double scale = std::max({angular.largest, linear.largest, 1.0});
  return std::max(angular.difference, linear.difference) / scale;
}

}  // namespace

void grow(double& largest, double x) {
  largest = std::isfinite(x) ? std::max(largest, x) : HUGE_VAL;
}

std::vector<Case> cases() {
  std::vector<Case> list;
  for (unsigned seed = 1; seed <= 12; ++seed) list.push_back({Case::Kind::truck_crane, seed});
  for (unsigned seed = 1; seed <= 48; ++seed) list.push_back({Case::Kind::random_tree, seed});
  return list;
}

std::vector<Case> loop_cases() {
  std::vector<Case> list;
  for (unsigned seed = 1; seed <= 4; ++seed) list.push_back({Case::Kind::crane_cylinders, seed});
  for (unsigned seed = 1; seed <= 48; ++seed) list.push_back({Case::Kind::random_loops, seed});
  for (const char* scene :
       {"four_bar", "slider_crank", "joints/cylindrical", "joints/fixed", "joints/floating", "joints/in_line",
        "joints/in_plane", "joints/perpendicular", "joints/prismatic", "joints/revolute", "joints/revolute_revolute",
        "joints/revolute_spherical", "joints/spherical", "joints/spherical_spherical", "joints/universal"}) {
    for (unsigned seed = 1; seed <= 2; ++seed) list.push_back({Case::Kind::scene, seed, scene});
  }
  return list;
}

bool has_loops(const Case& chosen) {
  return chosen.kind != Case::Kind::truck_crane && chosen.kind != Case::Kind::random_tree;
}

void PrintTo(const Case& chosen, std::ostream* out) {
  constexpr const char* kNames[] = {"TruckCrane", "RandomTree", "CraneCylinders", "RandomLoops", "Scene_"};
  std::string scene = chosen.scene;
  std::replace(scene.begin(), scene.end(), '/', '_');
  *out << kNames[static_cast<int>(chosen.kind)] << scene << (scene.empty() ? "" : "_") << chosen.seed;
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  return ::testing::PrintToString(info.param);
}

MechanicsDef truck_crane(std::vector<std::string>& rows) {
  scene::Scene scene = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml");
  // at random states the shapes are metres deep in each other, and laws of contact are not the peers'
  scene.mechanics.contacts.clear();
  for (const scene::PortDef& port : scene.ports) rows.push_back(port.force);
  for (const std::string& joint : joint_rows(scene.mechanics)) rows.push_back(joint);
  return scene.mechanics;
}

namespace {

// Def and rows of a case
RandomTree mechanism_of(const Case& chosen) {
  RandomTree tree;
  switch (chosen.kind) {
    case Case::Kind::truck_crane:
      tree.def = truck_crane(tree.rows);
      break;
    case Case::Kind::random_tree:
      return random_tree(chosen.seed, {.bodies = 2 + static_cast<int>(chosen.seed) % 9});
    case Case::Kind::crane_cylinders:
      tree.def = crane_def();
      tree.rows = {"ForceT_Lift", "ForceT_Jib", "ForceR_Pillar"};
      for (const char* force : {"ForceT_Lift", "ForceT_Jib"}) replace_dummies(tree.def, force, {0, 0, 1});
      break;
    case Case::Kind::random_loops:
      tree = random_loops(chosen.seed);
      // of two joints on one coordinate the tree may hold the later one; forces may act between merged bodies
      std::erase_if(tree.rows, [&](const std::string& row) {
        Problems problems;
        validate_rows(tree.def, std::vector<std::string>{row}, problems);
        return row[0] != 'F' || !problems.empty();
      });
      break;
    case Case::Kind::scene:
      tree.def = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + chosen.scene + ".yaml").mechanics;
      break;
  }
  return tree;
}

// speeds of about one m/s and rad/s more that keep the loops closed, and 20 ms on
void move_at_random(unsigned seed, Mechanism& mechanism) {
  std::mt19937 random(seed);
  for (double& speed : mechanism.state.u) speed += std::uniform_real_distribution<double>(-1, 1)(random);
  if (!mechanism.model.cuts.empty()) {
    forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
    EXPECT_TRUE(project(mechanism.model, mechanism.state.q, mechanism.state.u, mechanism.ws));
  }
  mechanism.run(0.02, 1e-4);
}

}  // namespace

Sample::Sample(const Case& chosen, ForceDummies dummies) {
  const RandomTree tree = mechanism_of(chosen);
  def = tree.def;
  rows = tree.rows;
  if (dummies == ForceDummies::without) def.force_dummies.clear();
  Mechanism mechanism(def, rows);
  if (has_loops(chosen)) {
    move_at_random(chosen.seed, mechanism);
    state = mechanism.state;
  } else {
    state = random_state(chosen.seed, mechanism.model);
  }
  evaluate(mechanism.model, state, mechanism.ws);
  std::mt19937 random(chosen.seed);
  std::uniform_real_distribution<double> acceleration(-10, 10);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    // a row that the joints lock moves by rounding
    constexpr double kLocked = 1e-12;
    const double W = row_mobility(mechanism.ws)[k * rows.size() + k];
    row_forces.push_back(acceleration(random) / (W > kLocked ? W : 1));
  }
}

MechanicsDef undamped(MechanicsDef def) {
  for (TranslationalForceDef& force : def.translational_forces) {
    force.damping_constant = force.end_damping_constant = 0;
  }
  for (RotationalForceDef& force : def.rotational_forces) force.damping_constant = force.end_damping_constant = 0;
  return def;
}

MechanicsDef bare(MechanicsDef def) {
  def = undamped(std::move(def));
  def.gravity = {};
  for (TranslationalForceDef& force : def.translational_forces) {
    force.spring_constant = force.end_spring_constant = 0;
  }
  for (RotationalForceDef& force : def.rotational_forces) force.spring_constant = force.end_spring_constant = 0;
  return def;
}

Wrenches row_wrenches(const Sample& sample, std::span<const double> row_forces, const Motions& motions) {
  Wrenches wrenches(motions.size());
  for (std::size_t k = 0; k < row_forces.size(); ++k) {
    add_row_force(sample.def, sample.rows[k], row_forces[k], motions, wrenches);
  }
  return wrenches;
}

Motions at_rest(Motions motions) {
  for (BodyMotion& m : motions) m.w = m.v = m.alpha = m.a = Vec3();
  return motions;
}

double velocity_difference(const Motions& a, const Motions& b) {
  Spread angular, linear;
  for (std::size_t i = 0; i < b.size(); ++i) {
    angular.add(a[i].w, b[i].w);
    linear.add(a[i].v, b[i].v);
  }
  return relative(angular, linear);
}

double acceleration_difference(const Motions& a, const Motions& b) {
  Spread angular, linear;
  for (std::size_t i = 0; i < b.size(); ++i) {
    angular.add(a[i].alpha, b[i].alpha);
    linear.add(a[i].a, b[i].a);
  }
  return relative(angular, linear);
}

double reaction_difference(const std::vector<JointReaction>& a, const std::vector<JointReaction>& b) {
  Spread force, moment;
  for (std::size_t i = 0; i < b.size(); ++i) {
    force.add(Vec3(a[i].force), Vec3(b[i].force));
    moment.add(Vec3(a[i].moment), Vec3(b[i].moment));
  }
  return relative(force, moment);
}

bool has_redundant_rows(const Model& model) {
  return std::any_of(model.cuts.begin(), model.cuts.end(), [](const Cut& cut) { return !cut.redundant.empty(); });
}

double load_difference(const MechanicsDef& def, const Motions& motions, const std::vector<JointReaction>& a,
                       const std::vector<JointReaction>& b) {
  Wrenches left_over(motions.size());
  Spread force, moment;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const JointDef& joint = def.joints[i];
    const std::size_t body1 = body_number(def, joint.body1), body2 = body_number(def, joint.body2);
    const Vec3 P2 = motion_of_point(motions[body2], frame2(joint).p).p;
    const Vec3 f = Vec3(a[i].force) - Vec3(b[i].force), n = Vec3(a[i].moment) - Vec3(b[i].moment);
    left_over[body1].force += f;
    left_over[body1].torque += n + cross(P2 - motions[body1].p, f);
    left_over[body2].force -= f;
    left_over[body2].torque -= n + cross(P2 - motions[body2].p, f);
    grow(force.largest, norm(Vec3(b[i].force)));
    grow(moment.largest, norm(Vec3(b[i].moment)));
  }
  for (std::size_t i = 1; i < left_over.size(); ++i) {
    grow(force.difference, norm(left_over[i].force));
    grow(moment.difference, norm(left_over[i].torque));
  }
  return relative(force, moment);
}

double square_of(const std::vector<JointReaction>& reactions) {
  double sum = 0;
  for (const JointReaction& r : reactions) {
    sum += dot(Vec3(r.force), Vec3(r.force)) + dot(Vec3(r.moment), Vec3(r.moment));
  }
  return sum;
}

double pose_difference(const Motions& a, const Motions& b) {
  double largest = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    grow(largest, norm(a[i].p - b[i].p));
    // an axis turned by a small angle moves by that angle
    for (int axis = 0; axis < 3; ++axis) grow(largest, norm(a[i].R.c[axis] - b[i].R.c[axis]));
  }
  return largest;
}

void record(const std::string& name, double residual) {
  ::testing::Test::RecordProperty(name, fmt::format("{:.2e}", residual));
}

void expect_same_rows(const RowDifference& difference, double tolerance) {
  record("x", difference.x);
  record("v", difference.v);
  record("a_free", difference.a);
  record("W", difference.W);
  EXPECT_LT(difference.x, tolerance);
  EXPECT_LT(difference.v, tolerance);
  EXPECT_LT(difference.a, tolerance);
  EXPECT_LT(difference.W, tolerance);
}

RowDifference compare_rows(const Sample& sample, const Mechanism& ours, const Motions& free,
                           const std::vector<double>& mobility) {
  const std::size_t n = sample.rows.size();
  const std::span<const double> W = row_mobility(ours.ws);
  RowDifference largest;
  Spread v[2], a[2];
  // of rows that the joints lock the mobility is rounding
  constexpr double kLocked = 1e-5;  // 1/kg or 1/(kg m2)
  const auto own = [&](std::size_t k) { return std::max(W[k * n + k], kLocked); };
  for (std::size_t k = 0; k < n; ++k) {
    const RowMotion row = row_motion(sample.def, sample.rows[k], free);
    const double dx = row.x - row_positions(ours.ws)[k];
    grow(largest.x, std::abs(row.is_angle ? std::remainder(dx, 2 * M_PI) : dx));
    v[row.is_angle].add(row.v, row_speeds(ours.ws)[k]);
    a[row.is_angle].add(row.a, row_free_accelerations(ours.ws)[k]);
    for (std::size_t l = 0; l < n; ++l) {
      const double difference = std::abs(mobility[k * n + l] - W[k * n + l]);
      if (difference > 0) grow(largest.W, difference / std::sqrt(own(k) * own(l)));
    }
  }
  largest.v = relative(v[0], v[1]);
  largest.a = relative(a[0], a[1]);
  return largest;
}

}  // namespace slew::multibody::testing
