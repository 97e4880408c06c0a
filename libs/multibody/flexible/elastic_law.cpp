// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/elastic_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/small_cholesky.h"
#include "multibody/model/model.h"

namespace slew::multibody {
namespace {

// tolerance of a matrix from another program's text or arithmetic
constexpr double kSymmetric = 1e-9;

bool is_symmetric(std::span<const double> A, std::size_t n) noexcept {
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < k; ++l) {
      const double scale = std::sqrt(std::fabs(A[k * n + k] * A[l * n + l]));
      if (std::fabs(A[k * n + l] - A[l * n + k]) > kSymmetric * scale) return false;
    }
  }
  return true;
}

bool all_finite(std::span<const double> values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

bool is_diagonal(const std::vector<double>& pairs, std::size_t n) noexcept {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i % (n + 1) != 0 && pairs[i] != 0) return false;
  }
  return true;
}

}  // namespace

std::vector<double> modal_damping(const ModalBody& modes, std::span<const double> zeta) {
  const std::size_t n = modes.modes();
  std::vector<double> damping(n * n);
  for (std::size_t k = 0; k < n && !zeta.empty(); ++k) {
    const std::size_t own = k * n + k;
    damping[own] = 2 * zeta[std::min(k, zeta.size() - 1)] * std::sqrt(modes.stiffness[own] * modes.mass_matrix[own]);
  }
  return damping;
}

bool has_diagonal_law(const FlexiblePart& part) noexcept {
  return is_diagonal(part.stiffness, part.modes) && is_diagonal(part.damping, part.modes);
}

void set_elastic_law(Model& model, std::size_t part, const ElasticLaw& law) noexcept {
  FlexiblePart& own = model.parts[part];
  std::copy(law.K.begin(), law.K.end(), own.stiffness.begin());
  std::copy(law.D.begin(), law.D.end(), own.damping.begin());
  std::copy(law.M.begin(), law.M.end(), own.mass_matrix.begin());
  own.is_diagonal = has_diagonal_law(own);
  const std::size_t n = own.modes;
  for (std::size_t k = 0; k < n; ++k) {
    double force = law.Q[k];
    for (std::size_t l = 0; l < n; ++l) force += law.K[k * n + l] * law.q_ref[l] + law.D[k * n + l] * law.u_ref[l];
    own.preload[k] = force;
  }
}

Status check_elastic_law(const Model& model, std::size_t part, const ElasticLaw& law) {
  const FlexiblePart& own = model.parts[part];
  const std::size_t n = own.modes;
  const auto wrong = [&](const std::string& what) {
    return Status::error(ExitCode::bad_input, "elastic forces of '" + own.name + "': " + what);
  };
  if (law.Q.size() != n || law.q_ref.size() != n || law.u_ref.size() != n || law.K.size() != n * n ||
      law.D.size() != n * n) {
    return wrong(fmt::format("the flex node publishes {} modes, mechanics has {}: the nodes run different scenes",
                             law.Q.size(), n));
  }
  for (const auto values : {law.Q, law.q_ref, law.u_ref, law.K, law.D}) {
    if (!all_finite(values)) return wrong("a number is not finite");
  }
  if (!is_symmetric(law.K, n) || !is_symmetric(law.D, n)) return wrong("stiffness or damping is not symmetric");
  for (std::size_t k = 0; k < n; ++k) {
    if (law.D[k * n + k] < 0) return wrong(fmt::format("the damping of mode {} is negative", k + 1));
  }
  std::vector<double> factor(law.K.begin(), law.K.end());
  if (!math::factorize_cholesky(factor.data(), static_cast<int>(n))) {
    return wrong("the stiffness is not positive definite");
  }
  return Status::ok();
}

}  // namespace slew::multibody
