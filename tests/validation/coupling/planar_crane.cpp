// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/coupling/planar_crane.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace slew::coupling::test {
namespace {

using Vec = std::array<double, 2>;

constexpr double kDegree = std::numbers::pi / 180, kStep = 20e-6, kGravity = 9.81;
constexpr double kTank = 1e5;  // Pa

// hinge of the lift boom in the pillar; the pillar's origin is this high above ground
constexpr Vec kHinge = {0.50, 2.00};
constexpr double kPillarHeight = 0.8830184;

// a chain of arms from the hinge to a centre of mass, each in the axes of lift boom, jib, bag
struct Body {
  double mass, inertia;
  std::size_t arms;
  std::array<Vec, 3> arm;
};
constexpr Vec kJibHinge = {-2.60, 0}, kBagHinge = {0.3 - 6.50, -0.15 - 0.30}, kBagCentre = {0, -0.60};
constexpr Body kBodies[] = {{400, 230, 1, {{{-1.30, 0}}}},
                            {30, 0.6, 2, {{kJibHinge, {-0.10, 0}}}},
                            {127.5618, 451, 2, {{kJibHinge, {0.3 - 3.25, 0.02904}}}},
                            {20, 0.2, 2, {{kJibHinge, {0.3 - 6.50, -0.15 - 0.10}}}},
                            {500, 100, 3, {{kJibHinge, kBagHinge, kBagCentre}}}};
constexpr double kBagDamping = 5000;  // N m s/rad, hook to bag

struct Cylinder {
  double bore, rod, piston_travel, closed_length;  // m; piston_travel: chamber less piston; closed: attachment and rod
  [[nodiscard]] double area_a() const { return std::numbers::pi / 4 * bore * bore; }
  [[nodiscard]] double area_b() const { return std::numbers::pi / 4 * (bore * bore - rod * rod); }
};
constexpr Cylinder kLift = {0.200, 0.105, 1.120 - 0.050, 0.100 + 1.137};
constexpr Cylinder kJib = {0.160, 0.090, 1.020 - 0.050, 0.100 + 0.900};
constexpr Vec kLiftFoot = {-0.221712, 0.22223}, kLiftHead = {-0.221712, 0.165};  // pillar, lift boom
constexpr Vec kJibFoot = {-0.70, -0.25}, kJibHead = {0, -0.35};                  // lift boom, jib
constexpr double kSealFriction = 1000, kSealSpeed = 1e-4, kEfficiency = 0.9;
constexpr Vec kFriction[] = {{0, 0},         {0.0001, 1},  {0.025, 0.9}, {0.05, 0.4},  {0.075, 0.225}, {0.1, 0.2},
                             {0.125, 0.225}, {0.2, 0.275}, {0.3, 0.35},  {0.4, 0.415}, {1, 0.8},       {3, 0.85}};

constexpr double kOil = 1.5e9, kBarrel = 1e10, kHoseWall = 5e8, kAirReference = 1e5, kPolytropic = 1.2;  // Pa, Pa, -
constexpr double kDeadVolume = 0.1e-3, kHoseVolume = std::numbers::pi / 4 * 0.01905 * 0.01905 * 1.5;     // m3
constexpr double kLitrePerMinute = 1e-3 / 60;
constexpr double kPistonLeak = 0.01 * kLitrePerMinute / 100e5, kValveLeak = 0.1 * kLitrePerMinute / 100e5;
constexpr double kCrack = 0.2e5, kTransition = 0.1e5;  // Pa, anti-cavitation: 100 l/min at 5 bar

Vec turned(double theta, const Vec& r) {
  const double c = std::cos(theta), s = std::sin(theta);
  return {c * r[0] - s * r[1], s * r[0] + c * r[1]};
}

// derivative of a turned arm with respect to its angle
Vec across(const Vec& r) {
  return {-r[1], r[0]};
}

double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1];
}

// length of a cylinder and its slopes over the two boom angles
struct Line {
  double stroke;
  Vec lever;
};

Line lift_line(double boom) {
  const Vec head = turned(boom, kLiftHead);
  const Vec e = {kHinge[0] + head[0] - kLiftFoot[0], kHinge[1] + head[1] - kLiftFoot[1]};
  const double length = std::sqrt(dot(e, e));
  return {length - kLift.closed_length, {dot(e, across(head)) / length, 0}};
}

Line jib_line(double boom, double jib) {
  const Vec base = turned(boom, {kJibHinge[0] - kJibFoot[0], kJibHinge[1] - kJibFoot[1]}), head = turned(jib, kJibHead);
  const Vec e = {base[0] + head[0], base[1] + head[1]};
  const double length = std::sqrt(dot(e, e));
  return {length - kJib.closed_length, {dot(e, across(base)) / length, dot(e, across(head)) / length}};
}

double friction_coefficient(double speed) {
  for (std::size_t i = 1; i < std::size(kFriction); ++i) {
    const auto [v_0, f_0] = kFriction[i - 1];
    const auto [v_1, f_1] = kFriction[i];
    if (speed <= v_1) return f_0 + (f_1 - f_0) * (speed - v_0) / (v_1 - v_0);
  }
  return std::end(kFriction)[-1][1];
}

double line_force(const Cylinder& cylinder, double p_a, double p_b, double v) {
  const double F = p_a * cylinder.area_a() - p_b * cylinder.area_b(), speed = std::fabs(v);
  const double friction = std::fabs(F) * (1 - kEfficiency) * friction_coefficient(speed) +
                          kSealFriction * std::min(1.0, speed / kSealSpeed);
  return F - std::copysign(friction, v);
}

// from the tank into a chamber through its closed valve
double valve_flow(double p) {
  static const double K = 100 * kLitrePerMinute / std::sqrt(5e5 - kCrack);
  const double d = kTank - kCrack - p;
  const double feed = d > 0 ? K * d / std::pow(d * d + kTransition * kTransition, 0.25) : 0;
  return feed + kValveLeak * (kTank - p);
}

// Gaussian elimination; M is positive definite
std::array<double, 3> solved(std::array<std::array<double, 3>, 3> M, std::array<double, 3> b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t r = i + 1; r < 3; ++r) {
      const double factor = M[r][i] / M[i][i];
      for (std::size_t c = i; c < 3; ++c) M[r][c] -= factor * M[i][c];
      b[r] -= factor * b[i];
    }
  }
  for (std::size_t i = 3; i-- > 0;) {
    for (std::size_t c = i + 1; c < 3; ++c) b[i] -= M[i][c] * b[c];
    b[i] /= M[i][i];
  }
  return b;
}

}  // namespace

PlanarCrane::PlanarCrane(double p, double air) : air_(air), y_{-15 * kDegree, 10 * kDegree, 0, 0, 0, 0, p, p, p, p} {}

double PlanarCrane::kappa(double p) const {
  const double oil = std::exp(-(p - kAirReference) / kOil);
  const double air = air_ * std::pow(kAirReference / p, 1 / kPolytropic);
  return (oil / kOil + air / (kPolytropic * p)) / (oil + air);
}

std::array<double, 3> PlanarCrane::accelerations(const State& y, const std::array<double, 3>& torque) const {
  std::array<std::array<double, 3>, 3> M{};
  std::array<double, 3> h = torque;
  for (const Body& body : kBodies) {
    // columns of the centre's Jacobian; its acceleration at constant rates, and gravity
    std::array<Vec, 3> J{};
    Vec a = {0, -kGravity};
    for (std::size_t k = 0; k < body.arms; ++k) {
      const Vec r = turned(y[k], body.arm[k]);
      J[k] = across(r);
      for (std::size_t i = 0; i < 2; ++i) a[i] += r[i] * y[3 + k] * y[3 + k];
    }
    for (std::size_t i = 0; i < body.arms; ++i) {
      for (std::size_t j = 0; j < body.arms; ++j) M[i][j] += body.mass * dot(J[i], J[j]);
      h[i] += body.mass * dot(J[i], a);
    }
    M[body.arms - 1][body.arms - 1] += body.inertia;
  }
  return solved(M, h);
}

PlanarCrane::State PlanarCrane::rates(const State& y) const {
  const std::array<const Cylinder*, 2> cylinders = {&kLift, &kJib};
  const std::array<Line, 2> lines = {lift_line(y[0]), jib_line(y[0], y[1])};
  const double swing = kBagDamping * (y[5] - y[4]);
  std::array<double, 3> torque = {0, swing, -swing};
  State f{};
  for (std::size_t k = 0; k < 2; ++k) {
    const Cylinder& cylinder = *cylinders[k];
    const double s = lines[k].stroke, v = dot(lines[k].lever, {y[3], y[4]}), p_a = y[6 + 2 * k], p_b = y[7 + 2 * k];
    const double F = line_force(cylinder, p_a, p_b, v);
    torque[0] += F * lines[k].lever[0];
    torque[1] += F * lines[k].lever[1];

    const auto capacity = [&](double p, double chamber) {
      return (chamber + kDeadVolume) * (kappa(p) + 1 / kBarrel) + kHoseVolume * (kappa(p) + 1 / kHoseWall);
    };
    const double leak = kPistonLeak * (p_a - p_b);
    f[6 + 2 * k] = (valve_flow(p_a) - leak - v * cylinder.area_a()) / capacity(p_a, cylinder.area_a() * s);
    f[7 + 2 * k] = (valve_flow(p_b) + leak + v * cylinder.area_b()) /
                   capacity(p_b, cylinder.area_b() * (cylinder.piston_travel - s));
  }
  const std::array<double, 3> acceleration = accelerations(y, torque);
  for (std::size_t i = 0; i < 3; ++i) {
    f[i] = y[3 + i];
    f[3 + i] = acceleration[i];
  }
  return f;
}

void PlanarCrane::advance(double seconds) {
  const auto moved = [this](const State& f, double h) {
    State y = y_;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * f[i];
    return y;
  };
  const auto steps = std::llround(seconds / kStep);
  for (auto n = 0 * steps; n < steps; ++n) {
    const State f_1 = rates(y_), f_2 = rates(moved(f_1, kStep / 2)), f_3 = rates(moved(f_2, kStep / 2));
    const State f_4 = rates(moved(f_3, kStep));
    for (std::size_t i = 0; i < y_.size(); ++i) y_[i] += kStep / 6 * (f_1[i] + 2 * f_2[i] + 2 * f_3[i] + f_4[i]);
  }
}

double PlanarCrane::bag_height() const {
  return kPillarHeight + kHinge[1] + turned(y_[0], kJibHinge)[1] + turned(y_[1], kBagHinge)[1] +
         turned(y_[2], kBagCentre)[1];
}

}  // namespace slew::coupling::test
