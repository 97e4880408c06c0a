#include "coupling/indicator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slew::coupling {
namespace {

// enough for two digits of the largest eigenvalue; the figure is a warning level, not a result
constexpr int kPowerIterations = 12;

// N: a port that carries less is idle, and the rounding of its energies is no error of the coupling
constexpr double kLeastForce = 1;

// rounded up, so that buckets of few steps do not shorten the window
std::int64_t steps_per_bucket(std::int64_t bucket_ns, SimDuration step) {
  return (bucket_ns + step.ns - 1) / step.ns;
}

}  // namespace

Lamp lamp_of(const PortDefects& defects) noexcept {
  if (defects.creates_energy || !(defects.eta < kAmberBelow)) return Lamp::red;
  return defects.eta < kGreenBelow ? Lamp::green : Lamp::amber;
}

Indicator::Indicator(std::size_t ports, SimDuration communication_step)
    : ports_(ports),
      H_(communication_step.seconds()),
      steps_per_bucket_(
          steps_per_bucket(kIndicatorWindow.ns / static_cast<std::int64_t>(kBuckets), communication_step)),
      alarm_after_steps_(std::max<std::int64_t>(1, kNetAlarmAfter.ns / communication_step.ns)),
      window_(ports),
      steps_below_alarm_(ports, 0),
      defects_(ports) {}

void Indicator::reset() noexcept {
  for (auto& buckets : window_) buckets.fill(Bucket{});
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
    for (auto& buckets : window_) buckets[current_] = Bucket{};
  }
  ++steps_in_bucket_;
}

void Indicator::evaluate_window(std::size_t port) noexcept {
  // window sums and the scale of (5)
  Bucket sum;
  for (const Bucket& bucket : window_[port]) {
    sum.residual += bucket.residual;
    sum.net += bucket.net;
    sum.work += bucket.work;
    sum.force = std::max(sum.force, bucket.force);
    sum.stiffness = std::max(sum.stiffness, bucket.stiffness);
  }
  const double force = std::max(sum.force, kLeastForce);
  const double spring = sum.stiffness > 0 ? force * force / (2 * sum.stiffness) : 0.0;
  const double scale = std::max(sum.work, spring);
  PortDefects& defects = defects_[port];
  defects.eta = scale > 0 ? sum.residual / scale : 0.0;
  defects.net = scale > 0 ? sum.net / scale : 0.0;
  // the alarm needs the net sum below its level for a while
  steps_below_alarm_[port] = defects.net < kNetAlarm ? steps_below_alarm_[port] + 1 : 0;
  defects.creates_energy = steps_below_alarm_[port] >= alarm_after_steps_;
}

void Indicator::update(const MechanismSample& mechanism, const ActuatorSample& actuators,
                       const PortArray& stiffness) noexcept {
  start_bucket();
  for (std::size_t i = 0; i < ports_; ++i) {
    PortDefects& defects = defects_[i];
    const double K = actuators.K[i];
    defects.e_x = mechanism.x[i] - actuators.x_ref[i];
    defects.e_v = mechanism.v[i] - actuators.v_ref[i];
    defects.e_F = (actuators.F[i] - K * defects.e_x) - mechanism.F_used[i];
    defects.dE = actuators.work[i] - mechanism.work[i];
    defects.dE_star = defects.dE + actuators.F[i] * defects.e_x - 0.5 * K * defects.e_x * defects.e_x;
    Bucket& bucket = window_[i][current_];
    bucket.residual += std::fabs(defects.dE_star);
    bucket.net += defects.dE_star;
    bucket.work += std::fabs(mechanism.work[i]);
    bucket.force = std::max(bucket.force, std::fabs(actuators.F[i]));
    bucket.stiffness = std::max(bucket.stiffness, stiffness[i]);
    evaluate_window(i);
  }
  omega_H_ = coupling_frequency(mechanism.W, stiffness, H_);
}

bool Indicator::creates_energy() const noexcept {
  return std::any_of(defects_.begin(), defects_.end(), [](const PortDefects& d) { return d.creates_energy; });
}

namespace {

// Largest Rayleigh quotient of S = diag(r) W diag(r) on the way of a power iteration from the unit vector `start`.
double largest_eigenvalue_from(std::size_t start, const PortMatrix& W, const std::array<double, kMaxPorts>& r,
                               std::size_t m) noexcept {
  std::array<double, kMaxPorts> vector{}, image{};
  vector[start] = 1;
  double eigenvalue = 0;
  for (int iteration = 0; iteration < kPowerIterations; ++iteration) {
    double largest = 0, numerator = 0, denominator = 0;
    for (std::size_t i = 0; i < m; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < m; ++j) sum += W[i * m + j] * r[j] * vector[j];
      image[i] = r[i] * sum;
      largest = std::max(largest, std::fabs(image[i]));
      numerator += vector[i] * image[i];
      denominator += vector[i] * vector[i];
    }
    if (!(largest > 0)) return eigenvalue;
    eigenvalue = numerator / denominator;
    for (std::size_t i = 0; i < m; ++i) vector[i] = image[i] / largest;
  }
  return eigenvalue;
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

double coupling_frequency(const PortMatrix& W, const PortArray& K, double H) noexcept {
  // S = sqrt(K) W sqrt(K) has the eigenvalues of W K; from every port, since one start could lie in a part of the
  // machine that does not touch the others
  const std::size_t m = K.size();
  std::array<double, kMaxPorts> root{};
  for (std::size_t i = 0; i < m; ++i) root[i] = std::sqrt(std::max(0.0, K[i]));
  double eigenvalue = 0;
  for (std::size_t i = 0; i < m; ++i) eigenvalue = std::max(eigenvalue, largest_eigenvalue_from(i, W, root, m));
  return H * std::sqrt(eigenvalue);
}

}  // namespace slew::coupling
