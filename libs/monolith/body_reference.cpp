// SPDX-License-Identifier: Apache-2.0
#include "monolith/body_reference.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.h"
#include "monolith/dae_solver.h"
#include "multibody/constraints/rows.h"
#include "multibody/formulations/body_attitude.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/passes.h"

namespace slew::monolith {
namespace {

using multibody::kBody;
using multibody::RowValue;

// Tolerances of the multipliers in the iteration: for lambda relative to its size, at least 1, for mu in m/s and rad/s.
// They take no part in the error of a step; their accuracy is rounding in g over the step.
constexpr double kMultiplierTolerance = 1e-3;

// (1); y: q, u, bristles, lambda, mu
class BodyEquations final : public AlgebraicEquation {
 public:
  explicit BodyEquations(const multibody::Model& model)
      : model_(model),
        body_(multibody::build_body_model(model)),
        joints_(multibody::start_state(model)),
        bodies_(multibody::body_state(model, joints_)),
        pushed_(bodies_),
        ws_(model),
        bws_(model, body_),
        rows_(bws_.rows.size()),
        udot_(bodies_.u.size()),
        forces_(model.rows.size()) {}

  [[nodiscard]] DaeVariables variables(double absolute) {
    DaeVariables v;
    SLEW_CHECK(multibody::evaluate(model_, body_, bodies_, joints_, ws_, bws_));
    find_row_forces();
    multibody::accelerations(model_, body_, bws_, forces_, udot_);
    const auto append = [&](std::span<const double> values, std::span<const double> rates, VariableKind kind) {
      v.start.insert(v.start.end(), values.begin(), values.end());
      v.start_rate.insert(v.start_rate.end(), rates.begin(), rates.end());
      v.kind.resize(v.start.size(), kind);
      v.absolute.resize(v.start.size(), absolute);
    };
    std::vector<double> rates(bodies_.q.size());
    multibody::find_rates(bodies_, rates);
    append(bodies_.q, rates, VariableKind::differential);
    append(bodies_.u, udot_, VariableKind::differential);
    append(joints_.bristles, bristle_rates(), VariableKind::differential);
    const std::vector<double> none(rows_);
    append(multipliers(), none, VariableKind::algebraic);
    const std::size_t first = v.start.size() - rows_;
    for (std::size_t k = 0; k < rows_; ++k) {
      v.absolute[first + k] = kMultiplierTolerance * std::max(1.0, std::fabs(v.start[first + k]));
    }
    append(none, none, VariableKind::algebraic);
    std::fill(v.absolute.end() - static_cast<std::ptrdiff_t>(rows_), v.absolute.end(), kMultiplierTolerance);
    return v;
  }

  void residual(double, const double* y, const double* y_rate, double* r) noexcept override {
    take(y);
    const std::size_t q = bodies_.q.size(), u = bodies_.u.size(), z = joints_.bristles.size();
    const double* lambda = y + q + u + z;
    const double* mu = lambda + rows_;
    // forces of the motion with these accelerations
    multibody::update_elements(model_, joints_.q, multibody::Elements::used, ws_);
    for (std::size_t i = 1; i < ws_.motion.size(); ++i) {
      const double* rate = y_rate + q + 6 * (i - 1);
      ws_.motion[i].a += math::Vec3(rate[0], rate[1], rate[2]);
      ws_.motion[i].alpha += math::Vec3(rate[3], rate[4], rate[5]);
    }
    multibody::update_inertia(model_, ws_);
    multibody::add_modal_accelerations(model_, {y_rate + q + 6 * bodies_.links(), u - 6 * bodies_.links()}, ws_);
    multibody::update_coupled(model_, ws_);
    multibody::apply_elements(model_, ws_);
    multibody::evaluate_joints(model_, body_, joints_, ws_, bws_);
    multibody::put_bias(model_, body_, ws_, bws_);
    find_row_forces();
    for (std::size_t k = 0; k < forces_.size(); ++k) {
      multibody::add_row(multibody::body_row(model_, body_, joints_, model_.rows[k], ws_), forces_[k], bws_.ldl,
                         bws_.solution);
    }
    multibody::read_bodies(body_, bws_.ldl, bws_.solution, {r + q, u});
    for (std::size_t j = 0; j < u; ++j) r[q + j] = -r[q + j];
    add_multipliers(lambda, {r + q, u});
    // coordinates follow the speeds and the correction by mu
    pushed_.q.assign(y, y + q);
    pushed_.u = bodies_.u;
    add_multipliers(mu, pushed_.u);
    multibody::find_rates(pushed_, {r, q});
    for (std::size_t j = 0; j < q; ++j) r[j] = y_rate[j] - r[j];
    const std::span<const double> bent = bristle_rates();
    for (std::size_t k = 0; k < z; ++k) r[q + u + k] = y_rate[q + u + k] - bent[k];
    for (std::size_t k = 0; k < rows_; ++k) {
      r[q + u + z + k] = bws_.rows[k].g;
      r[q + u + z + rows_ + k] = bws_.rows[k].rate;
    }
  }

  // the state of the solver's values, in joint coordinates
  const multibody::State& take(const double* y) noexcept {
    std::copy_n(y, bodies_.q.size(), bodies_.q.begin());
    std::copy_n(y + bodies_.q.size(), bodies_.u.size(), bodies_.u.begin());
    std::copy_n(y + bodies_.q.size() + bodies_.u.size(), joints_.bristles.size(), joints_.bristles.begin());
    multibody::normalize_attitudes(bodies_);
    multibody::update_body_motion(model_, bodies_, ws_);
    multibody::find_joint_coordinates(model_, ws_, joints_);
    return joints_;
  }

 private:
  void find_row_forces() noexcept {
    for (std::size_t k = 0; k < forces_.size(); ++k) {
      const multibody::BodyRow row = multibody::body_row(model_, body_, joints_, model_.rows[k], ws_);
      ws_.row_x[k] = row.x;
      ws_.row_v[k] = row.v;
    }
    for (std::size_t k = 0; k < forces_.size(); ++k) {
      forces_[k] = multibody::joint_force(model_, k, ws_.row_x, ws_.row_v, 0, bristle(k)).force;
    }
  }
  [[nodiscard]] double bristle(std::size_t row) const noexcept {
    return joints_.bristles.empty() ? 0.0 : joints_.bristles[row];
  }
  [[nodiscard]] std::span<const double> bristle_rates() noexcept {
    bristle_rates_.resize(joints_.bristles.size());
    for (std::size_t k = 0; k < bristle_rates_.size(); ++k) {
      bristle_rates_[k] = multibody::joint_bristle_rate(model_, k, ws_.row_v, bristle(k));
    }
    return bristle_rates_;
  }

  // multipliers of the last solution, by row
  [[nodiscard]] std::vector<double> multipliers() const {
    std::vector<double> lambda(rows_);
    for (std::size_t i = 1; i < body_.joints.size(); ++i) {
      const double* x = bws_.solution.data() + bws_.ldl.first_row(static_cast<int>(i) - 1) + body_.row_offset(i);
      std::copy_n(x, body_.joints[i].rows.size(), lambda.begin() + bws_.first_row[i]);
    }
    for (std::size_t k = 0; k < bws_.gears.size(); ++k) {
      const int row = bws_.ldl.first_row(body_.first_gear + static_cast<int>(k));
      lambda[rows_ - bws_.gears.size() + k] = bws_.solution[static_cast<std::size_t>(row)];
    }
    return lambda;
  }

  // y += G^T x
  void add_multipliers(const double* x, std::span<double> y) const noexcept {
    for (std::size_t i = 1; i < body_.joints.size(); ++i) {
      const multibody::Constraint& joint = body_.joints[i];
      for (std::size_t k = 0; k < joint.rows.size(); ++k) {
        const std::size_t row = static_cast<std::size_t>(bws_.first_row[i]) + k;
        const multibody::RowGradient& G = bws_.rows[row].G;
        const auto add = [&](int link, math::Vec3 v, math::Vec3 w) {
          for (int c = 0; c < 3 && link > 0; ++c) {
            y[static_cast<std::size_t>(kBody * (link - 1) + c)] += v[c] * x[row];
            y[static_cast<std::size_t>(kBody * (link - 1) + 3 + c)] += w[c] * x[row];
          }
        };
        add(joint.link1, G.v1, G.w1);
        add(joint.link2, G.v2, G.w2);
      }
    }
    for (std::size_t k = 0; k < bws_.gears.size(); ++k) {
      const double force = x[rows_ - bws_.gears.size() + k];
      multibody::for_each_end(bws_.gears[k], [&](int link, math::Vec3 v, math::Vec3 w) {
        double* a = y.data() + kBody * (link - 1);
        for (int c = 0; c < 3; ++c) {
          a[c] += v[c] * force;
          a[3 + c] += w[c] * force;
        }
      });
    }
  }

  const multibody::Model& model_;
  multibody::BodyModel body_;
  multibody::State joints_;
  multibody::BodyState bodies_, pushed_;
  multibody::Workspace ws_;
  multibody::BodyWorkspace bws_;
  std::size_t rows_;
  std::vector<double> udot_, forces_, bristle_rates_;
};

}  // namespace

Status integrate_bodies(std::span<const double> times, const MechanicsReferenceOptions& options,
                        MechanicsReference& result) {
  BodyEquations equations(result.model);
  DaeSolver solver(equations, 0, equations.variables(options.absolute_tolerance), options.relative_tolerance);
  for (const double time : times) {
    SLEW_CHECK(time >= solver.time());
    if (time > solver.time()) {
      const std::string failure = solver.advance(time);
      result.statistics = solver.statistics();
      if (!failure.empty()) {
        return Status::error(ExitCode::diverged,
                             "the reference integration of the mechanics in body coordinates ended at " +
                                 std::to_string(solver.time()) + " s (" + failure + ")");
      }
    }
    result.states.push_back(equations.take(solver.y().data()));
  }
  return Status::ok();
}

}  // namespace slew::monolith
