// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/index.h"
#include "math/semidefinite.h"
#include "math/subspace.h"
#include "multibody/constraints/constraint.h"
#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::add;
using math::falling_direction;
using math::make_unit;
using math::orthonormal;
using math::product;
using math::solve_definite;

namespace {

constexpr int kMostDisplacements = 400;
constexpr int kMostClosings = 20;
constexpr int kMostEscapes = 4;            // from unstable equilibria
constexpr double kMostDisplacement = 0.2;  // rad, or of the mechanism's size
constexpr double kEscape = 0.02;           // the same, away from an unstable equilibrium
constexpr double kProbe = 1e-5;            // the same, of differences
constexpr double kNoMotion = 1e-9;         // part of a row of C by one speed, below it: none
constexpr double kRowDepends = 1e-9;       // part of a row of C that is independent of the others, below it: none
constexpr double kRowsClosed = 1e-12;      // the same, of the mechanism's size
constexpr double kStill = 1e-9;            // acceleration at rest, of gravity
constexpr double kStillByRounding = 1e-6;  // the same, where stiff elements leave no smaller one
constexpr double kSettled = 1e-10;         // rad, or of the mechanism's size: displacement left to modes
constexpr double kUnstable = 1e-4;         // negative square of a natural frequency, of gravity over size
constexpr int kMostSoftenings = 30;
constexpr double kShortestRemainder = 1e-6;  // of the scaled unit speeds without the row space
constexpr double kSoftest = 1e-3;            // smallest mu above zero, of gravity over size

using Vector = std::vector<double>;

class Rest {
 public:
  Rest(const Model& model, const RestOptions& options, State& state)
      : model_(model), options_(options), state_(state), ws_(model), n_(state.u.size()), zero_(n_) {
    std::fill(state_.u.begin(), state_.u.end(), 0.0);
    set_time(model_, state_.time, ws_);
    for (MotionValue& drive : ws_.drives) drive.speed = drive.acceleration = 0;
    begin_contacts(model_, state_, ws_);
    update_motion(model_, state_.q, zero_, ws_);
    double size = 0;
    for (const LinkMotion& link : ws_.motion) size = std::max(size, norm(link.p));
    size_ = size > 0 ? size : 1;
    gravity_ = norm(model_.gravity) > 0 ? norm(model_.gravity) : 1;
    scale_speeds();
    pin_speeds();
    want_start_values();
    if (options_.moves_modes_alone) pin_unmoved_joints();
  }

  RestSearch find() {
    const double frequency2 = gravity_ / size_;
    int escapes = 0;
    double mu = 0;
    for (int i = 0; i < kMostDisplacements; ++i) {
      const std::vector<Vector> T = free_speeds(state_.q);
      if (T.empty()) return {.is_stable = true};
      if (options_.moves_modes_alone && T.size() > modes_) return {};
      const Vector f = force(state_.q, T), G = masses(state_.q, T), K = stiffness(T);
      Vector a;
      if (!solve_definite(G, Vector(G.size()), 0, f, a)) return failure(T, f);
      double fastest = 0;
      for (const double one : a) fastest = std::max(fastest, std::isfinite(one) ? std::fabs(one) : HUGE_VAL);
      bool is_still = fastest <= kStill * frequency2 || is_settled(f, K, G);
      if (!is_still && !displace_by_force(T, f, K, G, mu)) {
        is_still = fastest <= kStillByRounding * frequency2;
        if (!is_still) return failure(T, a);
      }
      if (!is_still) continue;
      Vector softened = K;
      add(kUnstable * frequency2, G, softened);
      const Vector falling = falling_direction(softened, T.size());
      if (falling.empty()) return {.is_stable = true};
      if (options_.moves_modes_alone) return failure(T, a);
      Vector step(T.size());
      add(product(falling, f) < 0 ? -kEscape : kEscape, falling, step);
      Vector q;
      if (++escapes > kMostEscapes || !displaced(T, step, q)) return failure(T, a);
      state_.q = q;
    }
    const std::vector<Vector> T = free_speeds(state_.q);
    const Vector f = force(state_.q, T), G = masses(state_.q, T);
    Vector a;
    static_cast<void>(solve_definite(G, Vector(G.size()), 0, f, a));
    return failure(T, a);
  }

 private:
  // ---- speeds
  void scale_speeds() {
    scale_.assign(n_, 1.0);
    slides_.assign(n_, 0);
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      const std::size_t u = at(link.u);
      if (link.joint == LinkJoint::prismatic) slides_[u] = 1;
      if (link.joint == LinkJoint::cylindrical) slides_[u + 1] = 1;
      if (link.joint == LinkJoint::floating) slides_[u] = slides_[u + 1] = slides_[u + 2] = 1;
    }
    for (std::size_t j = 0; j < n_; ++j) scale_[j] = slides_[j] != 0 ? size_ : 1;
  }

  void pin_speeds() {
    is_pinned_.assign(n_, 0);
    for (const Drive& drive : model_.drives) {
      if (drive.u >= 0) is_pinned_[at(drive.u)] = 1;
    }
    for (const HeldCoordinate& held : options_.coordinates) {
      const Joint& joint = model_.joints[at(held.joint)];
      // a universal joint that the tree walks backwards has its coordinates in the other order
      const bool is_swapped = joint.type == JointType::universal && joint.is_reversed;
      const int place = is_swapped ? 1 - held.number : held.number;
      if (joint.link > 0) is_pinned_[at(model_.links[at(joint.link)].u + place)] = 1;
      if (joint.link == 0 && joint.cut >= 0) cut_coordinates_.push_back(held);
    }
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      if (!options_.holds_floating_joints || model_.links[i].joint != LinkJoint::floating) continue;
      std::fill_n(is_pinned_.begin() + model_.links[i].u, 6, 1);
    }
  }

  // joints whose speeds are in no row of C, and modes with a given start
  void pin_unmoved_joints() {
    std::vector<char> is_mode(n_, 0);
    for (const FlexiblePart& part : model_.parts) {
      std::fill_n(is_mode.begin() + part.u, part.modes, 1);
      if (part.is_start_given) std::fill_n(is_pinned_.begin() + part.u, part.modes, 1);
      if (!part.is_start_given) modes_ += part.modes;
    }
    std::vector<Vector> C = rows_at(state_.q);
    for (Vector& row : C) make_unit(row);
    for (std::size_t j = 0; j < n_; ++j) {
      const auto is_unmoved = [j](const Vector& row) { return std::fabs(row[j]) <= kNoMotion; };
      if (is_mode[j] == 0 && std::all_of(C.begin(), C.end(), is_unmoved)) is_pinned_[j] = 1;
    }
  }

  // ---- rows of C
  struct Rows {
    Vector g, rate;
  };

  Rows read_rows(std::span<const double> q, std::span<const double> u) {
    update_motion(model_, q, u, ws_);
    update_elements(model_, q, Elements::all, ws_);
    Rows found;
    const auto put = [&found](double g, double rate) { found.g.push_back(g), found.rate.push_back(rate); };
    if (model_.has_closing_rows()) {
      evaluate_cuts(model_, q, u, ws_);
      for (const RowValue& row : ws_.loops.rows) put(row.g, row.rate);
    }
    for (std::size_t k = 0; k < at(options_.held_rows); ++k) {
      const std::size_t element = at(model_.rows[k].element);
      if (model_.rows[k].kind == RowKind::length) put(ws_.lines[element].length, ws_.lines[element].rate);
      if (model_.rows[k].kind == RowKind::angle) put(ws_.angles[element].angle, ws_.angles[element].rate);
    }
    for (const HeldCoordinate& held : cut_coordinates_) {
      const Joint& joint = model_.joints[at(held.joint)];
      const Cut& cut = model_.cuts[at(joint.cut)];
      const RowValue row =
          coordinate(joint.type, held.number, cut, ws_.motion[at(cut.link1)], ws_.motion[at(cut.link2)]);
      put(row.g, row.rate);
    }
    return found;
  }

  Vector values(std::span<const double> q) { return read_rows(q, zero_).g; }

  // C at q, its columns scaled
  std::vector<Vector> rows_at(std::span<const double> q) {
    const Rows still = read_rows(q, zero_);
    std::vector<Vector> C(still.g.size(), Vector(n_));
    Vector u(n_);
    for (std::size_t j = 0; j < n_ && !C.empty(); ++j) {
      if (is_pinned_[j] != 0) continue;
      u[j] = scale_[j];
      const Rows moving = read_rows(q, u);
      u[j] = 0;
      for (std::size_t k = 0; k < C.size(); ++k) C[k][j] = moving.rate[k] - still.rate[k];
    }
    return C;
  }

  std::vector<Vector> row_space(std::span<const double> q) {
    std::vector<Vector> C = rows_at(q);
    for (Vector& row : C) make_unit(row);
    return orthonormal(std::move(C), kRowDepends);
  }

  static Vector without(const std::vector<Vector>& space, Vector v) {
    for (const Vector& row : space) add(-product(row, v), row, v);
    return v;
  }

  // T at q, scaled
  std::vector<Vector> free_speeds(std::span<const double> q) {
    const std::vector<Vector> R = row_space(q);
    std::vector<Vector> units;
    for (std::size_t j = 0; j < n_; ++j) {
      if (is_pinned_[j] != 0) continue;
      Vector unit(n_);
      unit[j] = 1;
      units.push_back(without(R, std::move(unit)));
    }
    // the longest remainder of n vectors that span m directions is never short
    return orthonormal(std::move(units), kShortestRemainder);
  }

  // ---- displacements
  void move(std::span<const double> from, const Vector& step, Vector& q) {
    Vector u(n_);
    for (std::size_t j = 0; j < n_; ++j) u[j] = scale_[j] * step[j];
    const std::vector<math::Vec3> turn(model_.links.size());
    q.resize(from.size());
    move_from(model_, from, {1, zero_, turn}, u, q, ws_);
  }

  // A held length within a loop whose joint is held too depends on the loop's rows: its value fits only where they are
  // closed.
  void want_start_values() {
    wanted_ = values(state_.q);
    if (!model_.has_closing_rows()) return;
    const std::size_t loops = ws_.loops.rows.size();
    std::fill_n(wanted_.begin(), loops, 0.0);
    Vector q = state_.q;
    if (!close(q, loops)) return;
    state_.q = q;
    const Vector at_closed_loops = values(q);
    std::copy(at_closed_loops.begin() + static_cast<std::ptrdiff_t>(loops), at_closed_loops.end(),
              wanted_.begin() + static_cast<std::ptrdiff_t>(loops));
  }

  // moves q by the smallest displacement that gives the first rows their values again
  bool close(Vector& q, std::size_t rows) {
    for (int i = 0; i < kMostClosings; ++i) {
      Vector g = values(q);
      g.resize(rows);
      double worst = 0;
      for (std::size_t k = 0; k < g.size(); ++k) {
        g[k] -= wanted_[k];
        worst = std::max(worst, std::isfinite(g[k]) ? std::fabs(g[k]) : HUGE_VAL);
      }
      if (worst <= kRowsClosed * size_) return true;
      if (std::isinf(worst)) return false;
      const std::vector<Vector> C = rows_at(q);
      Vector W(rows * rows), step(n_);
      for (std::size_t k = 0; k < rows; ++k) {
        for (std::size_t l = 0; l <= k; ++l) W[k * rows + l] = product(C[k], C[l]);
      }
      math::Semidefinite factor(static_cast<int>(rows));
      factor.factorize(W, {}, kRowDepends);
      factor.solve(g);
      for (std::size_t k = 0; k < rows; ++k) add(-g[k], C[k], step);
      const Vector from = q;
      move(from, step, q);
    }
    return false;
  }

  bool displaced(const std::vector<Vector>& T, const Vector& dx, Vector& q) {
    Vector step(n_);
    for (std::size_t k = 0; k < T.size(); ++k) add(dx[k], T[k], step);
    move(state_.q, step, q);
    return close(q, wanted_.size());
  }

  // ---- forces
  double kinetic(std::span<const double> q, const Vector& v) {
    Vector u(n_);
    for (std::size_t j = 0; j < n_; ++j) u[j] = scale_[j] * v[j];
    update_motion(model_, q, u, ws_);
    update_elements(model_, q, Elements::all, ws_);
    return energy(model_, ws_).kinetic;
  }

  // v^T M w
  double mass_product(std::span<const double> q, const Vector& v, const Vector& w) {
    Vector sum = v, difference = v;
    add(1, w, sum);
    add(-1, w, difference);
    return (kinetic(q, sum) - kinetic(q, difference)) / 2;
  }

  // (1) along the directions T of a place nearby, made tangent at q
  Vector force(std::span<const double> q, const std::vector<Vector>& T) {
    const std::vector<Vector> R = row_space(q);
    forward_dynamics(model_, q, zero_, {}, ws_);
    Vector a(n_);
    for (std::size_t j = 0; j < n_; ++j) a[j] = ws_.udot[j] / scale_[j];
    const double size = std::sqrt(product(a, a));
    make_unit(a);
    Vector f;
    for (const Vector& direction : T) f.push_back(size * mass_product(q, without(R, direction), a));
    return f;
  }

  Vector masses(std::span<const double> q, const std::vector<Vector>& T) {
    const std::size_t m = T.size();
    Vector G(m * m);
    for (std::size_t k = 0; k < m; ++k) {
      for (std::size_t l = 0; l <= k; ++l) G[k * m + l] = G[l * m + k] = mass_product(q, T[k], T[l]);
    }
    return G;
  }

  // K, symmetric as it is in an equilibrium
  Vector stiffness(const std::vector<Vector>& T) {
    const std::size_t m = T.size();
    Vector K(m * m);
    for (std::size_t l = 0; l < m; ++l) {
      Vector dx(m), behind, ahead;
      dx[l] = kProbe;
      static_cast<void>(displaced(T, dx, ahead));
      dx[l] = -kProbe;
      static_cast<void>(displaced(T, dx, behind));
      const Vector more = force(ahead, T), less = force(behind, T);
      for (std::size_t k = 0; k < m; ++k) {
        const double slope = (less[k] - more[k]) / (2 * kProbe);
        K[k * m + l] += slope / 2;
        K[l * m + k] += slope / 2;
      }
    }
    return K;
  }

  // (2) from state_.q, whose place it changes; false: no displacement does work
  bool displace_by_force(const std::vector<Vector>& T, const Vector& f, const Vector& K, const Vector& G, double& mu) {
    const double softest = kSoftest * gravity_ / size_;
    mu = mu / 10 < softest ? 0 : mu / 10;
    for (int i = 0; i < kMostSoftenings; ++i, mu = std::max(softest, 10 * mu)) {
      Vector dx, q;
      if (!solve_definite(K, G, mu, f, dx)) continue;
      const double size = std::sqrt(product(dx, dx));
      if (!std::isfinite(size)) continue;
      for (double& one : dx) one *= std::min(1.0, kMostDisplacement / size);
      if (!displaced(T, dx, q)) continue;
      if (!(product(f, dx) + product(force(q, T), dx) > 0)) continue;
      state_.q = q;
      return true;
    }
    return false;
  }

  // Of modes, whose rounding is an acceleration by the square of their frequencies: nothing left to move.
  [[nodiscard]] bool is_settled(const Vector& f, const Vector& K, const Vector& G) const {
    Vector dx;
    return options_.moves_modes_alone && solve_definite(K, G, 0, f, dx) && std::sqrt(product(dx, dx)) <= kSettled;
  }

  // a: accelerations along T
  RestSearch failure(const std::vector<Vector>& T, const Vector& a) const {
    Vector u(n_);
    for (std::size_t k = 0; k < T.size(); ++k) add(a[k], T[k], u);
    const auto fastest = std::max_element(u.begin(), u.end(),
                                          [](double one, double other) { return std::fabs(one) < std::fabs(other); });
    const auto j = static_cast<std::size_t>(fastest - u.begin());
    return {.is_stable = false,
            .joint = std::string(joint_of(model_, model_.coordinate_count() + static_cast<int>(j))),
            .acceleration = scale_[j] * u[j],
            .turns = slides_[j] == 0};
  }

  const Model& model_;
  const RestOptions& options_;
  State& state_;
  Workspace ws_;
  std::size_t n_;
  Vector zero_;
  double size_ = 1, gravity_ = 1;  // m, m/s2
  Vector scale_;                   // by u: its speed per unit of the scaled one
  std::vector<char> slides_, is_pinned_;
  std::size_t modes_ = 0;  // that move
  std::vector<HeldCoordinate> cut_coordinates_;
  Vector wanted_;  // values of the rows
};

}  // namespace

RestSearch find_rest(const Model& model, const RestOptions& options, State& state) {
  return Rest(model, options, state).find();
}

}  // namespace slew::multibody
