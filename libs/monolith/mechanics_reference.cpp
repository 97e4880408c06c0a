// SPDX-License-Identifier: Apache-2.0
#include "monolith/mechanics_reference.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.h"
#include "monolith/body_reference.h"
#include "multibody/constraints/loops.h"
#include "multibody/constraints/rows.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"

namespace slew::monolith {
namespace {

// interval [s] for closing loops in the solver's values: the violation grows with the square of the time
constexpr double kClosingWindow = 0.05;

// (1)
class MechanicsEquations final : public DifferentialEquation {
 public:
  explicit MechanicsEquations(const multibody::Model& model)
      : model_(model), state_(multibody::start_state(model)), ws_(model), forces_(model.rows.size()) {}

  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> y = state_.q;
    y.insert(y.end(), state_.u.begin(), state_.u.end());
    y.insert(y.end(), state_.bristles.begin(), state_.bristles.end());
    return y;
  }

  void rates(double t, const double* y, double* f) noexcept override {
    take(t, y);
    multibody::evaluate(model_, state_, ws_);
    for (std::size_t k = 0; k < forces_.size(); ++k) {
      const double z = state_.bristles.empty() ? 0.0 : state_.bristles[k];
      forces_[k] = multibody::joint_force(model_, k, ws_.row_x, ws_.row_v, 0, z).force;
    }
    const std::size_t coordinates = state_.q.size(), speeds = state_.u.size();
    for (std::size_t k = 0; k < state_.bristles.size(); ++k) {
      f[coordinates + speeds + k] = multibody::joint_bristle_rate(model_, k, ws_.row_v, state_.bristles[k]);
    }
    // use the solver's own quaternions, whose length the rates keep
    multibody::coordinate_rates(model_, ws_, {y, coordinates}, state_.u, {f, coordinates});
    multibody::accelerations(model_, ws_, forces_, {f + coordinates, speeds});
  }

  // the state of the solver's values; true if its loops are closed
  bool take(double t, const double* y) noexcept {
    state_.time = t;
    std::copy_n(y, state_.q.size(), state_.q.begin());
    std::copy_n(y + state_.q.size(), state_.u.size(), state_.u.begin());
    std::copy_n(y + state_.q.size() + state_.u.size(), state_.bristles.size(), state_.bristles.begin());
    multibody::normalize_quaternions(model_, state_.q);
    multibody::set_time(model_, t, ws_);
    multibody::impose_positions(model_, ws_, state_.q);
    multibody::impose_speeds(model_, ws_, state_.u);
    if (!model_.has_closing_rows()) return true;
    multibody::renew_matrix(model_, state_.q, state_.u, ws_);
    return multibody::project(model_, state_.q, state_.u, ws_);
  }
  [[nodiscard]] const multibody::State& state() const noexcept { return state_; }

 private:
  const multibody::Model& model_;
  multibody::State state_;
  multibody::Workspace ws_;
  std::vector<double> forces_;
};

}  // namespace

Status integrate_mechanics(const multibody::MechanicsDef& mechanics, std::span<const double> times,
                           const MechanicsReferenceOptions& options, MechanicsReference& result) {
  result.model = multibody::build_model(mechanics, multibody::joint_rows(mechanics));
  result.states.clear();
  if (result.model.contact != nullptr) {
    for (const multibody::ContactPairElement& pair : result.model.contact->pairs) {
      if (pair.tested < 0) continue;
      return Status::error(ExitCode::bad_input, "the reference of the mechanics does not follow contacts; the pair '" +
                                                    pair.name + "' is tested for one");
    }
  }
  if (options.equations == ReferenceEquations::body_coordinates) return integrate_bodies(times, options, result);
  MechanicsEquations equations(result.model);
  const std::vector<double> y = equations.values();
  StiffSolver solver(equations, std::vector<double>(y.size(), options.absolute_tolerance), options.relative_tolerance);
  solver.restart(0, y);
  const auto give_up = [&](const std::string& why) {
    return Status::error(ExitCode::diverged, "the reference integration of the mechanics ended at " +
                                                 std::to_string(solver.time()) + " s (" + why + ")");
  };
  for (const double time : times) {
    SLEW_CHECK(time >= solver.time());
    bool is_closed = equations.take(solver.time(), solver.y().data());
    const double begin = solver.time(), span = time - begin;
    const int windows = !(span > 0)                        ? 0
                        : !result.model.has_closing_rows() ? 1
                                                           : static_cast<int>(std::ceil(span / kClosingWindow));
    for (int k = 1; k <= windows; ++k) {
      const double next = k == windows ? time : begin + span * k / windows;
      const std::string failure = solver.advance(next);
      result.statistics = solver.statistics();
      if (!failure.empty()) return give_up(failure);
      is_closed = equations.take(next, solver.y().data());
      if (result.model.has_closing_rows()) solver.restart(next, equations.values());
    }
    if (!is_closed) return give_up("its loops cannot be closed");
    result.states.push_back(equations.state());
  }
  return Status::ok();
}

}  // namespace slew::monolith
