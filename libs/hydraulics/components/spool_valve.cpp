// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/spool_valve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/curve.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Range kSpoolOverlapRange{.min = -1, .max = 1};

template <auto Edge>
constexpr ReadBy read_without_curve(std::string_view key, std::string_view what) {
  return {key, what,
          [](const void* def) noexcept { return (static_cast<const SpoolValveDef*>(def)->*Edge).curve.empty(); }};
}

constexpr ReadBy kReadByOverlapPa[] = {read_without_curve<&SpoolValveDef::pa>("curve_pa", "no curve_pa")};
constexpr ReadBy kReadByOverlapBt[] = {read_without_curve<&SpoolValveDef::bt>("curve_bt", "no curve_bt")};
constexpr ReadBy kReadByOverlapPb[] = {read_without_curve<&SpoolValveDef::pb>("curve_pb", "no curve_pb")};
constexpr ReadBy kReadByOverlapAt[] = {read_without_curve<&SpoolValveDef::at>("curve_at", "no curve_at")};
constexpr ReadBy kReadByClosing[] = {{"bypass_curve", "no bypass_curve", [](const void* def) noexcept {
                                        return static_cast<const SpoolValveDef*>(def)->bypass_curve.empty();
                                      }}};

template <auto Edge>
constexpr Field area_field(std::string_view key, std::string_view doc) {
  return field<Edge, &MeteringEdge::area>(
      key, {.dimension = Dimension::area, .range = kNotNegative, .change = Change::live, .doc = doc});
}

template <auto Edge>
constexpr Field overlap_field(std::string_view key, std::span<const ReadBy> read_by, std::string_view doc) {
  return field<Edge, &MeteringEdge::overlap>(
      key, {.range = kSpoolOverlapRange, .change = Change::live, .read_by = read_by, .doc = doc});
}

template <auto Edge>
constexpr Field curve_field(std::string_view key, std::string_view doc) {
  return field<Edge, &MeteringEdge::curve>(key, {.reference = "curve", .doc = doc});
}

constexpr Field kSpoolValveFields[] = {
    field<&SpoolValveDef::port_p>(
        "port_p", {.presence = Presence::required, .reference = "volume", .doc = "volume at the supply"}),
    field<&SpoolValveDef::port_a>("port_a",
                                  {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
    field<&SpoolValveDef::port_b>("port_b",
                                  {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
    field<&SpoolValveDef::port_t>(
        "port_t", {.presence = Presence::required, .reference = "volume", .doc = "volume at the return"}),
    field<&SpoolValveDef::port_c>("port_c",
                                  {.reference = "volume", .doc = "volume at the bypass's inlet, without it port_p"}),
    field<&SpoolValveDef::port_d>("port_d",
                                  {.reference = "volume", .doc = "volume at the bypass's outlet, without it port_t"}),
    field<&SpoolValveDef::maximum_control_signal>("maximum_control_signal",
                                                  {.dimension = Dimension::electric_signal,
                                                   .range = kPositive,
                                                   .doc = "control signal of the spool's full travel"}),
    field<&SpoolValveDef::step_response>("step_response", {.dimension = Dimension::time,
                                                           .range = kPositive,
                                                           .change = Change::live,
                                                           .doc = "three time constants of the opening"}),
    field<&SpoolValveDef::discharge_coefficient>("discharge_coefficient",
                                                 {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    area_field<&SpoolValveDef::pa>("area_pa", "area of edge P-A, fully open; 0: blocked"),
    area_field<&SpoolValveDef::bt>("area_bt", "area of edge B-T, fully open; 0: blocked"),
    area_field<&SpoolValveDef::pb>("area_pb", "area of edge P-B, fully open; 0: blocked"),
    area_field<&SpoolValveDef::at>("area_at", "area of edge A-T, fully open; 0: blocked"),
    overlap_field<&SpoolValveDef::pa>("overlap_pa", kReadByOverlapPa,
                                      "overlap of edge P-A, share of the spool's travel; negative: underlap"),
    overlap_field<&SpoolValveDef::bt>("overlap_bt", kReadByOverlapBt,
                                      "overlap of edge B-T, share of the spool's travel; negative: underlap"),
    overlap_field<&SpoolValveDef::pb>("overlap_pb", kReadByOverlapPb,
                                      "overlap of edge P-B, share of the spool's travel; negative: underlap"),
    overlap_field<&SpoolValveDef::at>("overlap_at", kReadByOverlapAt,
                                      "overlap of edge A-T, share of the spool's travel; negative: underlap"),
    curve_field<&SpoolValveDef::pa>("curve_pa",
                                    "opening of edge P-A in multiples of area_pa over the spool's position -1..1"),
    curve_field<&SpoolValveDef::bt>("curve_bt",
                                    "opening of edge B-T in multiples of area_bt over the spool's position -1..1"),
    curve_field<&SpoolValveDef::pb>("curve_pb",
                                    "opening of edge P-B in multiples of area_pb over the spool's position -1..1"),
    curve_field<&SpoolValveDef::at>("curve_at",
                                    "opening of edge A-T in multiples of area_at over the spool's position -1..1"),
    field<&SpoolValveDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                   .range = kNotNegative,
                                                   .change = Change::live,
                                                   .doc = "leak of each of the four edges at leak_pressure"}),
    field<&SpoolValveDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
    field<&SpoolValveDef::bypass_area>("bypass_area", {.dimension = Dimension::area,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "area of the open bypass; 0: closed centre"}),
    field<&SpoolValveDef::bypass_closing>(
        "bypass_closing",
        {.range = kFraction, .read_by = kReadByClosing, .doc = "travel from which on the bypass closes"}),
    field<&SpoolValveDef::bypass_closed>(
        "bypass_closed",
        {.range = kFractionAboveZero, .read_by = kReadByClosing, .doc = "travel from which on the bypass is closed"}),
    field<&SpoolValveDef::bypass_curve>(
        "bypass_curve", {.reference = "curve",
                         .doc = "opening of the bypass in multiples of bypass_area over the spool's position -1..1"}),
};

constexpr double kEdgeWidth = 1e-3;         // share of the opening, smoothing where an edge uncovers its port
constexpr double kBypassWidth = 0.02;       // share of the opening, smoothing of the bypass's limits
constexpr double kTravelTimeConstants = 3;  // in a step response, to 95 % of the change

// An edge between two volumes as a function of the spool position.
struct Edge {
  StateIndex from, to;
  CurveFunction curve;   // empty: by overlap
  double direction = 1;  // +1: a positive position opens it; 0: the bypass
  double begin = 0;      // position at which it opens
  double gain = 1;       // opening over position
  double K = 0;          // m3/s/sqrt(Pa) at x = 1
  double G = 0;          // m3/s/Pa

  [[nodiscard]] ValueSlope opening(double s) const noexcept {
    if (!curve.empty()) return curve.at(s);
    if (direction == 0) {
      const ValueSlope x = unit_clip((begin - std::fabs(s)) * gain, kBypassWidth);
      return {x.value, s < 0 ? gain * x.slope : -gain * x.slope};
    }
    const ValueSlope x = ramp((direction * s - begin) * gain, kEdgeWidth);
    return {x.value, direction * gain * x.slope};
  }
};

class SpoolValve final : public HydraulicComponent {
 public:
  SpoolValve(const SpoolValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        spool_(builder.add_state({.initial = 0, .scale = 1})),
        control_(builder.add_control(def.name, SignalMoves::a_state)),
        transition_(builder.def().orifice_transition),
        root_2_rho_(std::sqrt(2 / builder.def().oil_density)) {
    const StateIndex p = builder.volume(def.port_p), t = builder.volume(def.port_t);
    const StateIndex a = builder.volume(def.port_a), b = builder.volume(def.port_b);
    const StateIndex c = def.port_c.empty() ? p : builder.volume(def.port_c);
    const StateIndex d = def.port_d.empty() ? t : builder.volume(def.port_d);
    const auto function = [&](const std::string& curve) {
      return curve.empty() ? CurveFunction{} : CurveFunction(*find_curve(builder.def(), curve));
    };
    edges_ = {Edge{p, a, function(def.pa.curve), 1}, Edge{b, t, function(def.bt.curve), 1},
              Edge{p, b, function(def.pb.curve), -1}, Edge{a, t, function(def.at.curve), -1},
              Edge{c, d, function(def.bypass_curve), 0}};
    apply_parameters();
  }

  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add(spool_, spool_);
    for (const Edge& edge : edges_) {
      dependencies.add_restriction(edge.from, edge.to);
      dependencies.add(edge.from, spool_), dependencies.add(edge.to, spool_);
    }
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(spool_, rate_ * (command(view) - view[spool_]));
    for (const Edge& edge : edges_) rates.move(edge.from, edge.to, flow(edge, view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    jacobian.add(spool_, spool_, -rate_);
    for (const Edge& edge : edges_) stamp(edge, flow(edge, view), jacobian);
  }
  void add_rates_and_jacobian(const CircuitView& view, Rates& rates, JacobianStamp& jacobian) const noexcept override {
    rates.set_rate(spool_, rate_ * (command(view) - view[spool_]));
    jacobian.add(spool_, spool_, -rate_);
    for (const Edge& edge : edges_) {
      const EdgeFlow Q = flow(edge, view);
      rates.move(edge.from, edge.to, Q.value);
      stamp(edge, Q, jacobian);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("control_signal", Dimension::electric_signal));
    variables.push_back(variable("spool_position", Dimension::none));
    for (const char* flow : {"flow_pa", "flow_bt", "flow_pb", "flow_at", "bypass_flow"}) {
      variables.push_back(variable(flow, Dimension::volume_flow));
    }
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view.control[control_];
    *values++ = view[spool_];
    for (const Edge& edge : edges_) *values++ = flow(edge, view).value;
    return values;
  }
  void follow_oil(const PortOil& oil) noexcept override {
    const Edge& supply = edges_[0];
    const StateIndex tank = edges_[1].to;
    root_2_rho_ = std::sqrt(2 / oil.between(supply.from, tank).density);
    fluidity_ = oil.fluidity(supply.from, tank);
    apply_parameters();
  }
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    for (const Edge& edge : edges_) passages.move(edge.from, edge.to, flow(edge, view).value);
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    rate_ = kTravelTimeConstants / def_.step_response;
    const double c = def_.discharge_coefficient * root_2_rho_, G = fluidity_ * def_.leak_flow / def_.leak_pressure;
    const MeteringEdge* const metering[] = {&def_.pa, &def_.bt, &def_.pb, &def_.at};
    for (std::size_t i = 0; i < std::size(metering); ++i) {
      edges_[i].begin = metering[i]->overlap;
      edges_[i].gain = 1 / (1 - metering[i]->overlap);
      edges_[i].K = metering[i]->area * c;
      edges_[i].G = G;
    }
    Edge& bypass = edges_.back();
    bypass.begin = def_.bypass_closed;
    bypass.gain = 1 / (def_.bypass_closed - def_.bypass_closing);
    bypass.K = def_.bypass_area * c;
  }

 private:
  struct EdgeFlow {
    double value, d_position, d_drop;
  };
  // (2), (4)
  [[nodiscard]] EdgeFlow flow(const Edge& edge, const CircuitView& view) const noexcept {
    const double drop = view[edge.from] - view[edge.to];
    const ValueSlope x = edge.opening(view[spool_]);
    if (!(x.value > 0) || edge.K == 0) return {edge.G * drop, 0, edge.G};
    const ValueSlope r = root(drop, transition_);
    return {x.value * edge.K * r.value + edge.G * drop, x.slope * edge.K * r.value,
            x.value * edge.K * r.slope + edge.G};
  }
  void stamp(const Edge& edge, const EdgeFlow& Q, JacobianStamp& jacobian) const noexcept {
    jacobian.move(edge.from, edge.to, edge.from, Q.d_drop);
    jacobian.move(edge.from, edge.to, edge.to, -Q.d_drop);
    jacobian.move(edge.from, edge.to, spool_, Q.d_position);
  }
  [[nodiscard]] double command(const CircuitView& view) const noexcept {
    return std::clamp(view.control[control_] / def_.maximum_control_signal, -1.0, 1.0);
  }

  SpoolValveDef def_;
  StateIndex spool_;  // -1..1
  int control_;
  double transition_, root_2_rho_;
  double fluidity_ = 1;  // of the oil, for leaks
  double rate_ = 0;      // 1/tau
  std::array<Edge, 5> edges_;
};

void check_edge_curve(const HydraulicsDef& circuit, const std::string& path, const std::string& name,
                      Problems& errors) {
  const CurveDef* curve = name.empty() ? nullptr : find_curve(circuit, name);
  if (curve == nullptr) return;
  const auto is_negative = [](const auto& point) { return point[1] < 0; };
  if (curve->odd || std::any_of(curve->points.begin(), curve->points.end(), is_negative)) {
    errors.push_back({path, fmt::format("the curve '{}' has negative openings", name),
                      "values >= 0 over positions from -1 to 1, without odd: true", ""});
  }
  if (curve->points.empty()) return;
  const double first = curve->points.front()[0], last = curve->points.back()[0];
  if (first < -1 || last > 1) {
    errors.push_back({path, fmt::format("the curve '{}' goes from {:g} to {:g}", name, first, last),
                      "positions within -1 to 1, shares of the spool's travel: per cent over 100, mm over the stroke",
                      ""});
  }
}

// A live area may open what is blocked at the start, so these are warnings.
void warn_of_blocked_edges(const SpoolValveDef& def, Problems& warnings) {
  const auto warn = [&](std::string_view key, std::string_view area, bool is_stated, double opened) {
    if (!is_stated || opened > 0) return;
    warnings.push_back({fmt::format("{}.{}", def.name, key),
                        fmt::format("it has no effect: {} is 0, so that nothing flows there", area),
                        fmt::format("{}, or no such key", area), ""});
  };
  warn("curve_pa", "area_pa", !def.pa.curve.empty(), def.pa.area);
  warn("curve_bt", "area_bt", !def.bt.curve.empty(), def.bt.area);
  warn("curve_pb", "area_pb", !def.pb.curve.empty(), def.pb.area);
  warn("curve_at", "area_at", !def.at.curve.empty(), def.at.area);
  warn("port_c", "bypass_area", !def.port_c.empty(), def.bypass_area);
  warn("port_d", "bypass_area", !def.port_d.empty(), def.bypass_area);
  warn("bypass_curve", "bypass_area", !def.bypass_curve.empty(), def.bypass_area);
}

void validate_spool_valve(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                          Problems& warnings) {
  const SpoolValveDef& def = static_cast<const SpoolValveDef&>(component);
  check_distinct(def.name + ".port_b", def.port_a, def.port_b, errors);
  check_distinct(def.name + ".port_t", def.port_p, def.port_t, errors);
  check_edge_curve(circuit, def.name + ".curve_pa", def.pa.curve, errors);
  check_edge_curve(circuit, def.name + ".curve_bt", def.bt.curve, errors);
  check_edge_curve(circuit, def.name + ".curve_pb", def.pb.curve, errors);
  check_edge_curve(circuit, def.name + ".curve_at", def.at.curve, errors);
  check_edge_curve(circuit, def.name + ".bypass_curve", def.bypass_curve, errors);
  if (!(def.bypass_closing < def.bypass_closed)) {
    errors.push_back({def.name + ".bypass_closed", "the bypass is closed before it begins to close",
                      "more than bypass_closing", ""});
  }
  warn_of_blocked_edges(def, warnings);
}

}  // namespace

ComponentType spool_valve_type() {
  return {.name = "spool_valve",
          .fields = kSpoolValveFields,
          .doc = "directional spool valve with metering edges of their own, closed or open centre",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<SpoolValveDef>(); },
          .validate = validate_spool_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<SpoolValve>(static_cast<const SpoolValveDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
