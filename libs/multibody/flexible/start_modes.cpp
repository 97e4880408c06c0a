// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/start_modes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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
constexpr double kModesSettled = 1e-11;  // correction, relative to the largest modal coordinate
constexpr double kModeProbe = 1e-4;      // step of the differences, relative to the scale of the modes

class ModalSettling {
 public:
  explicit ModalSettling(Model& model) : model_(model), ws_(model), state_(start_state(model)) {}

  bool run() {
    std::fill(state_.u.begin(), state_.u.end(), 0.0);
    double before = 0;
    for (int i = 0; i < kMostModeCorrections; ++i) {
      const double change = correct();
      if (!std::isfinite(change)) return false;
      if (change <= kModesSettled) return keep();
      // differences of a potential are limited by its rounding
      if (i > 1 && change >= before && change < 1e3 * kModesSettled) return keep();
      before = change;
    }
    return false;
  }

 private:
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

  // one step of (1) for all bodies; the largest change over the largest coordinate
  double correct() {
    double scale = 0;
    for_each_mode(model_, [&](std::size_t q, std::size_t) { scale = std::max(scale, std::fabs(state_.q[q])); });
    const double probe = kModeProbe * (scale > 0 ? scale : 1);
    double largest = 0;
    std::vector<std::vector<double>> steps(model_.parts.size());
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const FlexiblePart& part = model_.parts[i];
      if (part.is_start_given) continue;
      std::vector<double>& step = steps[i];
      step.resize(part.modes);
      for (std::size_t k = 0; k < part.modes; ++k) {
        double& q = state_.q[static_cast<std::size_t>(part.q) + k];
        const double held = q;
        q = held + probe;
        const double above = potential();
        q = held - probe;
        const double below = potential();
        q = held;
        step[k] = load_on(static_cast<std::size_t>(part.u) + k) - (above - below) / (2 * probe);
      }
      std::vector<double> factor = part.stiffness;
      const int modes = static_cast<int>(part.modes);
      if (!math::factorize_cholesky(factor.data(), modes)) return std::numeric_limits<double>::quiet_NaN();
      math::substitute_forward(factor.data(), modes, step.data());
      math::substitute_backward(factor.data(), modes, step.data());
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
      for (std::size_t k = 0; k < steps[i].size(); ++k) {
        double& q = state_.q[static_cast<std::size_t>(model_.parts[i].q) + k];
        q += steps[i][k];
        largest = std::max(largest, std::fabs(steps[i][k]));
        scale = std::max(scale, std::fabs(q));
      }
    }
    return scale > 0 ? largest / scale : 0;
  }

  bool keep() {
    for_each_mode(model_, [&](std::size_t q, std::size_t) { model_.start_q[q] = state_.q[q]; });
    return true;
  }

  Model& model_;
  Workspace ws_;
  State state_;
};

}  // namespace

bool settle_modes(Model& model) {
  return model.parts.empty() || ModalSettling(model).run();
}

}  // namespace slew::multibody
