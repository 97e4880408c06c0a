// SPDX-License-Identifier: Apache-2.0
// Newton's method onto the closing rows, in the metric of the masses, for assembly.cpp alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/index.h"
#include "multibody/build/assembly.h"
#include "multibody/build/singular_start.h"
#include "multibody/constraints/constraint.h"
#include "multibody/constraints/loops.h"
#include "multibody/flexible/deflection.h"
#include "multibody/formulations/passes.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

// pivot below which a row is taken as dependent: axes that should be parallel may be off by its root
inline constexpr double kDependentAtStart = 1e-8;
inline constexpr int kMostAssemblyIterations = 100;
inline constexpr int kMostAssemblyHalvings = 20;
inline constexpr double kNearTurn = 0.05;  // rad, distance of the nearby positions
inline constexpr double kSlide = 0.02;     // share of the mechanism's size
inline constexpr double kNearBend = 2e-3;  // rad, of a mode there: well above the root of kDependentAtStart
inline constexpr double kHeavy = 1e4;      // factor of the modes' masses where joints shall move in their place
// Ratio of a gear beyond which the speed of its slow joint sets that of the fast one before the projection. The row of
// the slow joint differs from the gear's by the square of the ratio, where kDependentAtStart takes it as dependent.
inline constexpr double kSteepGear = 100;
// violation of a loop by given speeds above which it is reported
inline constexpr double kAssembledSpeed = 1e-6;

// Works on the model's present rows; rebuilt when they change.
class Assembler {
 public:
  explicit Assembler(const Model& model) : model_(model), ws_(model), state_(start_state(model)) {}

  [[nodiscard]] State& state() { return state_; }

  // Newton's method for the independent rows, with damping
  void close() { close_with(1); }

  // The same, by joints wherever they can: a body that bends as far as its masses alone would have it may be beyond
  // what its modes describe.
  void close_by_joints() { close_with(kHeavy); }

  // False where bodies bend so far that the mass matrix of their modes belongs to no body: some row has no mobility.
  [[nodiscard]] bool has_masses() {
    renew(state_);
    for (std::size_t k = 0; k < ws_.loops.rows.size(); ++k) {
      if (!(ws_.loops.mobility(k) >= 0)) return false;
    }
    return true;
  }

  [[nodiscard]] std::vector<bool> dependent_rows() {
    renew(state_);
    std::vector<bool> is_dependent;
    for (int k = 0; k < model_.closing_row_count(); ++k) is_dependent.push_back(ws_.loops.factor.is_redundant(k));
    return is_dependent;
  }

  // Mobility of a coordinate of the tree under all rows, as a share of its mobility without them: 0 if they hold it. At
  // the position of the last dependent_rows().
  [[nodiscard]] double freedom(std::size_t u) {
    const LoopWorkspace& loops = ws_.loops;
    const std::size_t speeds = state_.u.size();
    std::vector<int> all_links;
    for (int link = static_cast<int>(model_.links.size()) - 1; link > 0; --link) all_links.push_back(link);
    std::vector<double> tau(speeds), residual(speeds), rate(speeds), forces(loops.rows.size());
    tau[u] = 1;
    solve_backward(model_, ws_, all_links, tau, residual, rate);
    const auto product = [speeds](const double* a, const std::vector<double>& b) {
      double sum = 0;
      for (std::size_t j = 0; j < speeds; ++j) sum += a[j] * b[j];
      return sum;
    };
    for (std::size_t k = 0; k < forces.size(); ++k) forces[k] = product(&loops.residual[k * speeds], rate);
    const std::vector<double> moved = forces;
    loops.factor.solve(forces);
    const double whole = product(residual.data(), rate);
    double left = whole;
    for (std::size_t k = 0; k < forces.size(); ++k) left -= forces[k] * moved[k];
    return whole > 0 ? left / whole : 0;
  }

  // What rounding leaves of a freedom() that is 0.
  [[nodiscard]] double rounding_of_freedom() const {
    constexpr double kRounding = 1e-14, kLargest = 1e-6;
    return std::min(kLargest, kRounding / ws_.loops.factor.smallest_pivot());
  }

  // A nearby position, selected by seed; bend: largest turn of a node by a mode [rad]. The terms of a mass matrix that
  // the modes leave out grow with it, beside the inertia of a slender body about its axis.
  void move_away(std::uint64_t seed, double bend) {
    renew(state_);
    double size = 0;
    for (const LinkMotion& m : ws_.motion) size = std::max(size, norm(m.r));
    std::uint64_t random = seed;
    const auto uniform = [&random] {
      random = random * 6364136223846793005U + 1442695040888963407U;
      return static_cast<double>(random >> 11) * 0x1p-52 - 1;
    };
    std::vector<double> step(state_.u.size());
    for (double& x : step) x = kNearTurn * uniform();
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      const double slide = kSlide / kNearTurn * (size > 0 ? size : 1);
      if (link.joint == LinkJoint::prismatic) step[at(link.u)] *= slide;
      if (link.joint == LinkJoint::cylindrical) step[at(link.u) + 1] *= slide;
      if (link.joint == LinkJoint::floating) std::for_each_n(&step[at(link.u)], 3, [&](double& x) { x *= slide; });
      const auto u = at(link.u);
      if (link.joint == LinkJoint::spherical) ws_.delta_alpha[i] = {step[u], step[u + 1], step[u + 2]};
      if (link.joint == LinkJoint::floating) ws_.delta_alpha[i] = {step[u + 3], step[u + 4], step[u + 5]};
    }
    for (const FlexiblePart& part : model_.parts) {
      for (std::size_t mode = 0; mode < part.modes; ++mode)
        step[at(part.u) + mode] *= bend / (kNearTurn * largest_turn(*part.source, part.length, mode));
    }
    displace(model_, ws_, step, state_.q);
  }

  // the largest mobility among the rows of a cut that have the same unit, by row
  [[nodiscard]] std::vector<double> mobilities() {
    renew(state_);
    const std::size_t rows = ws_.loops.rows.size();
    std::vector<double> result(rows);
    for (const Cut& cut : model_.cuts) {
      for (std::size_t i = 0; i < cut.rows.size(); ++i) {
        for (std::size_t k = 0; k < cut.rows.size(); ++k) {
          const bool is_alike = is_angle(cut.rows[i].form) == is_angle(cut.rows[k].form);
          const std::size_t other = at(cut.first_row) + k;
          double& largest = result[at(cut.first_row) + i];
          if (is_alike) largest = std::max(largest, ws_.loops.mobility(other));
        }
      }
    }
    for (auto k = at(model_.cut_row_count()); k < rows; ++k) result[k] = ws_.loops.mobility(k);
    return result;
  }

  [[nodiscard]] std::vector<AssemblyReport::Row> open_rows() {
    update_motion(model_, state_.q, state_.u, ws_);
    std::vector<AssemblyReport::Row> open;
    for (const Cut& cut : model_.cuts) {
      const auto see = [&](const ConstraintRow& row) {
        const double g = evaluate(row, cut, ws_.motion[at(cut.link1)], ws_.motion[at(cut.link2)], ws_.drives).g;
        if (!(std::fabs(g) <= kFrameTolerance)) open.push_back({cut.joint, describe(row), std::fabs(g), {}});
      };
      for (const ConstraintRow& row : cut.rows) see(row);
      for (const ConstraintRow& row : cut.redundant) see(row);
    }
    for (const std::vector<Gear>* gears : {&model_.gears, &model_.idle_gears}) {
      for (const Gear& gear : *gears) {
        const double g = gear_value(gear, model_, state_.q, state_.u, ws_).g;
        if (!(std::fabs(g) <= kFrameTolerance)) open.push_back({gear.ends[1].joint, "gear", std::fabs(g), gear.name});
      }
    }
    return open;
  }

  // Speeds that the scene gives and those of modes stay, the others follow: a projection in which they are rows of
  // their own.
  [[nodiscard]] std::vector<AssemblyReport::Speed> settle_speeds() {
    std::vector<std::size_t> given = given_speeds(), modal;
    for_each_mode(model_, [&](std::size_t, std::size_t u) { modal.push_back(u); });
    const bool has_modal_rates =
        std::any_of(modal.begin(), modal.end(), [&](std::size_t u) { return state_.u[u] != 0; });
    if (given.empty() && model_.given_speeds.empty() && model_.drives.empty() && !has_modal_rates) return {};
    const std::vector<double> wanted = state_.u;
    renew(state_);
    const std::size_t cuts = ws_.loops.rows.size(), first_cut_speed = cuts + given.size();
    const std::size_t first_modal = first_cut_speed + model_.given_speeds.size();
    const std::size_t rows = first_modal + modal.size(), speeds = state_.u.size();
    std::vector<double> residual(rows * speeds), rate(rows * speeds), right(rows);
    std::copy(ws_.loops.residual.begin(), ws_.loops.residual.end(), residual.begin());
    std::copy(ws_.loops.rate.begin(), ws_.loops.rate.end(), rate.begin());
    std::vector<int> all_links;
    for (int link = static_cast<int>(model_.links.size()) - 1; link > 0; --link) all_links.push_back(link);
    const auto hold = [&](std::size_t speed, std::size_t row) {
      std::vector<double> tau(speeds);
      tau[speed] = 1;
      const std::size_t first = row * speeds;
      solve_backward(model_, ws_, all_links, tau, {&residual[first], speeds}, {&rate[first], speeds});
    };
    for (std::size_t k = 0; k < given.size(); ++k) hold(given[k], cuts + k);
    // the last rows: if rigid motion alone cannot close the loops, modal speeds change
    for (std::size_t k = 0; k < modal.size(); ++k) hold(modal[k], first_modal + k);
    for (std::size_t k = 0; k < model_.given_speeds.size(); ++k) {
      const GivenSpeed& speed = model_.given_speeds[k];
      const Cut& cut = model_.cuts[at(speed.cut)];
      const RowValue row = row_of(speed);
      const std::size_t first = (first_cut_speed + k) * speeds;
      solve_backward(model_, ws_, all_links, cut.link1, cut.link2, {&row, 1}, {&residual[first], speeds},
                     {&rate[first], speeds});
      right[first_cut_speed + k] = speed.speed - row.rate;
    }
    math::Semidefinite factor(static_cast<int>(rows));
    factor.factorize(products(residual, rate, rows), vanishing(rows), kDependentAtStart);
    for (std::size_t k = 0; k < cuts; ++k) right[k] = -ws_.loops.rows[k].rate;
    factor.solve(right);
    std::fill(ws_.residual.begin(), ws_.residual.end(), 0.0);
    for (std::size_t k = 0; k < rows; ++k) {
      for (std::size_t j = 0; j < speeds; ++j) ws_.residual[j] += residual[k * speeds + j] * right[k];
    }
    solve_forward(model_, ws_, ws_.residual, ws_.loops.step);
    for (std::size_t j = 0; j < speeds; ++j) state_.u[j] += ws_.loops.step[j];
    for (const std::size_t j : given)
      state_.u[j] = std::fabs(state_.u[j] - wanted[j]) < 1e-12 ? wanted[j] : state_.u[j];
    return lost_speeds(wanted, given);
  }

  [[nodiscard]] std::vector<AssemblyReport::Singular> singular_rows() {
    renew(state_);
    return find_singular_rows(model_, kDependentAtStart, ws_);
  }

 private:
  // modal_inertia: factor of the modes' own masses
  void close_with(double modal_inertia) {
    for (int i = 0; i < kMostAssemblyIterations; ++i) {
      renew(state_, modal_inertia);
      const double before = independent_violation();
      if (before <= kClosed * extent_of(ws_).length || !std::isfinite(before)) return;
      find_step([](const RowValue& row) { return row.g; });
      const State from = state_;
      for (int halving = 0; halving < kMostAssemblyHalvings; ++halving) {
        state_.q = from.q;
        solve_forward(model_, ws_, ws_.residual, ws_.loops.step);
        displace(model_, ws_, ws_.loops.step, state_.q);
        update_motion(model_, state_.q, state_.u, ws_);
        evaluate_cuts(model_, state_.q, state_.u, ws_);
        if (independent_violation() < before) break;
        for (double& r : ws_.residual) r *= 0.5;
        update_motion(model_, from.q, from.u, ws_);
      }
    }
  }

  // Coordinates of the tree with a given speed, and those that a steep gear sets from one of them.
  [[nodiscard]] std::vector<std::size_t> given_speeds() {
    const std::size_t speeds = state_.u.size();
    std::vector<char> is_given(speeds);
    for (std::size_t j = 0; j < speeds; ++j) is_given[j] = model_.start_is_given[j] != 0 && !is_prescribed(j) ? 1 : 0;
    // along a train of gears
    for (bool has_found = true; has_found;) {
      has_found = false;
      for (const Gear& gear : model_.gears) {
        for (std::size_t slow : {std::size_t{0}, std::size_t{1}}) {
          const GearEnd &from = gear.ends[slow], &to = gear.ends[1 - slow];
          if (is_given[at(from.u)] == 0 || is_given[at(to.u)] != 0 || is_prescribed(at(to.u))) continue;
          if (!(std::fabs(from.factor) > kSteepGear * std::fabs(to.factor)) || to.factor == 0) continue;
          state_.u[at(to.u)] = -from.factor / to.factor * state_.u[at(from.u)];
          is_given[at(to.u)] = 1;
          has_found = true;
        }
      }
    }
    std::vector<std::size_t> given;
    for (std::size_t j = 0; j < speeds; ++j) {
      if (is_given[j] != 0) given.push_back(j);
    }
    return given;
  }

  [[nodiscard]] bool is_prescribed(std::size_t speed) const {
    return std::any_of(model_.drives.begin(), model_.drives.end(),
                       [speed](const Drive& drive) { return drive.u == static_cast<int>(speed); });
  }

  void renew(const State& state, double modal_inertia = 1) {
    update_motion(model_, state.q, state.u, ws_);
    update_elements(model_, state.q, Elements::used, ws_);
    update_inertia(model_, ws_);
    for (PartMotion& part : ws_.parts) {
      const std::size_t modes = part.q.size();
      for (std::size_t k = 0; k < modes; ++k) part.E[k * (modes + 1)] *= modal_inertia;
    }
    update_coupled(model_, ws_);
    std::fill(ws_.tau.begin(), ws_.tau.end(), 0.0);
    factorize(model_, ws_);
    evaluate_cuts(model_, state.q, state.u, ws_);
    factorize_cuts(model_, ws_, kDependentAtStart);
  }

  [[nodiscard]] double independent_violation() const {
    double largest = 0;
    for (std::size_t k = 0; k < ws_.loops.rows.size(); ++k) {
      if (ws_.loops.factor.is_redundant(static_cast<int>(k))) continue;
      const double size = std::fabs(ws_.loops.rows[k].g);
      if (!(size <= largest)) largest = size;
    }
    return largest;
  }

  template <typename Value>
  void find_step(Value value) {
    LoopWorkspace& loops = ws_.loops;
    const std::size_t speeds = state_.u.size();
    for (std::size_t k = 0; k < loops.rows.size(); ++k) loops.multipliers[k] = -value(loops.rows[k]);
    loops.factor.solve(loops.multipliers);
    std::fill(ws_.residual.begin(), ws_.residual.end(), 0.0);
    for (std::size_t k = 0; k < loops.rows.size(); ++k) {
      for (std::size_t j = 0; j < speeds; ++j) {
        ws_.residual[j] += loops.residual[k * speeds + j] * loops.multipliers[k];
      }
    }
  }

  // Scales below which rows of loops are zero by rounding, as kDependent of their mobility elsewhere; of other rows 0.
  [[nodiscard]] std::vector<double> vanishing(std::size_t rows) const {
    std::vector<double> scales(rows);
    for (std::size_t k = 0; k < model_.cut_reference.size(); ++k) {
      scales[k] = model_.cut_reference[k] * (kDependent / kDependentAtStart);
    }
    return scales;
  }

  // residuals times rates of all rows, lower triangle
  [[nodiscard]] static std::vector<double> products(const std::vector<double>& residual,
                                                    const std::vector<double>& rate, std::size_t rows) {
    const std::size_t speeds = rows > 0 ? residual.size() / rows : 0;
    std::vector<double> W(rows * rows);
    for (std::size_t k = 0; k < rows; ++k) {
      for (std::size_t l = 0; l <= k; ++l) {
        for (std::size_t j = 0; j < speeds; ++j) W[k * rows + l] += residual[k * speeds + j] * rate[l * speeds + j];
      }
    }
    return W;
  }

  // rate of a coordinate of a joint that is cut; of a spherical joint about an axis of body 1
  [[nodiscard]] RowValue row_of(const GivenSpeed& speed) const {
    const Cut& cut = model_.cuts[at(speed.cut)];
    const Joint& joint = model_.joints[at(cut.joint)];
    const LinkMotion &link1 = ws_.motion[at(cut.link1)], &link2 = ws_.motion[at(cut.link2)];
    if (joint.type != JointType::spherical) return coordinate(joint.type, speed.number, cut, link1, link2);
    const math::Vec3 axis = link1.R * model_.bodies[at(joint.body1)].R_LB.c[speed.number];
    return {.rate = dot(axis, link2.w - link1.w), .G = {math::Vec3(), -axis, math::Vec3(), axis}};
  }

  [[nodiscard]] std::vector<AssemblyReport::Speed> lost_speeds(const std::vector<double>& wanted,
                                                               const std::vector<std::size_t>& given) {
    std::vector<AssemblyReport::Speed> lost;
    const auto see = [&lost](std::string_view joint, double asked, double found) {
      if (std::fabs(found - asked) <= kAssembledSpeed * std::max(1.0, std::fabs(asked))) return;
      lost.push_back({std::string(joint), asked, found});
    };
    for (const std::size_t j : given) {
      see(joint_of(model_, model_.coordinate_count() + static_cast<int>(j)), wanted[j], state_.u[j]);
    }
    update_motion(model_, state_.q, state_.u, ws_);
    for (const GivenSpeed& speed : model_.given_speeds) {
      see(model_.joints[at(model_.cuts[at(speed.cut)].joint)].name, speed.speed, row_of(speed).rate);
    }
    return lost;
  }

  const Model& model_;
  Workspace ws_;
  State state_;
};

}  // namespace slew::multibody
