// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/check_valves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"

namespace slew::hydraulics {
namespace {

// Rows that all check valves share.
template <typename Def>
constexpr auto poppet_fields() {
  using C = CheckParameters;
  return std::array{
      field<&Def::common, &C::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .change = Change::live,
                                                             .doc = "flow of the open valve at nominal_pressure_drop"}),
      field<&Def::common, &C::nominal_pressure_drop>(
          "nominal_pressure_drop",
          {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
      field<&Def::common, &C::crack_pressure>(
          "crack_pressure",
          {.dimension = Dimension::pressure, .range = kNotNegative, .doc = "pressure drop that lifts the poppet"}),
      field<&Def::common, &C::opening_pressure_rise>("opening_pressure_rise",
                                                     {.dimension = Dimension::pressure,
                                                      .range = kPositive,
                                                      .doc = "rise above crack_pressure that opens the valve fully"}),
  };
}

template <typename Def, std::size_t N>
constexpr auto with_poppet(const std::array<Field, N>& own) {
  constexpr auto poppet = poppet_fields<Def>();
  std::array<Field, N + poppet.size()> table;
  std::copy(poppet.begin(), poppet.end(), std::copy(own.begin(), own.end(), table.begin()));
  return table;
}

constexpr FieldOptions port(std::string_view doc) {
  return {.presence = Presence::required, .reference = "volume", .doc = doc};
}

constexpr FieldOptions kPilotRatio = {.range = kPositive, .doc = "area of the pilot piston over that of the seat"};

constexpr auto kCheckValveFields = with_poppet<CheckValveDef>(std::array{
    field<&CheckValveDef::port_1>("port_1", port("volume at the inlet")),
    field<&CheckValveDef::port_2>("port_2", port("volume at the outlet")),
});

constexpr auto kThrottleCheckValveFields = with_poppet<ThrottleCheckValveDef>(std::array{
    field<&ThrottleCheckValveDef::port_1>("port_1", port("volume from which oil flows freely")),
    field<&ThrottleCheckValveDef::port_2>("port_2", port("volume from which oil flows through the throttle")),
    field<&ThrottleCheckValveDef::throttle_flow>("throttle_flow",
                                                 {.dimension = Dimension::volume_flow,
                                                  .range = kPositive,
                                                  .presence = Presence::required,
                                                  .change = Change::live,
                                                  .doc = "flow of the open throttle at nominal_pressure_drop"}),
    field<&ThrottleCheckValveDef::throttle_opening>(
        "throttle_opening", {.range = kFraction, .change = Change::live, .doc = "opened fraction of the throttle"}),
});

constexpr auto kPilotCheckValveFields = with_poppet<PilotCheckValveDef>(std::array{
    field<&PilotCheckValveDef::port_1>("port_1", port("volume at the directional valve")),
    field<&PilotCheckValveDef::port_2>("port_2", port("volume at the load, which the valve closes")),
    field<&PilotCheckValveDef::port_3>("port_3", port("volume that pilots the valve")),
    field<&PilotCheckValveDef::port_4>(
        "port_4", {.reference = "volume", .doc = "volume behind the pilot piston, a drain, without it port_1"}),
    field<&PilotCheckValveDef::pilot_ratio>("pilot_ratio", kPilotRatio),
});

constexpr auto kDoublePilotCheckValveFields = with_poppet<DoublePilotCheckValveDef>(std::array{
    field<&DoublePilotCheckValveDef::port_a1>("port_a1", port("volume of line A at the valve")),
    field<&DoublePilotCheckValveDef::port_a2>("port_a2", port("volume of line A at the load")),
    field<&DoublePilotCheckValveDef::port_b1>("port_b1", port("volume of line B at the valve")),
    field<&DoublePilotCheckValveDef::port_b2>("port_b2", port("volume of line B at the load")),
    field<&DoublePilotCheckValveDef::pilot_ratio>("pilot_ratio", kPilotRatio),
});

// What differs between the types: poppets, throttle and the ends of the names of variables.
std::array<PoppetPorts, 1> poppets_of(const CheckValveDef& def, const CircuitBuilder& builder) {
  return {{{.inlet = builder.volume(def.port_1), .outlet = builder.volume(def.port_2)}}};
}
std::array<PoppetPorts, 1> poppets_of(const ThrottleCheckValveDef& def, const CircuitBuilder& builder) {
  return {{{.inlet = builder.volume(def.port_1), .outlet = builder.volume(def.port_2)}}};
}
std::array<PoppetPorts, 1> poppets_of(const PilotCheckValveDef& def, const CircuitBuilder& builder) {
  return {{{.inlet = builder.volume(def.port_1),
            .outlet = builder.volume(def.port_2),
            .pilot = builder.volume(def.port_3),
            .back = builder.volume(def.port_4.empty() ? def.port_1 : def.port_4)}}};
}
std::array<PoppetPorts, 2> poppets_of(const DoublePilotCheckValveDef& def, const CircuitBuilder& builder) {
  const StateIndex a = builder.volume(def.port_a1), b = builder.volume(def.port_b1);
  return {{{.inlet = a, .outlet = builder.volume(def.port_a2), .pilot = b, .back = a},
           {.inlet = b, .outlet = builder.volume(def.port_b2), .pilot = a, .back = b}}};
}

template <typename Def>
double pilot_ratio_of(const Def& def) noexcept {
  if constexpr (requires { def.pilot_ratio; }) return def.pilot_ratio;
  return 0;
}

template <typename Def>
double throttle_of(const Def& def) noexcept {
  if constexpr (requires { def.throttle_flow; }) {
    return def.throttle_opening * def.throttle_flow / def.common.nominal_flow;
  }
  return 0;
}

template <typename Def>
class CheckValve final : public HydraulicComponent {
 public:
  CheckValve(const Def& def, CircuitBuilder& builder) : HydraulicComponent(def), def_(def) {
    for (const PoppetPorts& ports : poppets_of(def, builder)) {
      poppets_.emplace_back(ports, pilot_ratio_of(def), builder.def().orifice_transition);
    }
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (const CheckPoppet& poppet : poppets_) poppet.declare_dependencies(dependencies);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    for (const CheckPoppet& poppet : poppets_) poppet.move(poppet.flow(view), rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    for (const CheckPoppet& poppet : poppets_) poppet.stamp(poppet.flow(view), jacobian);
  }
  void add_rates_and_jacobian(const CircuitView& view, Rates& rates, JacobianStamp& jacobian) const noexcept override {
    for (const CheckPoppet& poppet : poppets_) {
      const PoppetFlow Q = poppet.flow(view);
      poppet.move(Q, rates);
      poppet.stamp(Q, jacobian);
    }
  }
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    for (const CheckPoppet& poppet : poppets_) poppet.move(poppet.flow(view), passages);
  }
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    for (const CheckPoppet& poppet : poppets_) poppet.raise_slopes(view, slopes);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    for (std::size_t i = 0; i < poppets_.size(); ++i) {
      const std::string_view line = poppets_.size() == 1 ? "" : i == 0 ? "_a" : "_b";
      variables.push_back(variable(fmt::format("opening{}", line), Dimension::none));
      variables.push_back(variable(fmt::format("flow{}", line), Dimension::volume_flow));
    }
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    for (const CheckPoppet& poppet : poppets_) {
      *values++ = poppet.opening(view);
      *values++ = poppet.flow(view).value;
    }
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    for (CheckPoppet& poppet : poppets_) poppet.set(def_.common, throttle_of(def_));
  }

 private:
  Def def_;
  std::vector<CheckPoppet> poppets_;
};

template <typename Def>
void validate_check_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const Def& def = static_cast<const Def&>(component);
  check_nominal_drop(def.name + ".nominal_pressure_drop", def.common, errors);
  if constexpr (requires { def.port_1; }) {
    check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  } else {
    check_distinct(def.name + ".port_a2", def.port_a1, def.port_a2, errors);
    check_distinct(def.name + ".port_b2", def.port_b1, def.port_b2, errors);
    check_distinct(def.name + ".port_b1", def.port_a1, def.port_b1, errors);
  }
}

// what passes at the end of the oil's law
double most_flow(double nominal_flow, double nominal_pressure_drop) {
  return nominal_flow * std::sqrt(OilCompressibility::kHighest / nominal_pressure_drop);
}

void add_free_direction(const std::string& from, const std::string& to, const CheckParameters& common,
                        PumpLines& lines) {
  lines.open.push_back(
      {.a = from, .b = to, .flow = most_flow(common.nominal_flow, common.nominal_pressure_drop), .is_one_way = true});
}

template <typename Def>
ComponentType type_of(std::string_view name, std::span<const Field> fields, std::string_view doc) {
  return {.name = name,
          .fields = fields,
          .doc = doc,
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<Def>(); },
          .validate = validate_check_valve<Def>,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<CheckValve<Def>>(static_cast<const Def&>(def), builder);
          }};
}

}  // namespace

void check_nominal_drop(const std::string& path, const CheckParameters& common, Problems& errors) {
  const double open = common.crack_pressure + common.opening_pressure_rise;
  if (common.nominal_pressure_drop >= open) return;
  errors.push_back({path,
                    fmt::format("at this drop the valve is not fully open: it is from {:.6g} bar on", open * 1e-5),
                    "at least crack_pressure + opening_pressure_rise", ""});
}

void CheckValveDef::add_lines(PumpLines& lines) const {
  add_free_direction(port_1, port_2, common, lines);
}

void ThrottleCheckValveDef::add_lines(PumpLines& lines) const {
  add_free_direction(port_1, port_2, common, lines);
  if (!(throttle_opening > 0)) return;
  lines.open.push_back(
      {.a = port_1, .b = port_2, .flow = throttle_opening * most_flow(throttle_flow, common.nominal_pressure_drop)});
}

void PilotCheckValveDef::add_lines(PumpLines& lines) const {
  add_free_direction(port_1, port_2, common, lines);
}

void DoublePilotCheckValveDef::add_lines(PumpLines& lines) const {
  add_free_direction(port_a1, port_a2, common, lines);
  add_free_direction(port_b1, port_b2, common, lines);
}

ComponentType check_valve_type() {
  return type_of<CheckValveDef>("check_valve", kCheckValveFields, "spring-loaded check valve");
}

ComponentType throttle_check_valve_type() {
  return type_of<ThrottleCheckValveDef>("throttle_check_valve", kThrottleCheckValveFields,
                                        "check valve with a throttle beside it");
}

ComponentType pilot_check_valve_type() {
  return type_of<PilotCheckValveDef>("pilot_check_valve", kPilotCheckValveFields, "pilot-operated check valve");
}

ComponentType double_pilot_check_valve_type() {
  return type_of<DoublePilotCheckValveDef>("double_pilot_check_valve", kDoublePilotCheckValveFields,
                                           "two check valves, each piloted by the other line");
}

}  // namespace slew::hydraulics
