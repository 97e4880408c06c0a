// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/held_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/display.h"
#include "coupling/line_force.h"
#include "coupling/port_dynamics.h"
#include "coupling/static_forces.h"
#include "coupling/trends.h"
#include "math/eigenvalues.h"
#include "mechanics_node/mechanism.h"
#include "mechanics_node/port_problem.h"
#include "multibody/constraints/rows.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/step_rows.h"
#include "multibody/joints/joint_law.h"
#include "multibody/model/field_tables.h"
#include "scene/parameters.h"
#include "scene/ports.h"

namespace slew::mechanics_node {
namespace {

using Vector = std::vector<double>;

constexpr double kProbe = 1e-7;       // m, rad, and the same by s
constexpr double kSlow = 1e-12;       // m/s, within the slope of friction about rest
constexpr double kGrows = 1.001;      // in a sub-step: e in a thousand of them
constexpr double kMostGrowth = 1e60;  // growth that ends it from the first step on
constexpr double kAnyOil = 1e-30;     // N/m: rows with a partner have their forces at other instants
constexpr int kSteps = 4000;          // a growth of 1.001 is 50 times then
constexpr int kSettling = 500;        // steps until the fastest growth leads
constexpr int kWindow = 100;          // steps with several swings, of which the largest counts
constexpr double kEnough = 1e12;      // growth that ends the trial, either way
// shorter sub-steps are tried by this factor until so many in a row, down to a half, are stable
constexpr double kShorter = 0.93;
constexpr int kStableInRow = 10, kMostTries = 150;
constexpr std::size_t kMostSpeeds = 256;

// friction about rest of the active rows, on the mechanism's own coordinates
class HeldLaws final : public coupling::RowLaws {
 public:
  explicit HeldLaws(Vector damping) : damping_(std::move(damping)) {}
  [[nodiscard]] coupling::RowForce evaluate(std::size_t row, double /*z*/, double /*x*/,
                                            double v) const noexcept override {
    return {.force = -damping_[row] * v, .d_v = -damping_[row]};
  }

 private:
  Vector damping_;
};

void multiply(const Vector& A, std::size_t rows, const Vector& x, Vector& y) {
  y.assign(rows, 0);
  for (std::size_t i = 0; i < rows; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < x.size(); ++j) sum += A[i * x.size() + j] * x[j];
    y[i] = sum;
  }
}

double size_of(const Vector& x) {
  double sum = 0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum);
}

multibody::MechanicsDef without_contacts(multibody::MechanicsDef mechanics) {
  mechanics.formulation = multibody::Formulation::recursive;
  mechanics.contacts.clear();
  return mechanics;
}

// (1) and (2) at the start of a scene, at rest
class HeldMechanism {
 public:
  explicit HeldMechanism(const scene::Scene& scene)
      : scene_(scene),
        mechanism_(scene, without_contacts(scene.mechanics)),
        n_(mechanism_.state().u.size()),
        viscous_(mechanism_.row_count()) {
    if (n_ == 0 || n_ > kMostSpeeds || !multibody::has_springs(mechanism_.model())) return;
    std::fill(mechanism_.change_state().u.begin(), mechanism_.change_state().u.end(), 0.0);
    select_rows();
    mechanism_.evaluate();
    start_ = mechanism_.state();
    find_damping();
    if (active_.empty()) return;
    linearise();
  }
  [[nodiscard]] bool is_empty() const noexcept { return active_.empty(); }
  [[nodiscard]] UnstableRow try_substep(double h) const;
  // Fastest growth of the motion itself, v' = A z - M^-1 J^T c J v [1/s]; at least 0.
  [[nodiscard]] double own_growth() const;

 private:
  void select_rows() {
    const multibody::Model& model = mechanism_.model();
    for (std::size_t row = scene_.ports.size(); row < model.rows.size(); ++row) {
      const multibody::JointLaw& law = multibody::law_of(model, row);
      viscous_[row] = law.viscous;
      mechanism_.set_row_active(row, law.coulomb > 0 || law.viscous > 0);
    }
  }

  // slopes of friction about rest; rows without it are not held
  void find_damping() {
    const std::size_t m = scene_.ports.size(), rows = mechanism_.row_count();
    const multibody::Workspace& ws = mechanism_.workspace();
    Vector W(m * m), a(m), F(m), damping;
    for (std::size_t i = 0; i < m; ++i) {
      const double ratio = scene_.ports[i].ratio;
      a[i] = ratio * ws.row_a_free[i];
      for (std::size_t j = 0; j < m; ++j) W[i * m + j] = ratio * ws.row_W[i * rows + j] * scene_.ports[j].ratio;
    }
    if (m > 0 && !coupling::static_forces(W, a, F)) std::fill(F.begin(), F.end(), 0.0);
    holding_.assign(rows, 0);
    for (std::size_t i = 0; i < m; ++i) holding_[i] = scene_.ports[i].ratio * F[i];
    for (std::size_t row = 0; row < rows; ++row) {
      if (!mechanism_.is_row_active(row)) continue;
      double c = 0;
      if (row < m) {
        const scene::PortDef& port = scene_.ports[row];
        c = port.ratio * port.ratio * coupling::LineForceLaw(port.line_force).friction(F[row], kSlow) / kSlow;
      } else {
        const multibody::JointLaw& law = multibody::law_of(mechanism_.model(), row);
        multibody::JointLaw friction = law;
        friction.limit_stiffness = friction.limit_damping = 0;
        c = mechanism_.is_ball(row) ? -multibody::evaluate_part(friction, 0, 0, 0, 0).d_v
                                    : -multibody::evaluate(friction, ws.row_x[row], 0).d_v;
      }
      if (!(c > 0)) continue;
      active_.push_back(row);
      damping_.push_back(c);
    }
    mechanism_.evaluate();
  }

  // of the active rows, under the forces that hold the ports
  void accelerations_of_rows(const multibody::Workspace& ws, Vector& a) const {
    const std::size_t rows = mechanism_.row_count();
    a.clear();
    for (const std::size_t row : active_) {
      double sum = ws.row_a_free[row];
      for (std::size_t j = 0; j < rows; ++j) sum += ws.row_W[row * rows + j] * holding_[j];
      a.push_back(sum);
    }
  }

  // A, C, J and M^-1 J^T, by differences as in element_speeds.cpp
  void linearise() {
    const std::size_t m = active_.size(), rows = mechanism_.row_count();
    const multibody::Model& model = mechanism_.model();
    multibody::Workspace ws(model);
    ws.row_is_active = mechanism_.workspace().row_is_active;
    multibody::evaluate(model, start_, ws);
    Vector held(n_), a_held, udot(n_), a;
    multibody::accelerations(model, ws, holding_, held);
    accelerations_of_rows(ws, a_held);
    J_.assign(m * n_, 0), B_.assign(n_ * m, 0), W_.assign(m * m, 0);
    Vector column(n_);
    for (std::size_t k = 0; k < m; ++k) {
      multibody::response_column(model, ws, static_cast<int>(active_[k]), column);
      for (std::size_t i = 0; i < n_; ++i) {
        B_[i * m + k] = column[i];
        J_[k * n_ + i] = ws.row_J[active_[k] * n_ + i];
      }
      for (std::size_t j = 0; j < m; ++j) W_[k * m + j] = ws.row_W[active_[k] * rows + active_[j]];
    }
    A_.assign(2 * n_ * n_, 0), C_.assign(m * 2 * n_, 0);
    Vector unit(n_), rate(start_.q.size());
    for (std::size_t j = 0; j < 2 * n_; ++j) {
      multibody::State moved = start_;
      if (j < n_) {
        std::fill(unit.begin(), unit.end(), 0.0);
        unit[j] = 1;
        multibody::update_motion(model, start_.q, unit, ws);
        multibody::coordinate_rates(model, ws, start_.q, unit, rate);
        for (std::size_t k = 0; k < rate.size(); ++k) moved.q[k] += kProbe * rate[k];
        multibody::normalize_quaternions(model, moved.q);
      } else {
        moved.u[j - n_] = kProbe;
      }
      multibody::evaluate(model, moved, ws);
      multibody::accelerations(model, ws, holding_, udot);
      accelerations_of_rows(ws, a);
      for (std::size_t i = 0; i < n_; ++i) A_[i * 2 * n_ + j] = (udot[i] - held[i]) / kProbe;
      for (std::size_t k = 0; k < m; ++k) {
        C_[k * 2 * n_ + j] = (a[k] - a_held[k]) / kProbe;
      }
    }
  }

  // z' = A z + (0, b)
  void rates(const Vector& z, const Vector& b, Vector& dz) const {
    Vector a;
    multiply(A_, n_, z, a);
    dz.resize(2 * n_);
    for (std::size_t k = 0; k < n_; ++k) dz[k] = z[n_ + k], dz[n_ + k] = a[k] + b[k];
  }

  // rk4 over h under the row forces mean + (t - h/2) slope
  void advance(double h, const Vector& mean, const Vector& slope, Vector& z) const;
  [[nodiscard]] int micro_steps(double h) const;

  const scene::Scene& scene_;
  Mechanism mechanism_;
  std::size_t n_;
  Vector viscous_;                   // of joints, by row
  std::vector<std::size_t> active_;  // rows that are held
  Vector holding_;                   // forces of the ports at rest, by row of the mechanism
  Vector damping_;                   // c of (1), by active row
  multibody::State start_;
  Vector A_, C_, J_, B_, W_;  // of v' n x 2n, m x 2n, m x n, n x m, m x m
};

void HeldMechanism::advance(double h, const Vector& mean, const Vector& slope, Vector& z) const {
  Vector steady, growing, b(n_), k[4], at(z.size());
  multiply(B_, n_, mean, steady);
  multiply(B_, n_, slope, growing);
  constexpr double kTime[4] = {0, 0.5, 0.5, 1};
  for (std::size_t stage = 0; stage < 4; ++stage) {
    for (std::size_t i = 0; i < n_; ++i) b[i] = steady[i] + (kTime[stage] - 0.5) * h * growing[i];
    at = z;
    for (std::size_t i = 0; stage > 0 && i < z.size(); ++i) at[i] += kTime[stage] * h * k[stage - 1][i];
    rates(at, b, k[stage]);
  }
  for (std::size_t i = 0; i < z.size(); ++i) z[i] += h / 6 * (k[0][i] + 2 * (k[1][i] + k[2][i]) + k[3][i]);
}

int HeldMechanism::micro_steps(double h) const {
  Vector viscous, W;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    viscous.push_back(viscous_[active_[k]]);
    W.push_back(W_[k * active_.size() + k]);
  }
  return micro_step_count(h, viscous, W);
}

double HeldMechanism::own_growth() const {
  const std::size_t m = active_.size(), size = 2 * n_;
  Vector whole(size * size);
  for (std::size_t i = 0; i < n_; ++i) {
    whole[i * size + n_ + i] = 1;
    for (std::size_t j = 0; j < size; ++j) {
      double rate = A_[i * size + j];
      for (std::size_t k = 0; k < m && j >= n_; ++k) rate -= B_[i * m + k] * damping_[k] * J_[k * n_ + j - n_];
      whole[(n_ + i) * size + j] = rate;
    }
  }
  double growth = 0;
  for (const std::complex<double> rate : math::eigenvalues(whole, size)) growth = std::max(growth, rate.real());
  return growth;
}

UnstableRow HeldMechanism::try_substep(double h) const {
  const std::size_t m = active_.size();
  coupling::PortDynamics dynamics(m);
  coupling::Trends trends(m);
  HeldLaws laws(damping_);
  const int micro = micro_steps(h);
  Vector z(2 * n_), a, mean(m), slope(m), accelerations, v;
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t k = 0; k < m; ++k) z[n_ + i] += B_[i * m + k] / std::sqrt(W_[k * m + k]);
  }
  double begun = 0, first = 0, last = 0, window = 0;
  int taken = 0;
  UnstableRow found{.growth = 1, .substep = h};
  for (int step = 0; step < kSteps; ++step) {
    multiply(C_, m, z, a);
    v.assign(z.begin() + static_cast<std::ptrdiff_t>(n_), z.end());
    Vector row_v;
    multiply(J_, m, v, row_v);
    dynamics.set_rows(m);
    std::fill(dynamics.partner().begin(), dynamics.partner().end(), coupling::RowPartner{});
    std::copy(W_.begin(), W_.end(), dynamics.W().begin());
    for (std::size_t k = 0; k < m; ++k) {
      if (active_[k] < scene_.ports.size()) dynamics.partner()[k].K = kAnyOil;
      dynamics.x()[k] = dynamics.z()[k] = 0;
      dynamics.v()[k] = row_v[k];
      dynamics.a_free()[k] = a[k];
      dynamics.a_free_rate()[k] = trends.begin(k, a[k]) / h;
    }
    (void)dynamics.solve(h, micro, laws);
    std::copy_n(dynamics.f_mean().begin(), m, mean.begin());
    std::copy_n(dynamics.f_slope().begin(), m, slope.begin());
    advance(h, mean, slope, z);
    multiply(C_, m, z, a);
    for (std::size_t k = 0; k < m; ++k) trends.end(k, a[k]);
    multiply(A_, n_, z, accelerations);
    const double size = size_of(accelerations);
    if (step == 0) begun = size;
    if (!(size < kMostGrowth * begun)) {
      first = begun, last = size, taken = step + 1;
      break;
    }
    window = std::max(window, size);
    const bool is_over = !(size > 0) || size > kEnough * first || size * kEnough < first;
    if ((step + 1) % kWindow != 0 && !(step >= kSettling && is_over)) continue;
    if (step < kSettling) {
      first = window;
    } else {
      last = window, taken = step + 1 - kSettling;
      if (is_over) break;
    }
    window = 0;
  }
  if (!(first > 0)) return found;
  found.growth = std::pow(last / first, 1.0 / std::max(taken, 1));
  if (!(found.growth > kGrows)) return found;
  std::size_t row = 0;
  for (std::size_t k = 1; k < m; ++k) {
    if (std::fabs(mean[k]) * std::sqrt(W_[k * m + k]) > std::fabs(mean[row]) * std::sqrt(W_[row * m + row])) row = k;
  }
  found.row = scene::row_names(scene_)[active_[row]];
  double largest = 0;
  for (const multibody::FlexiblePart& part : mechanism_.model().parts) {
    for (std::size_t k = 0; k < part.modes; ++k) {
      const double speed = std::fabs(z[n_ + static_cast<std::size_t>(part.u) + k]);
      if (speed > largest) largest = speed, found.body = part.name;
    }
  }
  return found;
}

}  // namespace

std::optional<UnstableRow> find_unstable_row(const scene::Scene& scene) {
  if (scene.session.solution != scene::Solution::split || !scene.has_mechanics()) return std::nullopt;
  if (multibody::step_rule(scene.mechanics).integrator != multibody::Integrator::rk4) return std::nullopt;
  const HeldMechanism mechanism(scene);
  if (mechanism.is_empty()) return std::nullopt;
  const double h = scene::mechanics_substep(scene.session, scene.mechanics);
  UnstableRow found = mechanism.try_substep(h);
  if (!(found.growth > kGrows) || !(found.growth > kGrows * std::exp(h * mechanism.own_growth()))) return std::nullopt;
  double shorter = h;
  int stable = 0;
  for (int i = 0; i < kMostTries && stable < kStableInRow; ++i) {
    shorter *= kShorter;
    const bool is_stable = !(mechanism.try_substep(shorter).growth > kGrows);
    if (is_stable && stable == 0) found.longest_step = shorter;
    stable = is_stable ? stable + 1 : 0;
  }
  return found;
}

std::string warning_of(const UnstableRow& found) {
  const std::string what = found.body.empty() ? "the springs behind it" : "the modes of " + found.body;
  const std::string longest = found.longest_step > 0 ? fmt::format("mechanics.max_substep of at most {:.3g} s, ",
                                                                   rounded_down(found.longest_step))
                                                     : "";
  return fmt::format(
      "{}: while its friction holds it, {} swing against it and grow {:.4g} times in each sub-step of rk4 of {:.4g} s: "
      "it creeps under its load. Choose {}{}, or an implicit mechanics.integrator such as trapezoidal",
      found.row, what, found.growth, found.substep, longest, found.body.empty() ? "softer springs" : "fewer modes");
}

}  // namespace slew::mechanics_node
