// SPDX-License-Identifier: Apache-2.0
#include "tests/properties/coupling/oscillator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "coupling/port_dynamics.h"
#include "hydraulics/line_chambers.h"
#include "math/rodas3.h"

namespace slew::coupling::test {
namespace {

constexpr double kMicroPhase = 0.075;  // rad: the nodes' 0.25 ms on an oil spring of 300 rad/s

// f = z - d v
class DampedLine final : public RowLaws {
 public:
  explicit DampedLine(double d) : d_(d) {}
  RowForce evaluate(std::size_t, double z, double, double v) const noexcept override { return {z - d_ * v, 1, 0, -d_}; }

 private:
  double d_;
};

// y = [F, x, v] with the mass as the mechanics publishes it, or with the speed held
class OilSpring final : public math::StiffSystem {
 public:
  OilSpring(double lambda, double d, Level level) : lambda_(lambda), d_(d), W_(level == Level::two ? 1 : 0) {}
  void derivative(const double* y, double* f) noexcept override {
    f[0] = -y[2] - lambda_ * y[0];
    f[1] = y[2];
    f[2] = W_ * (y[0] - d_ * y[2]);
  }
  const double* jacobian(const double*, const double*) noexcept override {
    J_ = {-lambda_, 0, -1, 0, 0, 1, W_, 0, -W_ * d_};
    return J_.data();
  }
  void accepted(double, const double*, const double*, double*) noexcept override {}

 private:
  double lambda_, d_, W_;
  std::array<double, 9> J_{};
};

math::Rodas3 solver() {
  math::SparsityPattern pattern(3);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) pattern.add(i, j);
  }
  return {
      pattern, 3, {.relative_tolerance = 1e-6, .substep_budget = 100000, .scale = {1, 1, 1}, .relative = {1, 0, 1}}};
}

}  // namespace

// A chamber of capacity 1 as a line: the circuit's part p of it, and the waves
struct Line {
  double Z, c_h, c_m, x = 0;
  double p = 0;

  // the exchange: waves sent by the piston during the finished step
  void take(double x_new, double H, double c_m_new) {
    c_h = c_m - 2 * Z * (x_new - x) / H;
    c_m = c_m_new;
    x = x_new;
  }
  // kLumpedShare p' = -lambda p - (p - c_h) / Z over H, exactly; the wave towards the piston in the next step
  [[nodiscard]] double advance(double H, double lambda) {
    const double rate = (lambda + 1 / Z) / hydraulics::kLumpedShare;
    const double rest = c_h / Z / (lambda + 1 / Z);
    const double decay = -std::expm1(-rate * H);
    const double mean = rest + (p - rest) * decay / (rate * H);
    p = rest + (p - rest) * (1 - decay);
    return 2 * mean - c_h;
  }
};

struct SplitOscillator::Halves {
  OscillatorDef def;
  DampedLine line;
  OilSpring spring;
  PortDynamics mechanics{1};
  math::Rodas3 rodas;
  double x = 0, v = 1;                  // mechanics' state
  std::array<double, 3> y = {0, 0, 1};  // hydraulics' F, x, v
  Line line_of_oil{};
  double c_m_next = 0;
  bool is_begun = false;
};

SplitOscillator::SplitOscillator(const OscillatorDef& def)
    : halves_(new Halves{.def = def,
                         .line = DampedLine(2 * def.zeta),
                         .spring = OilSpring(def.lambda, 2 * def.zeta, def.level),
                         .rodas = solver()}) {
  // a line through which the piston's flow runs
  const double Z = def.Omega / (1 - hydraulics::kLumpedShare);
  halves_->line_of_oil = {.Z = Z, .c_h = -Z, .c_m = Z};
  halves_->c_m_next = Z;
}

SplitOscillator::~SplitOscillator() = default;

void SplitOscillator::step_of_line() {
  Halves& s = *halves_;
  const double H = s.def.Omega, v_ref = s.v;
  const double c_m = s.c_m_next;
  if (s.is_begun) s.line_of_oil.take(s.x, H, c_m);
  s.is_begun = true;
  s.mechanics.set_rows(1);
  s.mechanics.x()[0] = s.x;
  s.mechanics.v()[0] = s.v;
  s.mechanics.W()[0] = 1;
  s.mechanics.a_free()[0] = 0;
  const double F = c_m - s.line_of_oil.Z * v_ref;
  s.mechanics.z()[0] = F;
  s.mechanics.partner()[0] = {0, 0, 0, s.line_of_oil.Z, F, v_ref};
  s.mechanics.solve(H, std::max(1, static_cast<int>(std::ceil(H / kMicroPhase))), s.line);
  s.x = s.mechanics.x()[0];
  s.v = s.mechanics.v()[0];
  s.c_m_next = s.line_of_oil.advance(H, s.def.lambda);
}

void SplitOscillator::step() {
  Halves& s = *halves_;
  if (s.def.level == Level::tlm) return step_of_line();
  // both samples of this instant; K = m = 1
  const double F = s.y[0], x_ref = s.y[1], v_ref = s.y[2], x = s.x, v = s.v;
  const bool is_hold = s.def.level == Level::hold;
  // mechanics
  s.mechanics.set_rows(1);
  s.mechanics.x()[0] = x;
  s.mechanics.v()[0] = v;
  s.mechanics.W()[0] = 1;
  s.mechanics.a_free()[0] = 0;
  s.mechanics.z()[0] = is_hold ? F : F - (x - x_ref);
  s.mechanics.partner()[0] =
      is_hold ? RowPartner{} : RowPartner{-v_ref - s.def.lambda * F, 1, s.def.lambda, 0, F, v_ref};
  const int micro_steps = std::max(1, static_cast<int>(std::ceil(s.def.Omega / kMicroPhase)));
  s.mechanics.solve(s.def.Omega, micro_steps, s.line);
  s.x = s.mechanics.x()[0];
  s.v = s.mechanics.v()[0];
  // hydraulics: the oil follows the true position
  if (s.def.volume == Volume::consistent) {
    s.y[0] -= x - x_ref;
    s.y[1] = x;
  }
  s.y[2] = v;
  s.rodas.advance(s.spring, s.y, s.def.Omega);
}

double SplitOscillator::speed() const {
  return halves_->v;
}

double SplitOscillator::amplitude() const {
  const Halves& s = *halves_;
  if (s.def.level == Level::tlm) return std::hypot(s.v, 0.5 * (s.line_of_oil.c_h + s.line_of_oil.c_m));
  return std::hypot(s.v, s.def.volume == Volume::consistent ? s.y[0] - (s.x - s.y[1]) : s.y[0]);
}

double frequency(const OscillatorDef& def, int exchanges) {
  SplitOscillator oscillator(def);
  double first = 0, last = 0, before = oscillator.speed();
  int zeros = 0;
  for (int i = 0; i < exchanges; ++i) {
    oscillator.step();
    const double v = oscillator.speed();
    if (before * v < 0) {
      last = (i + before / (before - v)) * def.Omega;
      if (zeros++ == 0) first = last;
    }
    before = v;
  }
  return (zeros - 1) * std::numbers::pi / (last - first);
}

double growth_rate(const OscillatorDef& def, int exchanges) {
  SplitOscillator oscillator(def);
  // maxima over a quarter of the run each
  const int part = exchanges / 4;
  double early = 0, late = 0;
  for (int i = 0; i < exchanges; ++i) {
    oscillator.step();
    if (i < part) early = std::max(early, oscillator.amplitude());
    if (i >= exchanges - part) late = std::max(late, oscillator.amplitude());
  }
  return std::log(late / early) / (def.Omega * (exchanges - part));
}

}  // namespace slew::coupling::test
