// SPDX-License-Identifier: Apache-2.0
#include "multibody/constraints/loops.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/index.h"
#include "multibody/constraints/constraint.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

constexpr int kMostClosingCorrections = 40;  // Newton with one matrix: an error of 1e-2 is gone after five
constexpr int kPolish = 2;                   // additional corrections near a singular position, where (1) divides by a
                                             // small number
constexpr int kRenewal = 8;                  // corrections after which the matrix is rebuilt

// sum += the group's rows of `by_row` (rows x speeds) times their forces
void add_rows(const ClosingGroup& group, const std::vector<double>& by_row, const std::vector<double>& forces,
              std::span<double> sum) noexcept {
  const double* row = by_row.data() + at(group.first_row) * sum.size();
  const double* force = forces.data() + group.first_row;
  for (int i = 0; i < group.row_count; ++i, row += sum.size(), ++force) {
    const double f = *force;
    for (const std::size_t j : group.speeds) sum[j] += row[j] * f;
  }
}

// residual += sum of the rows' residuals times their forces
void add_rows(const LoopWorkspace& loops, std::span<double> residual) noexcept {
  for (const ClosingGroup& group : loops.pattern.groups) add_rows(group, loops.residual, loops.multipliers, residual);
}

// loops.step = M^-1 J^T W^-1 times loops.multipliers
void find_step(const Model& model, Workspace& ws) noexcept {
  LoopWorkspace& loops = ws.loops;
  loops.factor.solve(loops.multipliers);
  std::fill(ws.residual.begin(), ws.residual.end(), 0.0);
  add_rows(loops, ws.residual);
  solve_forward(model, ws, ws.residual, loops.step);
}

// change in the space of the speeds that removes the rows' violation
template <typename Value>
void find_step(const Model& model, Workspace& ws, Value value) noexcept {
  LoopWorkspace& loops = ws.loops;
  for (std::size_t k = 0; k < loops.rows.size(); ++k) loops.multipliers[k] = -value(loops.rows[k]);
  find_step(model, ws);
}

template <typename Value>
double largest(const LoopWorkspace& loops, Value value) noexcept {
  double result = 0;
  for (const RowValue& row : loops.rows) {
    const double size = std::fabs(value(row));
    if (size > result || std::isnan(size)) result = size;  // NaN stays
  }
  return result;
}

// Newton's method until value(row) is below the tolerance; move() applies loops.step to q or u
template <typename Value, typename Move>
bool correct(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws, double tolerance,
             Value value, Move move) noexcept {
  int polish = is_near_singular(ws) ? kPolish : 0;
  for (int i = 0; i < kMostClosingCorrections; ++i) {
    if (largest(ws.loops, value) <= tolerance && polish-- == 0) return true;
    if (i > 0 && i % kRenewal == 0) renew_matrix(model, q, u, ws);
    find_step(model, ws, value);
    move();
    show(model, q, u, ws);
  }
  return largest(ws.loops, value) <= tolerance;
}

}  // namespace

void renew_matrix(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept {
  update_motion(model, q, u, ws);
  update_elements(model, q, Elements::used, ws);
  update_inertia(model, ws);
  update_coupled(model, ws);
  std::fill(ws.tau.begin(), ws.tau.end(), 0.0);
  factorize(model, ws);
  evaluate_cuts(model, q, u, ws);
  factorize_cuts(model, ws);
}

void show(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept {
  update_motion(model, q, u, ws);
  evaluate_cuts(model, q, u, ws);
  LoopWorkspace& loops = ws.loops;
  loops.is_shown = ws.drives.empty();
  std::copy(q.begin(), q.end(), loops.shown_q.begin());
  std::copy(u.begin(), u.end(), loops.shown_u.begin());
}

bool are_shown(const Model& model, std::span<const double> q, std::span<const double> u, const Workspace& ws) noexcept {
  const LoopWorkspace& loops = ws.loops;
  const Vec3 change = ws.motion[0].a + model.gravity;
  return loops.is_shown && change[0] == 0 && change[1] == 0 && change[2] == 0 &&
         std::equal(q.begin(), q.end(), loops.shown_q.begin()) && std::equal(u.begin(), u.end(), loops.shown_u.begin());
}

void evaluate_cuts(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept {
  for (const Cut& cut : model.cuts) {
    evaluate(cut, ws.motion[at(cut.link1)], ws.motion[at(cut.link2)], ws.drives,
             {ws.loops.rows.data() + cut.first_row, cut.rows.size()});
  }
  const auto first = at(model.cut_row_count());
  for (std::size_t k = 0; k < model.gears.size(); ++k) {
    ws.loops.rows[first + k] = gear_value(model.gears[k], model, q, u, ws);
  }
}

namespace {

// back-solves of the gears' rows
void pass_gears_back(const Model& model, Workspace& ws) noexcept {
  LoopWorkspace& loops = ws.loops;
  const std::size_t speeds = ws.udot.size();
  std::size_t row = at(model.cut_row_count());
  for (const Gear& gear : model.gears) {
    for (const GearEnd& end : gear.ends) loops.gear_tau[at(end.u)] += end.factor;
    const std::span<const int> supports(model.supports.data() + gear.first_support,
                                        model.supports.data() + gear.support_end);
    solve_backward(model, ws, supports, loops.gear_tau, {loops.residual.data() + row * speeds, speeds},
                   {loops.rate.data() + row * speeds, speeds});
    for (const GearEnd& end : gear.ends) loops.gear_tau[at(end.u)] = 0;
    ++row;
  }
}

// g'' of every closing row with u' = 0: visit(row, value)
template <typename Visit>
void for_each_known(const Model& model, const Workspace& ws, Visit visit) noexcept {
  for (const Cut& cut : model.cuts) {
    for (std::size_t i = 0; i < cut.rows.size(); ++i) {
      const std::size_t k = at(cut.first_row) + i;
      visit(k, acceleration_of(ws.loops.rows[k], ws.motion[at(cut.link1)], ws.motion[at(cut.link2)]));
    }
  }
  for (auto k = at(model.cut_row_count()); k < ws.loops.rows.size(); ++k) visit(k, ws.loops.rows[k].bias);
}

}  // namespace

void factorize_cuts(const Model& model, Workspace& ws, double tolerance) noexcept {
  LoopWorkspace& loops = ws.loops;
  const std::size_t speeds = ws.udot.size();
  for (const Cut& cut : model.cuts) {
    const std::span<const int> supports(model.supports.data() + cut.first_support,
                                        model.supports.data() + cut.support_end);
    const std::size_t first = at(cut.first_row), count = cut.rows.size();
    solve_backward(model, ws, supports, cut.link1, cut.link2, {loops.rows.data() + first, count},
                   {loops.residual.data() + first * speeds, count * speeds},
                   {loops.rate.data() + first * speeds, count * speeds});
  }
  pass_gears_back(model, ws);
  for (const ClosingBlock& block : loops.pattern.blocks) {
    const ClosingGroup &group = loops.pattern.groups[at(block.group)], &other = loops.pattern.groups[at(block.other)];
    const double* residual = loops.residual.data() + at(group.first_row) * speeds;
    for (int i = 0; i < group.row_count; ++i, residual += speeds) {
      const int before = block.group == block.other ? i + 1 : other.row_count;
      const double* rate = loops.rate.data() + at(other.first_row) * speeds;
      double* W = loops.W.data() + block.entries[at(i)];
      for (int l = 0; l < before; ++l, rate += speeds) *W++ = product_over(block.speeds, residual, rate);
    }
  }
  loops.factor.factorize(loops.W, model.cut_reference, tolerance);
}

void close_loops(const Model& model, Workspace& ws) noexcept {
  LoopWorkspace& loops = ws.loops;
  const std::size_t speeds = ws.udot.size();
  for_each_known(model, ws, [&](std::size_t k, double known) { loops.multipliers[k] = known; });
  for (const ClosingGroup& group : loops.pattern.groups) {
    const double* rate = loops.rate.data() + at(group.first_row) * speeds;
    double* force = loops.multipliers.data() + group.first_row;
    for (int i = 0; i < group.row_count; ++i, rate += speeds, ++force) {
      *force = -(*force + product_over(group.speeds, rate, ws.residual.data()));
    }
  }
  loops.factor.solve(loops.multipliers);
  add_rows(loops, ws.residual);
}

void reduce_row(std::size_t port, Workspace& ws, std::span<double> residual, std::span<double> rate) noexcept {
  LoopWorkspace& loops = ws.loops;
  const std::size_t speeds = residual.size();
  const ClosingPattern::Port& reached = loops.pattern.ports[port];
  for (const int g : reached.groups) {
    const ClosingGroup& group = loops.pattern.groups[at(g)];
    for (std::size_t k = at(group.first_row); k < at(group.first_row + group.row_count); ++k) {
      loops.multipliers[k] = -product_over(group.speeds, loops.residual.data() + k * speeds, rate.data());
    }
  }
  loops.factor.solve(reached.rows, loops.multipliers);
  for (const int g : reached.groups) add_rows(loops.pattern.groups[at(g)], loops.residual, loops.multipliers, residual);
  for (const int g : reached.groups) add_rows(loops.pattern.groups[at(g)], loops.rate, loops.multipliers, rate);
}

bool project(const Model& model, std::span<double> q, std::span<double> u, Workspace& ws) noexcept {
  // near a singular position the matrix of the previous stage is not valid
  if (is_near_singular(ws)) {
    renew_matrix(model, q, u, ws);
  } else {
    show(model, q, u, ws);
  }
  const Extent extent = extent_of(ws);
  const bool is_closed = correct(
      model, q, u, ws, kClosed * extent.length, [](const RowValue& row) { return row.g; },
      [&] { displace(model, ws, ws.loops.step, q); });
  const bool is_moving_along = correct(
      model, q, u, ws, kClosed * extent.speed, [](const RowValue& row) { return row.rate; },
      [&] {
        for (std::size_t j = 0; j < u.size(); ++j) u[j] += ws.loops.step[j];
      });
  return is_closed && is_moving_along;
}

namespace {

// change of a row by the small displacement of the last solve_forward()
double change_of(const RowValue& row, const Cut& cut, const Workspace& ws) noexcept {
  const std::size_t link1 = at(cut.link1), link2 = at(cut.link2);
  return dot(row.G.v1, ws.delta_a[link1]) + dot(row.G.w1, ws.delta_alpha[link1]) + dot(row.G.v2, ws.delta_a[link2]) +
         dot(row.G.w2, ws.delta_alpha[link2]);
}

void shift(const Model& model, Workspace& ws) noexcept {
  ws.loops.is_shown = false;
  for (const Cut& cut : model.cuts) {
    for (std::size_t i = 0; i < cut.rows.size(); ++i) {
      RowValue& row = ws.loops.rows[at(cut.first_row) + i];
      row.g += change_of(row, cut, ws);
    }
  }
  std::size_t row = at(model.cut_row_count());
  for (const Gear& gear : model.gears) {
    for (const GearEnd& end : gear.ends) ws.loops.rows[row].g += end.factor * ws.loops.step[at(end.u)];
    ++row;
  }
}

}  // namespace

void aim(const Model& model, double h, std::span<double> u, Workspace& ws) noexcept {
  LoopWorkspace& loops = ws.loops;
  for_each_known(model, ws, [&](std::size_t k, double b) {
    loops.multipliers[k] = 0.5 * h * b - loops.rows[k].rate - loops.rows[k].g / h;
  });
  find_step(model, ws);
  for (std::size_t j = 0; j < u.size(); ++j) u[j] += loops.step[j];
}

bool project_step(const Model& model, double h, std::span<double> q, std::span<double> u, Workspace& ws) noexcept {
  constexpr int kMostQuickCorrections = 4;
  // the second-order change, which shift() neglects, is far below kClosedByEuler
  constexpr double kSmall = 1e-5;
  if (is_near_singular(ws)) return project(model, q, u, ws);
  show(model, q, u, ws);
  const double closed = kClosedByEuler * extent_of(ws).length;
  const auto value = [](const RowValue& row) { return row.g; };
  for (int left = kMostQuickCorrections; left > 0; --left) {
    const double open = largest(ws.loops, value);
    if (open <= closed) return true;
    find_step(model, ws, value);
    displace(model, ws, ws.loops.step, q);
    for (std::size_t j = 0; j < u.size(); ++j) u[j] += ws.loops.step[j] / h;
    if (open <= kSmall) {
      shift(model, ws);
    } else {
      show(model, q, u, ws);
    }
  }
  return project(model, q, u, ws);
}

Extent extent_of(const Workspace& ws) noexcept {
  double length = 0, speed = 0;  // squares
  for (const LinkMotion& m : ws.motion) {
    length = std::max(length, dot(m.p, m.p));
    speed = std::max({speed, dot(m.v, m.v), dot(m.w, m.w)});
  }
  const Extent least;
  return {std::max(least.length, std::sqrt(length)), std::max(least.speed, std::sqrt(speed))};
}

}  // namespace slew::multibody
