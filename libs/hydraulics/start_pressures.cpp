// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/start_pressures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/index.h"
#include "math/bounded_least_squares.h"
#include "math/range_projector.h"

namespace slew::hydraulics {
namespace {

constexpr double kLowestStart = 1e5;      // Pa; below it an anti-cavitation valve would be open from the start
constexpr double kHeld = 1e-9;            // share of the pressures: rounding of forces that are held
constexpr double kMissing = 1e-6;         // share of the pressures: what the solution of (2) may leave
constexpr double kSameCoordinate = 1e-9;  // of P: two actuators move the same coordinate

struct Pair {
  double a, b;
};

// Pressures that hold F; b is `aim`, or higher if a would be too low. Pre-condition here and below: a setting of 1.
Pair held_by_return_side(const Actuator& actuator, double F, double aim) noexcept {
  Pair p{(F + aim * actuator.area_b) / actuator.area_a, aim};
  if (p.a < kLowestStart && actuator.area_b > 0) {
    p.a = kLowestStart;
    p.b = (p.a * actuator.area_a - F) / actuator.area_b;
  }
  return p;
}

// Pressures that hold F around `mean`, which is raised if one would be too low.
Pair held_around_mean(const Actuator& actuator, double F, double mean) noexcept {
  const double half = F / (actuator.area_a + actuator.area_b);
  mean = std::max(mean, kLowestStart + std::fabs(half));
  return {mean + half, mean - half};
}

Pair held_alone(const StartCircuit& circuit, const Actuator& actuator, double F_full) noexcept {
  const std::size_t a = at(actuator.port_a), b = at(actuator.port_b);
  Pair p = actuator.start == StartRule::return_pressure ? held_by_return_side(actuator, F_full, circuit.return_pressure)
                                                        : held_around_mean(actuator, F_full, circuit.mean_pressure);
  // a chamber on a fixed volume keeps its pressure, the other one holds
  if (circuit.is_fixed[b]) p.a = (F_full + circuit.initial_pressure[b] * actuator.area_b) / actuator.area_a;
  if (circuit.is_fixed[a] && actuator.area_b > 0) {
    p.b = (circuit.initial_pressure[a] * actuator.area_a - F_full) / actuator.area_b;
  }
  return p;
}

double scale_of(const Actuator& actuator) noexcept {
  return actuator.setting.at_start * actuator.area_a;
}

// Groups of actuators on common volumes, and their pressures by (2).
class CommonVolumes {
 public:
  CommonVolumes(const StartCircuit& circuit, std::span<const double> F, std::span<const double> W,
                StartPressures& start)
      : circuit_(circuit), start_(start), group_(circuit.actuators.size()), first_(circuit.is_fixed.size(), -1) {
    std::iota(group_.begin(), group_.end(), 0);
    std::vector<char> is_shared(group_.size(), 0);
    for (std::size_t j = 0; j < group_.size(); ++j) join_at_volumes(j, is_shared);
    if (std::find(is_shared.begin(), is_shared.end(), 1) == is_shared.end()) return;
    find_projector(W);
    for (std::size_t j = 0; j < group_.size(); ++j) r_.push_back(F[j] / scale_of(circuit_.actuators[j]));
    for (std::size_t g = 0; g < group_.size(); ++g) {
      std::vector<std::size_t> members;
      bool shares = false;
      for (std::size_t j = 0; j < group_.size(); ++j) {
        if (root(j) != g) continue;
        members.push_back(j);
        shares = shares || is_shared[j] != 0;
      }
      if (shares && !is_held(members)) solve(members);
    }
  }

 private:
  std::size_t root(std::size_t j) const noexcept {
    while (group_[j] != j) j = group_[j];
    return j;
  }
  void join(std::size_t i, std::size_t j) noexcept {
    const std::size_t a = root(i), b = root(j);
    group_[std::max(a, b)] = std::min(a, b);
  }

  void join_at_volumes(std::size_t j, std::vector<char>& is_shared) noexcept {
    for (const int volume : {circuit_.actuators[j].port_a, circuit_.actuators[j].port_b}) {
      if (circuit_.is_fixed[at(volume)]) continue;
      int& first = first_[at(volume)];
      if (first >= 0) {
        is_shared[j] = 1;
        join(at(first), j);
      }
      first = static_cast<int>(j);
    }
  }

  void find_projector(std::span<const double> W) {
    const std::size_t m = group_.size();
    std::vector<double> scaled(m * m, 0.0);
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < m; ++j) {
        scaled[i * m + j] = W.empty()
                                ? (i == j ? 1.0 : 0.0)
                                : scale_of(circuit_.actuators[i]) * W[i * m + j] * scale_of(circuit_.actuators[j]);
      }
    }
    P_ = math::range_projector(scaled, m);
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (std::fabs(P_[i * m + j]) > kSameCoordinate) join(i, j);
      }
    }
  }

  [[nodiscard]] double pressure(int volume) const noexcept {
    return circuit_.is_fixed[at(volume)] ? circuit_.initial_pressure[at(volume)] : start_.pressure[at(volume)];
  }

  // P (r - c) of the members at the present pressures [Pa]
  [[nodiscard]] std::vector<double> missing(const std::vector<std::size_t>& members) const {
    std::vector<double> own, projected;
    for (const std::size_t j : members) {
      const Actuator& actuator = circuit_.actuators[j];
      own.push_back(r_[j] - pressure(actuator.port_a) +
                    pressure(actuator.port_b) * (actuator.area_b / actuator.area_a));
    }
    for (const std::size_t i : members) {
      double sum = 0;
      for (std::size_t k = 0; k < members.size(); ++k) sum += P_[i * group_.size() + members[k]] * own[k];
      projected.push_back(sum);
    }
    return projected;
  }

  // size of the pressures in a group [Pa]
  [[nodiscard]] double size_of(const std::vector<std::size_t>& members) const noexcept {
    double size = kLowestStart;
    for (const std::size_t j : members) {
      size = std::max({size, std::fabs(r_[j]), std::fabs(pressure(circuit_.actuators[j].port_a)),
                       std::fabs(pressure(circuit_.actuators[j].port_b))});
    }
    return size;
  }

  [[nodiscard]] bool is_held(const std::vector<std::size_t>& members) const {
    const std::vector<double> left = missing(members);
    const double limit = kHeld * size_of(members);
    return std::all_of(left.begin(), left.end(), [&](double one) { return std::fabs(one) <= limit; });
  }

  [[nodiscard]] std::pair<double, double> lowest_and_aim(std::size_t volume,
                                                         const std::vector<std::size_t>& members) const noexcept {
    double lowest = kLowestStart, aim = 0;
    for (const std::size_t j : members) {
      const Actuator& actuator = circuit_.actuators[j];
      const bool is_linear = actuator.start == StartRule::return_pressure;
      if (is_linear && at(actuator.port_b) == volume) lowest = std::max(lowest, circuit_.return_pressure);
      const bool is_on_it = at(actuator.port_a) == volume || at(actuator.port_b) == volume;
      if (!is_linear && is_on_it) aim = std::max(aim, circuit_.mean_pressure);
    }
    return {lowest, std::max(lowest, aim)};
  }

  // (2); q, t, M and b of bounded_least_squares.h
  void solve(const std::vector<std::size_t>& members) {
    std::vector<std::size_t> volumes;
    for (const std::size_t j : members) {
      for (const int volume : {circuit_.actuators[j].port_a, circuit_.actuators[j].port_b}) {
        const bool is_listed = std::find(volumes.begin(), volumes.end(), at(volume)) != volumes.end();
        if (!circuit_.is_fixed[at(volume)] && !is_listed) volumes.push_back(at(volume));
      }
    }
    const std::size_t n = volumes.size(), m = members.size();
    std::vector<double> t;
    for (const std::size_t volume : volumes) {
      const auto [lowest, aim] = lowest_and_aim(volume, members);
      start_.pressure[volume] = lowest;
      t.push_back(aim - lowest);
    }
    const std::vector<double> b = missing(members);
    std::vector<double> M(m * n, 0.0);
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t v = 0; v < n; ++v) {
        for (const std::size_t j : members) {
          const Actuator& actuator = circuit_.actuators[j];
          const double slope = (at(actuator.port_a) == volumes[v] ? 1 : 0) -
                               (at(actuator.port_b) == volumes[v] ? actuator.area_b / actuator.area_a : 0);
          M[i * n + v] += P_[members[i] * group_.size() + j] * slope;
        }
      }
    }
    const std::vector<double> q = math::bounded_least_squares(M, b, t);
    for (std::size_t v = 0; v < n; ++v) start_.pressure[volumes[v]] += q[v];
    const std::vector<double> left = missing(members);
    const double limit = kMissing * size_of(members);
    for (std::size_t i = 0; i < m; ++i) {
      if (std::fabs(left[i]) > limit) start_.missing[members[i]] = scale_of(circuit_.actuators[members[i]]) * left[i];
    }
  }

  const StartCircuit& circuit_;
  StartPressures& start_;
  std::vector<std::size_t> group_;  // by actuator: an earlier member of its group, or itself
  std::vector<int> first_;          // by volume: an actuator on it
  std::vector<double> P_, r_;
};

}  // namespace

StartPressures start_pressures(const StartCircuit& circuit, std::span<const double> F, std::span<const double> W) {
  const std::size_t volumes = circuit.is_fixed.size(), m = circuit.actuators.size();
  StartPressures start{std::vector<double>(volumes), std::vector<int>(volumes, -1), std::vector<double>(m)};
  std::vector<int> actuators(volumes, 0);
  for (std::size_t j = 0; j < m; ++j) {
    const Actuator& actuator = circuit.actuators[j];
    const Pair p = held_alone(circuit, actuator, F[j] / actuator.setting.at_start);
    for (const auto& [volume, pressure] : {std::pair(actuator.port_a, p.a), std::pair(actuator.port_b, p.b)}) {
      start.pressure[at(volume)] += pressure;
      ++actuators[at(volume)];
      start.actuator[at(volume)] = static_cast<int>(j);
    }
  }
  for (std::size_t i = 0; i < volumes; ++i) {
    if (actuators[i] > 0) start.pressure[i] /= actuators[i];
  }
  CommonVolumes(circuit, F, W, start);
  return start;
}

}  // namespace slew::hydraulics
