// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/bushing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "multibody/forces/build_elements.h"
#include "multibody/forces/force_fields.h"
#include "multibody/forces/matrix_rules.h"
#include "multibody/forces/validate_elements.h"

namespace slew::multibody {
namespace {

// constants of a bushing along its three axes, or about them
template <auto Member>
constexpr Field bushing_triple(std::string_view key, Dimension dimension, const Range& range, std::string_view doc) {
  return field<Member>(key, {.dimension = dimension, .range = range, .change = Change::live, .doc = doc});
}
template <auto Tables, auto Member>
constexpr Field bushing_table(std::string_view key, Dimension argument, Dimension value, std::string_view doc) {
  return field<Tables, Member>(key, {.dimension = argument, .value_dimension = value, .doc = doc});
}

constexpr std::string_view kSpringTableDoc = "force that holds a deflection, added to the springs";
constexpr std::string_view kDamperTableDoc = "force that holds a speed, added to the dampers";

constexpr Field kBushingFields[] = {
    connector_body<&BushingDef::frames, &ConnectorFrames::body1>("body1", "first body"),
    connector_point<&BushingDef::frames, &ConnectorFrames::point1>("point1", "origin of frame 1 in body 1"),
    connector_axes<&BushingDef::frames, &ConnectorFrames::orientation1>(
        "orientation1", "frame 1 in body 1: rotations about x, y', z''"),
    connector_body<&BushingDef::frames, &ConnectorFrames::body2>("body2", "second body"),
    connector_point<&BushingDef::frames, &ConnectorFrames::point2>("point2", "origin of frame 2 in body 2"),
    connector_axes<&BushingDef::frames, &ConnectorFrames::orientation2>(
        "orientation2", "frame 2 in body 2: rotations about x, y', z''"),
    bushing_triple<&BushingDef::stiffness>("stiffness", Dimension::stiffness, kNotNegative,
                                           "springs along the axes of frame 1"),
    bushing_triple<&BushingDef::rotational_stiffness>("rotational_stiffness", Dimension::rotational_stiffness,
                                                      kNotNegative, "springs about the axes of frame 1"),
    bushing_triple<&BushingDef::damping>("damping", Dimension::damping, kNotNegative,
                                         "dampers along the axes of frame 1"),
    bushing_triple<&BushingDef::rotational_damping>("rotational_damping", Dimension::rotational_damping, kNotNegative,
                                                    "dampers about the axes of frame 1"),
    field<&BushingDef::stiffness_matrix>(
        "stiffness_matrix",
        {.doc = "6 x 6 in SI, row by row, symmetric; added to the springs (x, y, z, about x, y, z)"}),
    field<&BushingDef::damping_matrix>("damping_matrix",
                                       {.doc = "6 x 6 in SI, row by row, symmetric; added to the dampers"}),
    bushing_triple<&BushingDef::preload_force>("preload_force", Dimension::force, kFinite,
                                               "force on body 2 without deflection, axes of frame 1"),
    bushing_triple<&BushingDef::preload_moment>("preload_moment", Dimension::torque, kFinite,
                                                "moment on body 2 without deflection, axes of frame 1"),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::x>("spring_table_x", Dimension::length,
                                                                   Dimension::force, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::y>("spring_table_y", Dimension::length,
                                                                   Dimension::force, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::z>("spring_table_z", Dimension::length,
                                                                   Dimension::force, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::about_x>("spring_table_about_x", Dimension::angle,
                                                                         Dimension::torque, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::about_y>("spring_table_about_y", Dimension::angle,
                                                                         Dimension::torque, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::about_z>("spring_table_about_z", Dimension::angle,
                                                                         Dimension::torque, kSpringTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::x>("damper_table_x", Dimension::velocity,
                                                                   Dimension::force, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::y>("damper_table_y", Dimension::velocity,
                                                                   Dimension::force, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::z>("damper_table_z", Dimension::velocity,
                                                                   Dimension::force, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::about_x>(
        "damper_table_about_x", Dimension::angular_velocity, Dimension::torque, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::about_y>(
        "damper_table_about_y", Dimension::angular_velocity, Dimension::torque, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::about_z>(
        "damper_table_about_z", Dimension::angular_velocity, Dimension::torque, kDamperTableDoc),
};

constexpr std::array<std::string_view, 18> kBushingKeys = {"stiffness.x",
                                                           "stiffness.y",
                                                           "stiffness.z",
                                                           "rotational_stiffness.x",
                                                           "rotational_stiffness.y",
                                                           "rotational_stiffness.z",
                                                           "damping.x",
                                                           "damping.y",
                                                           "damping.z",
                                                           "rotational_damping.x",
                                                           "rotational_damping.y",
                                                           "rotational_damping.z",
                                                           "preload_force.x",
                                                           "preload_force.y",
                                                           "preload_force.z",
                                                           "preload_moment.x",
                                                           "preload_moment.y",
                                                           "preload_moment.z"};

Six six_of(const Triple& along, const Triple& about) {
  return {along[0], along[1], along[2], about[0], about[1], about[2]};
}

void check_matrix(const std::string& path, const std::vector<double>& matrix, ElementRules& rules) {
  if (matrix.empty()) return;
  if (matrix.size() != 36) {
    rules.add(path, fmt::format("the matrix has {} numbers", matrix.size()), "36: six rows of six");
    return;
  }
  const auto [row, column] = find_asymmetry(matrix);
  if (row < 0) return;
  rules.add(path, fmt::format("the matrix is not symmetric in row {}, column {}", row + 1, column + 1),
            "a symmetric matrix: one that comes of an energy");
}

// row i of a full matrix times a column
double row_times(const SixBySix& matrix, std::size_t i, const Six& x) noexcept {
  double sum = 0;
  for (std::size_t j = 0; j < 6; ++j) sum += matrix[6 * i + j] * x[j];
  return sum;
}

}  // namespace

bool holds_rotation(const Bushing& bushing) noexcept {
  for (std::size_t i = 3; i < 6; ++i) {
    if (bushing.spring[i] != 0 || bushing.damping[i] != 0) return true;
    for (std::size_t j = 0; j < 6; ++j) {
      if (bushing.K[6 * i + j] != 0 || bushing.D[6 * i + j] != 0) return true;
    }
  }
  return std::any_of(bushing.curves.begin(), bushing.curves.end(),
                     [](const DirectionCurve& one) { return one.direction >= 3; });
}

Six force_of(const Bushing& bushing, const Deflection& deflection) noexcept {
  Six Q;
  for (std::size_t i = 0; i < 6; ++i) {
    Q[i] = bushing.preload[i] - bushing.spring[i] * deflection.x[i] - bushing.damping[i] * deflection.rate[i];
  }
  if (bushing.has_coupling) {
    for (std::size_t i = 0; i < 6; ++i) {
      Q[i] -= row_times(bushing.K, i, deflection.x) + row_times(bushing.D, i, deflection.rate);
    }
  }
  for (const DirectionCurve& own : bushing.curves) {
    const auto i = static_cast<std::size_t>(own.direction);
    Q[i] -= math::value_at(own.curve, own.is_damper ? deflection.rate[i] : deflection.x[i]);
  }
  return Q;
}

SixBySix slopes_of(const Bushing& bushing, const Deflection& deflection, ChangeWeights weights) noexcept {
  SixBySix A{};
  if (bushing.has_coupling) {
    for (std::size_t i = 0; i < A.size(); ++i) A[i] = weights.position * bushing.K[i] + weights.rate * bushing.D[i];
  }
  for (std::size_t i = 0; i < 6; ++i) {
    A[7 * i] += weights.position * bushing.spring[i] + weights.rate * bushing.damping[i];
  }
  for (const DirectionCurve& own : bushing.curves) {
    const auto i = static_cast<std::size_t>(own.direction);
    const double slope = math::slope_at(own.curve, own.is_damper ? deflection.rate[i] : deflection.x[i]);
    A[7 * i] += (own.is_damper ? weights.rate : weights.position) * std::max(0.0, slope);
  }
  return A;
}

double stored_energy(const Bushing& bushing, const Deflection& deflection) noexcept {
  const Six& x = deflection.x;
  double energy = 0;
  for (std::size_t i = 0; i < 6; ++i) energy += x[i] * (0.5 * bushing.spring[i] * x[i] - bushing.preload[i]);
  if (bushing.has_coupling) {
    for (std::size_t i = 0; i < 6; ++i) energy += 0.5 * x[i] * row_times(bushing.K, i, x);
  }
  for (const DirectionCurve& own : bushing.curves) {
    if (!own.is_damper) energy += math::integral_to(own.curve, x[static_cast<std::size_t>(own.direction)]);
  }
  return energy;
}

WrenchPair wrenches_of(const Bushing& bushing, const LinkMotion& link1, const LinkMotion& link2) noexcept {
  const Deflection deflection = deflection_of(bushing.frames, link1, link2);
  return wrenches_of(deflection, force_of(bushing, deflection), link1, link2);
}

std::span<const Field> bushing_fields() noexcept {
  return kBushingFields;
}

Bushing BushingRow::build(const BushingDef& def, ElementBuilder& builder) {
  Bushing bushing{.name = def.name,
                  .frames = builder.frames_of(def.frames),
                  .spring = six_of(def.stiffness, def.rotational_stiffness),
                  .damping = six_of(def.damping, def.rotational_damping),
                  .preload = six_of(def.preload_force, def.preload_moment)};
  std::copy(def.stiffness_matrix.begin(), def.stiffness_matrix.end(), bushing.K.begin());
  std::copy(def.damping_matrix.begin(), def.damping_matrix.end(), bushing.D.begin());
  bushing.has_coupling = !def.stiffness_matrix.empty() || !def.damping_matrix.empty();
  for (int i = 0; i < 6; ++i) {
    const Table& spring = *def.spring_tables.all()[static_cast<std::size_t>(i)];
    const Table& damper = *def.damper_tables.all()[static_cast<std::size_t>(i)];
    if (!spring.empty()) bushing.curves.push_back({i, false, math::monotone_cubic(spring, math::Ends::continued)});
    if (!damper.empty()) bushing.curves.push_back({i, true, math::monotone_cubic(damper, math::Ends::not_falling)});
  }
  return bushing;
}

void BushingRow::check(const BushingDef& def, ElementRules& rules) {
  rules.check_connector(def.name, def.frames);
  check_matrix(def.name + ".stiffness_matrix", def.stiffness_matrix, rules);
  check_matrix(def.name + ".damping_matrix", def.damping_matrix, rules);
  if (def.damping_matrix.size() == 36 && find_asymmetry(def.damping_matrix).row < 0) {
    std::vector<double> total = def.damping_matrix;
    for (std::size_t i = 0; i < 3; ++i) {
      total[7 * i] += def.damping[i];
      total[7 * (i + 3)] += def.rotational_damping[i];
    }
    if (!is_positive_semidefinite(total)) {
      rules.add(def.name + ".damping_matrix", "some motion gets energy from the dampers",
                "a positive semi-definite matrix, damping and rotational_damping added");
    }
  }
  constexpr const char* kDirections[] = {"x", "y", "z", "about_x", "about_y", "about_z"};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto path = [&](const char* key) { return fmt::format("{}.{}_{}", def.name, key, kDirections[i]); };
    rules.check_table(path("spring_table"), *def.spring_tables.all()[i], TableUse::spring);
    rules.check_table(path("damper_table"), *def.damper_tables.all()[i], TableUse::damper);
  }
}

void BushingRow::check_start(const BushingDef& def, ElementStartRules& rules) {
  const double turn = norm(rules.deflection(def.frames).theta);
  if (turn < kMostBushingRotation) return;
  rules.add(def.name + ".orientation2",
            fmt::format("the frames are turned by {:.4g} deg at the start", turn * 180 / M_PI),
            "frames turned by less than 170 deg");
}

void BushingRow::silence(Bushing& bushing) {
  const std::string name = bushing.name;
  const FramePair frames = bushing.frames;
  bushing = {.name = name, .frames = frames};
}

std::span<const std::string_view> BushingRow::value_keys(const Bushing& /*bushing*/) noexcept {
  return kBushingKeys;
}

double* BushingRow::value(Bushing& bushing, std::size_t index) noexcept {
  if (index < 6) return &bushing.spring[index];
  return index < 12 ? &bushing.damping[index - 6] : &bushing.preload[index - 12];
}

}  // namespace slew::multibody
