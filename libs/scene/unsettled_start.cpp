// SPDX-License-Identifier: Apache-2.0
#include "scene/unsettled_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "core/display.h"
#include "math/semidefinite.h"
#include "multibody/build/validate.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::scene {

using math::Vec3;

namespace {

constexpr double kNoticed = 0.5;      // m/s2, a twentieth of gravity
constexpr double kRowDepends = 1e-9;  // pivot of a row that others imply, share of its mobility

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

class StartAtRest {
 public:
  StartAtRest(const Scene& scene, const multibody::Model& model)
      : model_(model), ws_(model), ports_(scene.ports.size()), held_(model.rows.size(), false) {
    multibody::State state = multibody::start_state(model);
    std::fill(state.u.begin(), state.u.end(), 0.0);
    multibody::evaluate(model, state, ws_);
    for (std::size_t k = 0; k < held_.size(); ++k) held_[k] = k < ports_ || breakaway_of(k) > 0;
  }

  // forces of ports, and of joints that their friction holds; those that it cannot hold slip
  void push() {
    std::vector<double> forces = holding_forces();
    for (std::size_t round = 0; round < held_.size(); ++round) {
      bool slips = false;
      for (std::size_t k = ports_; k < held_.size(); ++k) {
        if (!held_[k] || std::fabs(forces[k]) <= breakaway_of(k)) continue;
        held_[k] = false;
        slips = true;
      }
      if (!slips) break;
      forces = holding_forces();
    }
    std::vector<double> udot(ws_.udot.size());
    multibody::accelerations(model_, ws_, forces, udot);
  }

  // body that carries an actuator and has the largest acceleration [m/s2] of its centre of mass
  struct Fastest {
    int body = 0;
    double acceleration = 0;
  };
  [[nodiscard]] Fastest fastest_carrier() const {
    const std::vector<bool> is_carrier = carriers();
    Fastest fastest;
    for (std::size_t i = 1; i < model_.bodies.size(); ++i) {
      const multibody::Body& body = model_.bodies[i];
      if (body.link == 0 || !is_carrier[at(body.link)]) continue;
      const multibody::LinkMotion& link = ws_.motion[at(body.link)];
      const Vec3 arm = link.R * (body.p_LB + body.R_LB * body.c_B);
      const double a = norm(ws_.delta_a[at(body.link)] + cross(ws_.delta_alpha[at(body.link)], arm));
      if (a > fastest.acceleration) fastest = {static_cast<int>(i), a};
    }
    return fastest;
  }

  // some body that moves with this one is of a pair of shapes
  [[nodiscard]] bool has_contact(int body) const {
    if (model_.contact == nullptr) return false;
    const auto rides = [&](int link) {
      while (link > 0 && link != model_.bodies[at(body)].link) link = model_.links[at(link)].parent;
      return link > 0;
    };
    return std::any_of(model_.contact->frames.begin(), model_.contact->frames.end(),
                       [&](const multibody::ContactFrame& frame) { return rides(frame.link); });
  }

 private:
  [[nodiscard]] double breakaway_of(std::size_t row) const {
    const multibody::JointLaw& law = model_.rows[row].law;
    return law.coulomb * (multibody::has_bristles(law) ? law.breakaway_ratio : 1);
  }

  // W f = -a_free over the held rows
  [[nodiscard]] std::vector<double> holding_forces() const {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < held_.size(); ++k) {
      if (held_[k]) rows.push_back(k);
    }
    const std::size_t n = rows.size(), all = held_.size();
    std::vector<double> W(n * n), f(n), forces(all);
    for (std::size_t i = 0; i < n; ++i) {
      f[i] = -ws_.row_a_free[rows[i]];
      for (std::size_t j = 0; j < n; ++j) W[i * n + j] = ws_.row_W[rows[i] * all + rows[j]];
    }
    math::Semidefinite factor(static_cast<int>(n));
    factor.factorize(W, {}, kRowDepends);
    factor.solve(f);
    for (std::size_t i = 0; i < n; ++i) forces[rows[i]] = f[i];
    return forces;
  }

  // links that carry both ends of a port's line or axis: on its way to Ground, not on the way between its ends
  [[nodiscard]] std::vector<bool> carriers() const {
    std::vector<bool> found(model_.links.size(), false);
    for (std::size_t k = 0; k < ports_; ++k) {
      const multibody::Row& row = model_.rows[k];
      for (int i = row.first_support; i < row.support_end; ++i) {
        const int link = model_.supports[at(i)];
        const bool is_between = std::any_of(model_.paths.begin() + row.first_path, model_.paths.begin() + row.path_end,
                                            [link](const multibody::PathEntry& entry) { return entry.link == link; });
        if (!is_between) found[at(link)] = true;
      }
    }
    return found;
  }

  const multibody::Model& model_;
  multibody::Workspace ws_;
  std::size_t ports_;
  std::vector<bool> held_;  // by row
};

}  // namespace

void find_start_shapes(const Scene& scene, Problems& warnings) {
  if (!scene.has_flexible_bodies()) return;
  const multibody::Model model = multibody::build_model(scene.mechanics, row_names(scene));
  if (model.has_closing_rows()) multibody::find_start_deflections(model, warnings);
}

void find_unsettled_start(const Scene& scene, Problems& warnings) {
  if (scene.ports.empty() || scene.hydraulics.start != hydraulics::StartState::equilibrium) return;
  const multibody::Model model = multibody::build_model(scene.mechanics, row_names(scene));
  // a body that bends then starts undeformed and swings, which find_start_shapes() reports
  if (scene.has_flexible_bodies() && model.has_closing_rows() && !model.rests_in_loops) return;
  StartAtRest start(scene, model);
  start.push();
  const StartAtRest::Fastest fastest = start.fastest_carrier();
  if (!(fastest.acceleration > kNoticed) || start.has_contact(fastest.body)) return;
  warnings.push_back(
      {"hydraulics.start",
       fmt::format("every actuator is in equilibrium, but {}, which carries some, accelerates with {} at "
                   "the start: the forces of the actuators are those of a falling machine",
                   model.bodies[at(fastest.body)].name, quantity_text(fastest.acceleration, "m/s2")),
       "springs or tyres that carry the weight in the start pose (a preload, free lengths), or 'slewring "
       "run --from' a state that was saved at rest",
       ""});
}

std::string deep_starts(const Scene& scene) {
  Problems found;
  multibody::find_unlikely_contacts(scene.mechanics, found);
  std::string text;
  for (const Problem& one : found) text += (text.empty() ? "" : "; ") + one.path + ": " + one.what;
  return text;
}

}  // namespace slew::scene
