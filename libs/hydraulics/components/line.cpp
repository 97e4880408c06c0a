// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/line.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Range kModesRange{.min = 1, .max = 20, .min_is_open = false, .max_is_open = false};
constexpr double kLaminarEnd = 2300, kTurbulentBegin = 4000;  // Reynolds numbers
constexpr double kTransitionWidth = 0.1;                      // share of the transition, smoothing of its ends
constexpr double kBlasius = 0.3164, kLaminarFactor = 64;      // friction factors: kBlasius/Re^(1/4), kLaminarFactor/Re
constexpr double kPressureScale = 1e6;                        // Pa, of the modal pressures
constexpr int kWeights = 3;                                   // terms of Trikha's weighting function
constexpr double kDecay[kWeights] = {26.4, 200, 8000}, kWeight[kWeights] = {1, 8.1, 40};  // n_k, m_k
constexpr double pi = std::numbers::pi;

constexpr Field kLineFields[] = {
    field<&LineDef::port_1>("port_1", port_options("volume at the beginning")),
    field<&LineDef::port_2>("port_2", port_options("volume at the end")),
    field<&LineDef::length>(
        "length",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "length"}),
    field<&LineDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "inner diameter"}),
    field<&LineDef::bulk_modulus>("bulk_modulus", {.dimension = Dimension::pressure,
                                                   .range = kNotNegative,
                                                   .doc = "effective modulus of oil and wall; 0: that of the oil"}),
    field<&LineDef::modes>("modes", {.range = kModesRange, .doc = "natural frequencies that are modelled"}),
    field<&LineDef::loss_1>("loss_1", {.range = kNotNegative,
                                       .change = Change::live,
                                       .doc = "minor losses at port_1, in multiples of the dynamic pressure"}),
    field<&LineDef::loss_2>("loss_2", {.range = kNotNegative,
                                       .change = Change::live,
                                       .doc = "minor losses at port_2, in multiples of the dynamic pressure"}),
};

class Line final : public HydraulicComponent {
 public:
  Line(const LineDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        n_(static_cast<int>(def.modes)),
        rho_(builder.def().oil_density),
        nu_(builder.def().oil_viscosity),
        A_(0.25 * pi * def.diameter * def.diameter),
        modulus_(def.bulk_modulus > 0 ? def.bulk_modulus : builder.def().oil_bulk_modulus),
        floor_(builder.def().pressure_floor),
        a_(4 * nu_ / (def.diameter * def.diameter)) {
    for (int i = 0; i <= n_; ++i) add_to_first(q_, builder.add_state({.initial = 0, .scale = 1}), i);
    for (int i = 1; i <= n_; ++i) add_to_first(P_, builder.add_state({.initial = 0, .scale = kPressureScale}), i - 1);
    for (int i = 0; i < kWeights * (n_ + 1); ++i) {
      add_to_first(z_, builder.add_state({.initial = 0, .scale = 1}), i);
    }
    for (int k = 1; k <= n_; ++k) {
      for (int i = 1; i <= n_; ++i) sine_.push_back(std::sin(i * pi * k / (n_ + 1)));
    }
    add_rest(builder);
    apply_parameters();
  }
  // oil at rest, the pressure straight from end to end
  void start(double* y) const noexcept override {
    for (int i = 1; i <= n_; ++i) y[P_ + i - 1] = 2 / (i * pi) * (y[p_1_] - sign(i) * y[p_2_]);
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (int i = 0; i <= n_; ++i) {
      for (const StateIndex port : {p_1_, p_2_}) dependencies.add(port, q_ + i), dependencies.add(q_ + i, port);
      for (int j = 0; j <= n_; ++j) dependencies.add(q_ + i, q_ + j);
      for (int k = 0; k < kWeights; ++k) {
        dependencies.add(q_ + i, z(i, k)), dependencies.add(z(i, k), q_ + i), dependencies.add(z(i, k), z(i, k));
      }
      if (i == 0) continue;
      dependencies.add(q_ + i, P_ + i - 1), dependencies.add(P_ + i - 1, q_ + i);
    }
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    const Ends now = ends(view);
    rates.add_flow(p_1_, -now.Q_1);
    rates.add_flow(p_2_, now.Q_2);
    const double e_1 = view[p_1_] - Z_1_ * std::fabs(now.Q_1) * now.Q_1;
    const double e_2 = view[p_2_] + Z_2_ * std::fabs(now.Q_2) * now.Q_2;
    for (int i = 0; i <= n_; ++i) {
      const double q = view[q_ + i];
      double unsteady = 0;
      for (int k = 0; k < kWeights; ++k) {
        const double y = view[z(i, k)] + kWeight[k] * q;
        unsteady += y;
        rates.set_rate(z(i, k), -kDecay[k] * a_ * y);
      }
      const double drag = 8 * a_ * (i == 0 ? friction(q).value : 1) * q + 4 * a_ * unsteady;
      if (i == 0) {
        rates.set_rate(q_, gain_ * (e_1 - e_2) - drag);
        continue;
      }
      const double spring = 0.5 * i * pi * view[P_ + i - 1];
      rates.set_rate(q_ + i, 2 * gain_ * (e_1 - sign(i) * e_2 - spring) - drag);
      rates.set_rate(P_ + i - 1, modulus_ * i * pi / (A_ * def_.length) * unit_ * q);
    }
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const Ends now = ends(view);
    const double d_1 = -2 * Z_1_ * std::fabs(now.Q_1) * unit_, d_2 = 2 * Z_2_ * std::fabs(now.Q_2) * unit_;
    const ValueSlope f = friction(view[q_]);
    for (int i = 0; i <= n_; ++i) {
      jacobian.add(p_1_, q_ + i, -unit_);
      jacobian.add(p_2_, q_ + i, sign(i) * unit_);
      const double g = (i == 0 ? 1 : 2) * gain_;
      jacobian.add(q_ + i, p_1_, g);
      jacobian.add(q_ + i, p_2_, -sign(i) * g);
      for (int j = 0; j <= n_; ++j) jacobian.add(q_ + i, q_ + j, g * (d_1 - sign(i) * sign(j) * d_2));
      jacobian.add(q_ + i, q_ + i, -8 * a_ * (i == 0 ? f.value + f.slope * view[q_] : 1));
      for (int k = 0; k < kWeights; ++k) {
        jacobian.add(q_ + i, q_ + i, -4 * a_ * kWeight[k]);
        jacobian.add(q_ + i, z(i, k), -4 * a_);
        jacobian.add(z(i, k), q_ + i, -kDecay[k] * a_ * kWeight[k]);
        jacobian.add(z(i, k), z(i, k), -kDecay[k] * a_);
      }
      if (i == 0) continue;
      jacobian.add(q_ + i, P_ + i - 1, -gain_ * i * pi);
      jacobian.add(P_ + i - 1, q_ + i, modulus_ * i * pi / (A_ * def_.length) * unit_);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("flow_1", Dimension::volume_flow));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
    variables.push_back(variable("mean_flow", Dimension::volume_flow));
    variables.push_back(variable("middle_pressure", Dimension::pressure));
    variables.push_back(variable("is_cavitating", Dimension::none));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const Ends now = ends(view);
    *values++ = now.Q_1;
    *values++ = now.Q_2;
    *values++ = view[q_] * unit_;
    // sum of the sines' excess over those of the straight line, which converges fast
    double p = 0.5 * (view[p_1_] + view[p_2_]);
    for (int i = 1; i <= n_; i += 2) {
      const double straight = 2 / (i * pi) * (view[p_1_] + view[p_2_]);
      p += (i % 4 == 1 ? 1 : -1) * (view[P_ + i - 1] - straight);
    }
    *values++ = p;
    *values++ = first_cavitating(view) < 0 ? 0 : 1;
    return values;
  }
  // the oil inside counts half at either end
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    passages.move(p_1_, p_2_, view[q_] * unit_);
    for (const StateIndex port : {p_1_, p_2_}) passages.add_content(port, 0.5 * (1 - rest_) * A_ * def_.length);
  }
  void follow_oil(const PortOil& oil) noexcept override {
    const OilProperties& inside = oil.between(p_1_, p_2_);
    rho_ = inside.density, nu_ = inside.viscosity;
    a_ = 4 * nu_ / (def_.diameter * def_.diameter);
    apply_parameters();
  }
  // at n points between the ends, as many as there are modes
  [[nodiscard]] StateIndex first_cavitating(const CircuitView& view) const noexcept override {
    const double* sine = sine_.data();
    for (int k = 1; k <= n_; ++k) {
      const double s = static_cast<double>(k) / (n_ + 1);
      double p = (1 - s) * view[p_1_] + s * view[p_2_];
      for (int i = 1; i <= n_; ++i) p += (view[P_ + i - 1] - straight(view, i)) * *sine++;
      if (p < floor_) return P_;
    }
    return -1;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    unit_ = A_;  // 1 m/s
    gain_ = A_ / (rho_ * def_.length) / unit_;
    Z_1_ = 0.5 * def_.loss_1 * rho_ / (A_ * A_);
    Z_2_ = 0.5 * def_.loss_2 * rho_ / (A_ * A_);
  }

 private:
  struct Ends {
    double Q_1, Q_2;  // m3/s
  };
  [[nodiscard]] static double sign(int i) noexcept { return i % 2 == 0 ? 1 : -1; }
  // P_i of a pressure that is straight from end to end
  [[nodiscard]] double straight(const CircuitView& view, int i) const noexcept {
    return 2 / (i * pi) * (view[p_1_] - sign(i) * view[p_2_]);
  }
  // z_k of mode i
  [[nodiscard]] StateIndex z(int i, int k) const noexcept { return z_ + kWeights * i + k; }
  static void add_to_first(StateIndex& first, StateIndex state, int i) {
    if (i == 0) first = state;
  }
  // what the modes lack of the line's content, with the wall that makes the oil's modulus the line's
  void add_rest(CircuitBuilder& builder) {
    for (int i = 1; i <= n_; i += 2) rest_ -= 8 / (pi * pi * i * i);
    WallLaw wall;
    const double oil = builder.def().oil_bulk_modulus;
    if (modulus_ < oil) wall.lowest = wall.highest = 1 / (1 / modulus_ - 1 / oil);
    for (const StateIndex port : {p_1_, p_2_}) {
      builder.add_content({.volume_index = port, .volume = 0.5 * rest_ * A_ * def_.length, .wall = wall});
    }
  }
  // (3)
  [[nodiscard]] Ends ends(const CircuitView& view) const noexcept {
    double even = 0, odd = 0;
    for (int i = 0; i <= n_; i += 2) even += view[q_ + i];
    for (int i = 1; i <= n_; i += 2) odd += view[q_ + i];
    return {(even + odd) * unit_, (even - odd) * unit_};
  }
  // f of (6), with its slope over q_0 in units of the state
  [[nodiscard]] ValueSlope friction(double q_0) const noexcept {
    const double Re_per_q = def_.diameter * unit_ / (A_ * nu_), Re = std::fabs(q_0) * Re_per_q;
    if (Re <= kLaminarEnd) return {1, 0};
    constexpr double kSpan = kTurbulentBegin - kLaminarEnd;
    const ValueSlope t = unit_clip((Re - kLaminarEnd) / kSpan, kTransitionWidth);
    const double rough = kBlasius / kLaminarFactor * std::sqrt(Re * std::sqrt(Re));
    const double slope = (0.75 * rough / Re) * t.value + (rough - 1) * t.slope / kSpan;
    return {1 + (rough - 1) * t.value, std::copysign(slope * Re_per_q, q_0)};
  }

  LineDef def_;
  StateIndex p_1_, p_2_;
  int n_;
  StateIndex q_ = 0, P_ = 0, z_ = 0;  // first of q_0..q_n and z in units of unit_, of P_1..P_n in Pa
  double rho_, nu_, A_, modulus_;
  double floor_;              // Pa absolute, below which the oil cavitates
  std::vector<double> sine_;  // sin(i pi k/(n + 1)), k and i from 1 to n
  double rest_ = 1;           // share of the content at the ends
  double a_;                  // 1/s
  double unit_ = 1;           // m3/s
  double gain_ = 0;           // units of q_0' per Pa
  double Z_1_ = 0, Z_2_ = 0;
};

void validate_line(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const LineDef& def = static_cast<const LineDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
}

}  // namespace

void LineDef::add_lines(PumpLines& lines) const {
  lines.open.push_back({.a = port_1, .b = port_2});
}

ComponentType line_type() {
  return {.name = "line",
          .fields = kLineFields,
          .doc = "pipe or hose with inertia, waves and friction between two volumes",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LineDef>(); },
          .validate = validate_line,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Line>(static_cast<const LineDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
