// SPDX-License-Identifier: Apache-2.0
#include "monolith/linearisation.h"

#include <algorithm>
#include <cmath>

namespace slew::monolith {
namespace {

// share of each state's scale: 1e-7 rad, 10 Pa; far inside the smoothing of every law, far above rounding
constexpr double kDifference = 1e-5;

std::vector<std::size_t> free_states(const SceneEquations& equations, Part part) {
  std::vector<std::size_t> states;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const StateOwner::Kind kind = equations.owner(i).kind;
    const bool is_mechanics = kind == StateOwner::Kind::joint || kind == StateOwner::Kind::mode;
    if (!equations.is_held(i) && (part == Part::all || is_mechanics)) states.push_back(i);
  }
  return states;
}

std::vector<OwnerShare> shares_of(const SceneEquations& equations, std::span<const std::size_t> states,
                                  std::span<const double> participation) {
  std::vector<OwnerShare> owners;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const StateOwner owner = equations.owner(states[k]);
    const auto at = std::find_if(owners.begin(), owners.end(), [&](const auto& one) { return one.owner == owner; });
    if (at == owners.end()) {
      owners.push_back({owner, participation[k]});
    } else {
      at->share += participation[k];
    }
  }
  std::stable_sort(owners.begin(), owners.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  return owners;
}

}  // namespace

Status find_modes(SceneEquations& equations, double t, std::span<const double> y, Part part, SceneModes& result) {
  result = {};
  const std::vector<std::size_t> states = free_states(equations, part);
  const std::vector<double> scale = equations.absolute_scales();
  const std::size_t n = states.size();
  result.states = static_cast<int>(n);
  std::vector<double> moved(y.begin(), y.end()), above(y.size()), below(y.size()), A(n * n);
  // the held forces are those of y
  equations.rates(t, y.data(), above.data());
  if (part == Part::mechanics_with_held_rows) equations.set_row_forces(RowForces::held);
  bool is_finite = true;
  for (std::size_t j = 0; j < n; ++j) {
    const std::size_t state = states[j];
    const double step = kDifference * scale[state];
    moved[state] = y[state] + step;
    equations.rates(t, moved.data(), above.data());
    moved[state] = y[state] - step;
    equations.rates(t, moved.data(), below.data());
    moved[state] = y[state];
    // in units of the scales
    for (std::size_t i = 0; i < n; ++i) {
      const double slope = (above[states[i]] - below[states[i]]) / (2 * step) * scale[state] / scale[states[i]];
      is_finite = is_finite && std::isfinite(slope);
      A[i * n + j] = slope;
    }
  }
  equations.set_row_forces(RowForces::follow);
  if (!is_finite) return Status::error(ExitCode::diverged, "the equations have no finite slopes at this state");
  const Eigenmodes found = eigenmodes(A, n);
  if (n > 0 && found.modes.empty() && found.at_rest == 0)
    return Status::error(ExitCode::failed, "the iteration for the eigenvalues did not converge");
  result.at_rest = found.at_rest;
  for (const Eigenmode& mode : found.modes) {
    result.modes.push_back({mode.value, mode.count, shares_of(equations, states, mode.participation)});
  }
  return Status::ok();
}

}  // namespace slew::monolith
