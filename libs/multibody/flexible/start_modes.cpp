// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/start_modes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/index.h"
#include "math/small_cholesky.h"
#include "multibody/forces/point_load.h"
#include "multibody/formulations/passes.h"
#include "multibody/model/state.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

constexpr int kMostModeCorrections = 200;
constexpr int kMostHalvings = 20;         // of a step of Newton's method
constexpr double kModesSettled = 1e-11;   // correction, relative to the largest modal coordinate
constexpr double kModeProbe = 1e-4;       // step of the differences, relative to the scale of the modes
constexpr double kCurvatureProbe = 1e-2;  // the same, of second differences

class ModalSettling {
 public:
  ModalSettling(Model& model, const std::vector<bool>& selected)
      : model_(model), ws_(model), state_(start_state(model)) {
    std::fill(state_.u.begin(), state_.u.end(), 0.0);
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const FlexiblePart& part = model_.parts[p];
      if (part.is_start_given || !selected[p]) continue;
      parts_.push_back(&part);
      for (std::size_t k = 0; k < part.modes; ++k) {
        free_.push_back({static_cast<std::size_t>(part.q) + k, static_cast<std::size_t>(part.u) + k});
      }
    }
  }

  bool run() {
    const std::vector<double> start = state_.q;
    if (settles([this] { return correction_of_bodies(); })) return keep();
    state_.q = start;
    return settles([this] { return correction_of_all(); }) && keep();
  }

 private:
  struct Mode {
    std::size_t q, u;
  };

  // correction: false if there is none, else it is in step_.
  template <typename Correction>
  bool settles(Correction correction) {
    double before = 0;
    for (int i = 0; i < kMostModeCorrections; ++i) {
      if (!correction()) return false;
      const double change = apply();
      if (!std::isfinite(change)) return false;
      if (change <= kModesSettled) return true;
      // differences of a potential are limited by its rounding
      if (i > 1 && change >= before && change < 1e3 * kModesSettled) return true;
      before = change;
    }
    return false;
  }

  [[nodiscard]] double potential() {
    observe(model_, state_, ws_);
    return multibody::energy(model_, ws_).potential;
  }

  // generalised force of point loads on the mode at this place in State::u: their power at its unit speed
  [[nodiscard]] double load_on(std::size_t mode) {
    const std::vector<PointLoad>& loads = model_.elements.loads;
    if (loads.empty()) return 0;
    state_.u[mode] = 1;
    update_motion(model_, state_.q, state_.u, ws_);
    state_.u[mode] = 0;
    double power = 0;
    for (const PointLoad& load : loads) {
      const LinkMotion& link = ws_.motion[at(load.link)];
      const Wrench wrench = wrench_of(load, link, 0);
      power += dot(wrench.f, link.v) + dot(wrench.n, link.w);
    }
    return power;
  }

  [[nodiscard]] double largest_coordinate() const {
    double largest = 0;
    for_each_mode(model_, [&](std::size_t q, std::size_t) { largest = std::max(largest, std::fabs(state_.q[q])); });
    return largest;
  }

  [[nodiscard]] double scale() const {
    const double largest = largest_coordinate();
    return largest > 0 ? largest : 1;
  }

  // Q - dV/dq of the free modes, in step_
  void find_force() {
    const double probe = kModeProbe * scale();
    step_.resize(free_.size());
    for (std::size_t k = 0; k < free_.size(); ++k) {
      double& q = state_.q[free_[k].q];
      const double held = q;
      q = held + probe;
      const double above = potential();
      q = held - probe;
      const double below = potential();
      q = held;
      step_[k] = load_on(free_[k].u) - (above - below) / (2 * probe);
    }
  }

  // one step of (1) for all bodies
  bool correction_of_bodies() {
    find_force();
    std::size_t first = 0;
    for (const FlexiblePart* part : parts_) {
      std::vector<double> factor = part->stiffness;
      const int modes = static_cast<int>(part->modes);
      if (!math::factorize_cholesky(factor.data(), modes)) return false;
      math::substitute_forward(factor.data(), modes, step_.data() + first);
      math::substitute_backward(factor.data(), modes, step_.data() + first);
      first += part->modes;
    }
    return true;
  }

  // one step of (2), halved until the potential without the work of the loads falls
  bool correction_of_all() {
    const std::size_t n = free_.size();
    const int size = static_cast<int>(n);
    find_force();
    const std::vector<double> force = step_;
    std::vector<double> factor = curvature();
    if (!math::factorize_cholesky(factor.data(), size)) return false;
    math::substitute_forward(factor.data(), size, step_.data());
    math::substitute_backward(factor.data(), size, step_.data());
    const double here = potential();
    std::vector<double> loads(n);
    for (std::size_t k = 0; k < n; ++k) loads[k] = load_on(free_[k].u);
    const std::vector<double> from = state_.q;
    for (int halving = 0; halving < kMostHalvings; ++halving) {
      double work = 0, expected = 0;
      for (std::size_t k = 0; k < n; ++k) {
        state_.q[free_[k].q] = from[free_[k].q] + step_[k];
        work += loads[k] * step_[k];
        expected += force[k] * step_[k];
      }
      const double fallen = here - potential() + work;
      state_.q = from;
      const double rounding = 1e-12 * std::fabs(here);
      if (fallen > -rounding && (expected < rounding || fallen > 1e-4 * expected)) break;
      for (double& x : step_) x *= 0.5;
    }
    return true;
  }

  // d2V/dq2 of the free modes, lower triangle
  [[nodiscard]] std::vector<double> curvature() {
    const std::size_t n = free_.size();
    const double probe = kCurvatureProbe * scale();
    std::vector<double> K(n * n);
    const auto moved = [&](std::size_t k, double dk, std::size_t l, double dl) {
      const std::vector<double> from = state_.q;
      state_.q[free_[k].q] += dk;
      state_.q[free_[l].q] += dl;
      const double V = potential();
      state_.q = from;
      return V;
    };
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t l = 0; l <= k; ++l) {
        const double same = moved(k, probe, l, probe) + moved(k, -probe, l, -probe);
        const double opposite = moved(k, probe, l, -probe) + moved(k, -probe, l, probe);
        K[k * n + l] = (same - opposite) / (4 * probe * probe);
      }
    }
    return K;
  }

  // adds the step; the largest change over the largest coordinate
  double apply() {
    const double before = largest_coordinate();
    double largest = 0;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      state_.q[free_[k].q] += step_[k];
      // also one that is no number
      if (!(std::fabs(step_[k]) <= largest)) largest = std::fabs(step_[k]);
    }
    const double size = std::max(before, largest_coordinate());
    return size > 0 ? largest / size : 0;
  }

  bool keep() {
    for_each_mode(model_, [&](std::size_t q, std::size_t) { model_.start_q[q] = state_.q[q]; });
    return true;
  }

  Model& model_;
  Workspace ws_;
  State state_;
  std::vector<const FlexiblePart*> parts_;  // selected, without a given start
  std::vector<Mode> free_;                  // of these
  std::vector<double> step_;                // by free mode
};

}  // namespace

bool settle_modes(Model& model, const std::vector<bool>& selected) {
  const bool any = std::find(selected.begin(), selected.end(), true) != selected.end();
  return !any || ModalSettling(model, selected).run();
}

}  // namespace slew::multibody
