#include "tests/peers/multibody/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "build_paths.h"
#include "scene/scene.h"
#include "tests/properties/multibody/random_tree.h"

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
  [[nodiscard]] double relative() const {
    return difference == 0 || std::isinf(difference) ? difference : difference / largest;
  }
};

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

void PrintTo(const Case& chosen, std::ostream* out) {
  *out << (chosen.kind == Case::Kind::truck_crane ? "TruckCrane" : "RandomTree") << chosen.seed;
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  return ::testing::PrintToString(info.param);
}

MechanicsDef truck_crane(std::vector<std::string>& rows) {
  scene::Scene scene = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml");
  scene.mechanics.contacts.clear();
  for (const scene::PortDef& port : scene.ports) rows.push_back(port.force);
  for (const std::string& joint : joint_rows(scene.mechanics)) rows.push_back(joint);
  return scene.mechanics;
}

Sample::Sample(const Case& chosen, ForceDummies dummies) {
  if (chosen.kind == Case::Kind::truck_crane) {
    def = truck_crane(rows);
  } else {
    const RandomTree tree = random_tree(chosen.seed, {.bodies = 2 + static_cast<int>(chosen.seed) % 9});
    def = tree.def;
    rows = tree.rows;
  }
  if (dummies == ForceDummies::without) def.force_dummies.clear();
  Mechanism mechanism(def, rows);
  state = random_state(chosen.seed, mechanism.model);
  evaluate(mechanism.model, state, mechanism.ws);
  std::mt19937 random(chosen.seed);
  std::uniform_real_distribution<double> acceleration(-10, 10);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    row_forces.push_back(acceleration(random) / row_mobility(mechanism.ws)[k * rows.size() + k]);
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
  return std::max(angular.relative(), linear.relative());
}

double acceleration_difference(const Motions& a, const Motions& b) {
  Spread angular, linear;
  for (std::size_t i = 0; i < b.size(); ++i) {
    angular.add(a[i].alpha, b[i].alpha);
    linear.add(a[i].a, b[i].a);
  }
  return std::max(angular.relative(), linear.relative());
}

double reaction_difference(const std::vector<JointReaction>& a, const std::vector<JointReaction>& b) {
  Spread force, moment;
  for (std::size_t i = 0; i < b.size(); ++i) {
    force.add(Vec3(a[i].force), Vec3(b[i].force));
    moment.add(Vec3(a[i].moment), Vec3(b[i].moment));
  }
  return std::max(force.relative(), moment.relative());
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
  for (std::size_t k = 0; k < n; ++k) {
    const RowMotion row = row_motion(sample.def, sample.rows[k], free);
    const double dx = row.x - row_positions(ours.ws)[k];
    grow(largest.x, std::abs(row.is_angle ? std::remainder(dx, 2 * M_PI) : dx));
    v[row.is_angle].add(row.v, row_speeds(ours.ws)[k]);
    a[row.is_angle].add(row.a, row_free_accelerations(ours.ws)[k]);
    for (std::size_t l = 0; l < n; ++l) {
      const double scale = std::sqrt(W[k * n + k] * W[l * n + l]);
      grow(largest.W, std::abs(mobility[k * n + l] - W[k * n + l]) / scale);
    }
  }
  largest.v = std::max(v[0].relative(), v[1].relative());
  largest.a = std::max(a[0].relative(), a[1].relative());
  return largest;
}

}  // namespace slew::multibody::testing
