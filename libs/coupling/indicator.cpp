// SPDX-License-Identifier: Apache-2.0
#include "coupling/indicator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "math/fixed_size.h"
#include "math/range_projector.h"

namespace slew::coupling {
namespace {

// S^16 as an estimate of its largest eigenvalue: two digits, since the share of a second eigenvalue just below decays
// slowest; the figure is a warning level, not a result
constexpr int kSquarings = 4;

// ports up to this number have a code of their own (math/fixed_size.h)
constexpr std::size_t kMostFixedPorts = 6;

// N: a port that carries less is idle, and the rounding of its energies is no error of the coupling
constexpr double kLeastForce = 1;

// (5), own
template <typename Bucket>
double scale_of(const Bucket& sum, double least_force = kLeastForce) {
  const double force = std::max(sum.force, least_force);
  return std::max(sum.work, sum.stiffness > 0 ? force * force / (2 * sum.stiffness) : 0.0);
}

// (5), at a port of mobility W; infinite if its motion is prescribed
double kinetic_energy(double v, double W) {
  constexpr double kLeastMobility = 1e-12;  // 1/kg: rounding of a motion that no force changes
  return W > kLeastMobility ? v * v / (2 * W) : std::numeric_limits<double>::infinity();
}

// rounded up, so that buckets of few steps do not shorten the window
std::int64_t steps_per_bucket(std::int64_t bucket_ns, SimDuration step) {
  return (bucket_ns + step.ns - 1) / step.ns;
}

}  // namespace

Lamp lamp_of(const PortDefects& defects) noexcept {
  if (defects.creates_energy || !(defects.eta < kAmberBelow)) return Lamp::red;
  return defects.eta < kGreenBelow ? Lamp::green : Lamp::amber;
}

Indicator::Indicator(std::size_t ports, SimDuration communication_step, std::vector<double> least_force)
    : ports_(ports),
      H_(communication_step.seconds()),
      steps_per_bucket_(
          steps_per_bucket(kIndicatorWindow.ns / static_cast<std::int64_t>(kBuckets), communication_step)),
      alarm_after_steps_(std::max<std::int64_t>(1, kNetAlarmAfter.ns / communication_step.ns)),
      least_force_(std::move(least_force)),
      window_(ports),
      others_(ports),
      largest_(ports),
      diverging_buckets_(ports, 0),
      kinetic_(ports, 0),
      steps_below_alarm_(ports, 0),
      defects_(ports) {
  least_force_.resize(ports, kLeastForce);
}

void Indicator::reset() noexcept {
  for (auto& buckets : window_) buckets.fill(Bucket{});
  for (Bucket& others : others_) others = Bucket{};
  for (auto& largest : largest_) largest.fill(0);
  for (std::size_t& buckets : diverging_buckets_) buckets = 0;
  for (double& energy : kinetic_) energy = 0;
  for (std::int64_t& steps : steps_below_alarm_) steps = 0;
  for (PortDefects& defects : defects_) defects = PortDefects{};
  steps_in_bucket_ = 0;
  current_ = 0;
  omega_H_ = 0;
}

void Indicator::start_bucket() noexcept {
  if (steps_in_bucket_ == steps_per_bucket_) {
    steps_in_bucket_ = 0;
    current_ = (current_ + 1) % kBuckets;
    for (std::size_t port = 0; port < ports_; ++port) {
      window_[port][current_] = Bucket{};
      add_others(port);
    }
  }
  ++steps_in_bucket_;
}

// (7), of one full bucket
bool Indicator::diverges_in(const Bucket& bucket, std::size_t port) const noexcept {
  return bucket.stiffness > 0 && bucket.residual > kDivergesAbove * scale_of(bucket, least_force_[port]);
}

void Indicator::add_others(std::size_t port) noexcept {
  Bucket sum;
  std::size_t diverging = 0;
  std::array<double, kLeftOut>& largest = largest_[port];
  largest.fill(0);
  for (std::size_t i = 0; i < kBuckets; ++i) {
    if (i == current_) continue;
    sum.add(window_[port][i]);
    if (diverges_in(window_[port][i], port)) ++diverging;
    double next = window_[port][i].residual;
    for (double& kept : largest) {
      if (next > kept) std::swap(next, kept);
    }
  }
  others_[port] = sum;
  diverging_buckets_[port] = diverging;
}

Indicator::Bucket Indicator::window_sum(std::size_t port) const noexcept {
  Bucket sum = others_[port];
  sum.add(window_[port][current_]);
  return sum;
}

// sum of all residuals less the kLeftOut largest
double Indicator::without_largest(std::size_t port, double sum) const noexcept {
  double least = window_[port][current_].residual;
  sum -= least;
  for (const double residual : largest_[port]) {
    sum -= residual;
    least = std::min(least, residual);
  }
  // rounding may leave a negative sum; NaN stays
  const double kept = sum + least;
  return kept < 0 ? 0 : kept;
}

void Indicator::evaluate(std::size_t port, Level level, double machine_scale) noexcept {
  const Bucket sum = window_sum(port);
  const double own = std::max(scale_of(sum), std::isfinite(kinetic_[port]) ? kinetic_[port] : 0.0);
  const double scale = is_balanced(level) ? machine_scale : own;
  const double residual = is_balanced(level) ? without_largest(port, sum.residual) : sum.residual;
  PortDefects& defects = defects_[port];
  defects.eta = scale > 0 ? residual / scale : 0.0;
  defects.net = own > 0 ? sum.net / own : 0.0;
  // the alarm needs the net sum below its level for a while
  steps_below_alarm_[port] = defects.net < kNetAlarm ? steps_below_alarm_[port] + 1 : 0;
  defects.creates_energy = steps_below_alarm_[port] >= alarm_after_steps_;
}

void Indicator::update(const MechanismSample& mechanism, const ActuatorSample& actuators, const PortArray& stiffness,
                       const PortLevels& levels) noexcept {
  start_bucket();
  double machine_scale = 0;
  std::array<double, kMaxPorts> e_x;
  for (std::size_t i = 0; i < ports_; ++i) e_x[i] = mechanism.x[i] - actuators.x_ref[i];
  for (std::size_t i = 0; i < ports_; ++i) {
    PortDefects& defects = defects_[i];
    const double springs = spring_force(actuators, i, e_x);
    defects.e_x = e_x[i];
    defects.e_v = mechanism.v[i] - actuators.v_ref[i];
    defects.e_F = (actuators.F[i] - springs) - mechanism.F_used[i];
    defects.dE = actuators.work[i] - mechanism.work[i];
    defects.dE_star = defects.dE + actuators.F[i] * defects.e_x - 0.5 * springs * defects.e_x;
    Bucket& bucket = window_[i][current_];
    kinetic_[i] = kinetic_energy(mechanism.v[i], mechanism.W[i * ports_ + i]);
    bucket.residual += std::fabs(defects.dE_star);
    bucket.net += defects.dE_star;
    bucket.work += std::fabs(mechanism.work[i]);
    bucket.force = std::max(bucket.force, std::fabs(actuators.F[i]));
    bucket.stiffness = std::max(bucket.stiffness, stiffness[i]);
    machine_scale = std::max(machine_scale, scale_of(window_sum(i)));
  }
  for (std::size_t i = 0; i < ports_; ++i) evaluate(i, levels[i], machine_scale);
  omega_H_ = coupling_frequency(mechanism.W, stiffness, H_, actuators.K_cross);
}

template <typename Self, typename Bytes>
void Indicator::visit(Self& self, Bytes& bytes) {
  const auto visit_bucket = [&bytes](auto& bucket) {
    for (auto* x : {&bucket.residual, &bucket.net, &bucket.work, &bucket.force, &bucket.stiffness}) bytes.number(*x);
  };
  bytes.count(self.steps_in_bucket_, self.steps_per_bucket_);
  bytes.count(self.current_, kBuckets - 1);
  for (auto& buckets : self.window_) {
    for (auto& bucket : buckets) visit_bucket(bucket);
  }
  for (auto& others : self.others_) visit_bucket(others);
  for (auto& steps : self.steps_below_alarm_) bytes.count(steps, kLastStep);
  for (auto& d : self.defects_) {
    for (auto* x : {&d.e_x, &d.e_v, &d.e_F, &d.dE, &d.dE_star, &d.eta, &d.net}) bytes.number(*x);
    bytes.flag(d.creates_energy);
  }
  bytes.number(self.omega_H_);
}

void Indicator::save(StateWriter& bytes) const {
  visit(*this, bytes);
}

void Indicator::load(StateReader& bytes) noexcept {
  visit(*this, bytes);
  for (std::size_t port = 0; port < ports_; ++port) add_others(port);
}

bool Indicator::creates_energy() const noexcept {
  return std::any_of(defects_.begin(), defects_.end(), [](const PortDefects& d) { return d.creates_energy; });
}

double Indicator::own_residual(std::size_t port) const noexcept {
  const Bucket sum = window_sum(port);
  const double own = scale_of(sum);
  return own > 0 ? sum.residual / own : 0.0;
}

bool Indicator::diverges(std::size_t port) const noexcept {
  const Bucket sum = window_sum(port);
  return sum.residual > kDivergesAtOnce * std::max(scale_of(sum, least_force_[port]), kinetic_[port]) ||
         diverging_buckets_[port] >= kDivergingBuckets;
}

namespace {

// m x m, row-major, on the caller's stack
using Square = std::array<double, kMaxPorts * kMaxPorts>;

// P = P^2 / trace(P^2) of a symmetric P >= 0; false if the trace vanishes.
template <typename Size>
[[gnu::always_inline]] inline bool square(Square& P, Size m) noexcept {
  Square squared;
  double trace = 0;
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < m; ++k) sum += P[i * m + k] * P[j * m + k];
      squared[i * m + j] = sum;
    }
    trace += squared[i * m + i];
  }
  if (!(trace > 0)) return false;
  const double inverse = 1 / trace;
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j <= i; ++j) P[i * m + j] = P[j * m + i] = squared[i * m + j] * inverse;
  }
  return true;
}

// Rayleigh quotient of a symmetric S >= 0 for the longest column of S^16, the column of its largest diagonal entry.
template <typename Size>
[[gnu::always_inline]] inline double largest_eigenvalue_of(const Square& S, Size m) noexcept {
  if (m == 1) return S[0];
  Square power = S;
  for (int i = 0; i < kSquarings; ++i) {
    if (!square(power, m)) return 0;
  }
  std::size_t longest = 0;
  for (std::size_t i = 1; i < m; ++i) {
    if (power[i * m + i] > power[longest * m + longest]) longest = i;
  }
  const double* const vector = &power[longest * m];
  double numerator = 0, denominator = 0;
  for (std::size_t i = 0; i < m; ++i) {
    double image = 0;
    for (std::size_t j = 0; j < m; ++j) image += S[i * m + j] * vector[j];
    numerator += vector[i] * image;
    denominator += vector[i] * vector[i];
  }
  return numerator / denominator;
}

double largest_eigenvalue(const Square& S, std::size_t m) noexcept {
  return math::with_fixed_size<kMostFixedPorts>(m, [&S](auto size) { return largest_eigenvalue_of(S, size); });
}

// L' K L with W = L L', which has the eigenvalues of W K; K is made symmetric.
Square by_factor_of_W(const PortMatrix& W, const PortArray& K, const PortMatrix& K_cross) noexcept {
  const std::size_t m = K.size();
  Square L{}, S{};
  std::array<double, kMaxPorts> left;
  (void)math::pivoted_cholesky(W.span(), {L.data(), m * m}, {left.data(), m});
  for (std::size_t a = 0; a < m; ++a) {
    for (std::size_t i = 0; i < m; ++i) {
      double image = K[i] * L[i * m + a];
      for (std::size_t j = 0; j < m; ++j) image += 0.5 * (K_cross[i * m + j] + K_cross[j * m + i]) * L[j * m + a];
      for (std::size_t b = 0; b < m; ++b) S[a * m + b] += L[i * m + b] * image;
    }
  }
  return S;
}

}  // namespace

double omega_limit(Level level, double zeta) noexcept {
  switch (level) {
    case Level::hold:
      return 2 * zeta;
    case Level::linear:
      return 0.5;
    case Level::two:
      return 1;
    case Level::tlm:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

double coupling_frequency(const PortMatrix& W, const PortArray& K, double H, const PortMatrix& K_cross) noexcept {
  // S = sqrt(K) W sqrt(K) has the eigenvalues of W K; the whole S is used, since parts of the machine may be uncoupled
  const std::size_t m = K.size();
  if (m == 0) return 0;
  if (!K_cross.empty()) return H * std::sqrt(std::max(0.0, largest_eigenvalue(by_factor_of_W(W, K, K_cross), m)));
  std::array<double, kMaxPorts> root;
  for (std::size_t i = 0; i < m; ++i) root[i] = std::sqrt(std::max(0.0, K[i]));
  Square S;
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j <= i; ++j) S[i * m + j] = S[j * m + i] = root[i] * W[i * m + j] * root[j];
  }
  return H * std::sqrt(std::max(0.0, largest_eigenvalue(S, m)));
}

}  // namespace slew::coupling
