// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/dimension.h"
#include "hydraulics/circuit_builder.h"
#include "hydraulics/hydraulics_def.h"
#include "hydraulics/line_limits.h"
#include "hydraulics/oil_limits.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/start_volumes.h"
#include "math/pattern_lu.h"

namespace slew::hydraulics {
namespace {

constexpr double kLeastViscosity = 1e-6;  // m2/s: (1) of oil_properties.h needs lg(nu/nu_0 + 0.7) above zero
constexpr double kLeastShare = 0.1;       // of a property at the reference temperature

// Field::member takes the Def's address without const; it is only read here.
template <typename T>
const T& member(const Field& row, const void* def) {
  return *static_cast<const T*>(row.member(const_cast<void*>(def)));
}

std::string interval(const Range& range) {
  return fmt::format("{}{:g}, {:g}{}", range.min_is_open ? '(' : '[', range.min, range.max,
                     range.max_is_open ? ')' : ']');
}

// Checks one element against its field table: numbers in range, required texts present.
void check_fields(const std::string& element, std::span<const Field> fields, const void* def, Problems& errors) {
  for (const Field& row : fields) {
    const std::string path = element + "." + std::string(row.key);
    if (row.type == FieldType::number || row.type == FieldType::integer) {
      const double value = row.type == FieldType::number ? member<double>(row, def)
                                                         : static_cast<double>(member<std::int64_t>(row, def));
      if (row.range.contains(value)) continue;
      errors.push_back({path, fmt::format("{:g} is out of range", value),
                        fmt::format("a value in {} {}", interval(row.range), info(row.dimension).si_unit), ""});
    } else if (row.type == FieldType::text && row.presence == Presence::required &&
               member<std::string>(row, def).empty()) {
      errors.push_back({path, "the name is missing", fmt::format("the name of a {}", row.reference), ""});
    }
  }
}

const ComponentDef* find_component(const HydraulicsDef& def, std::string_view name) {
  for (const auto& component : def.components) {
    if (component->name == name) return component.get();
  }
  return nullptr;
}

bool has_volume(const HydraulicsDef& def, std::string_view name) {
  return std::any_of(def.volumes.begin(), def.volumes.end(), [&](const VolumeDef& v) { return v.name == name; });
}

// Checks that referenced names exist, by the kind of element in the field table.
void check_references(const HydraulicsDef& def, const ComponentDef& component, const ComponentType& type,
                      const void* address, Problems& errors) {
  for (const Field& row : type.fields) {
    if (row.type != FieldType::text || row.reference.empty()) continue;
    const std::string& name = member<std::string>(row, address);
    if (name.empty()) continue;
    const bool is_missing =
        (row.reference == "volume" && !has_volume(def, name)) ||
        (row.reference == "component" && find_component(def, name) == nullptr) ||
        (row.reference == "curve" &&
         std::none_of(def.curves.begin(), def.curves.end(), [&](const CurveDef& c) { return c.name == name; }));
    if (is_missing) {
      errors.push_back({component.name + "." + std::string(row.key),
                        fmt::format("there is no {} '{}'", row.reference, name),
                        fmt::format("the name of a {}", row.reference), ""});
    }
  }
}

// Two ports between which a component passes oil are connected to two volumes: the only two that it has, or a pair.
void check_port_pair(const ComponentDef& component, const ComponentType& type, const void* address, Problems& errors) {
  std::vector<std::pair<std::string_view, std::string_view>> ports;  // key, volume
  for (const Field& row : type.fields) {
    if (row.reference == "volume" && row.key.starts_with("port_"))
      ports.emplace_back(row.key, member<std::string>(row, address));
  }
  const auto volume_of = [&](std::string_view key) {
    const auto found = std::find_if(ports.begin(), ports.end(), [key](const auto& port) { return port.first == key; });
    return found == ports.end() ? std::string_view() : found->second;
  };
  std::vector<std::pair<std::string_view, std::string_view>> pairs = {{"port_1", "port_2"}, {"port_a", "port_b"}};
  if (ports.size() == 2) pairs = {{ports[0].first, ports[1].first}};
  for (const auto& [first, second] : pairs) {
    const std::string_view volume = volume_of(first);
    const std::string path = component.name + "." + std::string(second);
    const bool is_reported =
        std::any_of(errors.begin(), errors.end(), [&](const Problem& problem) { return problem.path == path; });
    if (volume.empty() || volume != volume_of(second) || is_reported) continue;
    errors.push_back({path, fmt::format("both ports are connected to '{}'", volume), "two volumes", ""});
  }
}

void check_names(const HydraulicsDef& def, Problems& errors) {
  std::set<std::string_view> seen;
  const auto check = [&](const std::string& name, const char* section) {
    if (name.empty()) {
      errors.push_back({section, "an element has no name", "a name", ""});
    } else if (!seen.insert(name).second) {
      errors.push_back({name, "the name is used twice", "a name of its own for every element", ""});
    }
  };
  for (const VolumeDef& volume : def.volumes) check(volume.name, "volumes");
  for (const CurveDef& curve : def.curves) check(curve.name, "curves");
  for (const auto& component : def.components) check(component->name, "components");
}

void check_curve(const CurveDef& curve, Problems& errors) {
  const std::string path = curve.name + ".points";
  if (curve.points.size() < 2) {
    errors.push_back({path, "a curve needs at least two points", "two or more [argument, value]", ""});
    return;
  }
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const auto& point = curve.points[i];
    if (!std::isfinite(point[0]) || !std::isfinite(point[1])) {
      errors.push_back({path, fmt::format("point {} is not finite", i + 1), "numbers", ""});
    } else if (i > 0 && !(point[0] > curve.points[i - 1][0])) {
      errors.push_back({path, fmt::format("argument {:g} of point {} does not increase", point[0], i + 1),
                        "strictly increasing arguments", ""});
    }
  }
  if (!curve.odd) return;
  if (curve.points.front()[0] < 0) {
    errors.push_back({path, "an odd curve has points at negative arguments", "arguments >= 0", ""});
  } else if (curve.points.front()[0] != 0 || curve.points.front()[1] != 0) {
    errors.push_back(
        {path, "an odd curve does not begin at zero and would jump there", "[0, 0] as the first point", ""});
  }
}

// The component is an actuator with a chamber in the volume.
bool is_at_port(const ComponentDef& component, const VolumeDef& volume) {
  const std::optional<ActuatorDef> actuator = component.actuator();
  return actuator && (actuator->port_a == volume.name || actuator->port_b == volume.name);
}

// Volumes filled by a hose, line or chamber.
bool has_content(const HydraulicsDef& def, const VolumeDef& volume) {
  if (volume.fixed || volume.rigid_volume > 0) return true;
  for (const auto& component : def.components) {
    const ComponentType* type = find_component_type(component->type_name());
    if (type == nullptr) continue;
    if (is_at_port(*component, volume)) return true;
    if (type->name != "hose" && type->name != "line") continue;
    for (const Field& row : type->fields) {
      if (row.reference == "volume" && member<std::string>(row, component->address()) == volume.name) return true;
    }
  }
  return false;
}

// Algebraic pressures need a solver that supports them. No piston may act on one: its stiffness would be infinite.
bool takes_quasi_static(Solver solver) {
  return solver == Solver::rodas3 || solver == Solver::implicit_euler;
}

std::string no_quasi_static(Solver solver) {
  return fmt::format("the solver {} has no algebraic pressures", kSolverChoices[static_cast<std::size_t>(solver)]);
}

void check_quasi_static(const HydraulicsDef& def, const VolumeDef& volume, Problems& errors) {
  if (!volume.quasi_static) return;
  const std::string path = volume.name + ".quasi_static";
  if (volume.fixed) {
    errors.push_back({path, "the volume is fixed already", "fixed: true or quasi_static: true", ""});
  }
  if (!takes_quasi_static(def.solver)) {
    errors.push_back({path, no_quasi_static(def.solver), "solver: rodas3 or implicit_euler", ""});
  }
  if (const ComponentDef* cylinder = find_chamber(def, volume)) {
    errors.push_back(
        {path,
         fmt::format("a chamber of '{}' is part of the volume: without storage it would be rigid", cylinder->name),
         "a volume without a cylinder", ""});
  }
}

void check_volumes(const HydraulicsDef& def, Problems& errors) {
  for (const VolumeDef& volume : def.volumes) {
    check_fields(volume.name, kVolumeFields, &volume, errors);
    check_quasi_static(def, volume, errors);
    if (!volume.quasi_static && !has_content(def, volume)) {
      errors.push_back({volume.name + ".rigid_volume",
                        "the volume has no content: no hose, line or chamber is connected",
                        "a hose, a cylinder, a rigid_volume, quasi_static: true, or fixed: true", ""});
    }
  }
}

// The pressure of a quasi-static volume follows from volumes with storage, or a tank, that oil can reach from it. A
// volume behind one component alone has none while that is shut.
void check_outlets(const HydraulicsDef& def, Problems& errors, Problems& warnings) {
  std::set<std::string_view> reached;
  for (const VolumeDef& volume : def.volumes) {
    // those that cannot be quasi-static are refused above
    const bool is_refused = volume.fixed || find_chamber(def, volume) != nullptr;
    if (!volume.quasi_static || is_refused) reached.insert(volume.name);
  }
  for (std::size_t before = 0; before != reached.size();) {
    before = reached.size();
    for (const auto& component : def.components) {
      const std::vector<std::string_view> names = volumes_of(*component);
      const bool is_reached =
          std::any_of(names.begin(), names.end(), [&](std::string_view name) { return reached.contains(name); });
      if (is_reached) reached.insert(names.begin(), names.end());
    }
  }
  for (const VolumeDef& volume : def.volumes) {
    if (!volume.quasi_static) continue;
    const std::string path = volume.name + ".quasi_static";
    std::vector<std::string_view> joined;
    for (const auto& component : def.components) {
      const std::vector<std::string_view> names = volumes_of(*component);
      if (std::find(names.begin(), names.end(), volume.name) != names.end()) joined.emplace_back(component->name);
    }
    if (!reached.contains(volume.name)) {
      errors.push_back({path,
                        "no volume that stores oil and no tank is connected to the volume: nothing determines its "
                        "pressure",
                        "a rigid_volume in the place of quasi_static: true, or an outlet", ""});
    } else if (joined.size() == 1) {
      warnings.push_back({path,
                          fmt::format("'{}' alone leads to the volume: while it lets nothing through, nothing "
                                      "determines the pressure, and the run ends with code 5",
                                      joined.front()),
                          "a rigid_volume in the place of quasi_static: true", ""});
    }
  }
}

// Components that supply load-sensing pressures to this one, with the key that names each.
std::vector<std::pair<std::string_view, std::string_view>> ls_references(ComponentDef& component) {
  std::vector<std::pair<std::string_view, std::string_view>> names;
  for (const Field& row : find_component_type(component.type_name())->fields) {
    // a pump's engine is no source of a load-sensing pressure
    if (row.reference != "component" || row.key == "engine") continue;
    const std::string& name = member<std::string>(row, component.address());
    if (!name.empty()) names.emplace_back(row.key, name);
  }
  return names;
}

bool reaches(const HydraulicsDef& def, const ComponentDef& from, std::string_view target, std::size_t depth) {
  if (depth == 0) return true;
  for (const auto& [key, name] : ls_references(const_cast<ComponentDef&>(from))) {
    // a compensator follows the shared pressure with a lag; what it adds to the chain does not depend on it
    if (key == "shared_ls") continue;
    const ComponentDef* next = find_component(def, name);
    if (name == target || (next != nullptr && reaches(def, *next, target, depth - 1))) return true;
  }
  return false;
}

// Every LS reference ends at a load-sensing port, without a loop; every LS port is used.
void check_ls_chain(const HydraulicsDef& def, Problems& errors, Problems& warnings) {
  std::set<std::string_view> used;
  for (const auto& component : def.components) {
    for (const auto& [key, name] : ls_references(*component)) {
      used.insert(name);
      const std::string path = component->name + "." + std::string(key);
      const ComponentDef* source = find_component(def, name);
      if (source != nullptr && !find_component_type(source->type_name())->has_ls_port) {
        errors.push_back(
            {path, fmt::format("'{}' has no load-sensing port", name), "a load-sensing valve or an ls_shuttle", ""});
      }
    }
    if (reaches(def, *component, component->name, def.components.size())) {
      errors.push_back(
          {component->name, "the load-sensing chain returns to itself", "a chain that ends at valves", ""});
    }
  }
  for (const auto& component : def.components) {
    if (!find_component_type(component->type_name())->has_ls_port || used.contains(component->name)) continue;
    warnings.push_back({component->name, "no pump or shuttle takes its load-sensing pressure",
                        "an ls_shuttle or the pump's ls_port naming it", ""});
  }
}

void check_forces(const HydraulicsDef& def, Problems& errors) {
  std::set<std::string> driven;
  for (const auto& component : def.components) {
    for (const Field& row : find_component_type(component->type_name())->fields) {
      if (row.reference != "force") continue;
      const std::string& name = member<std::string>(row, component->address());
      if (name.empty() || driven.insert(name).second) continue;
      errors.push_back({component->name + ".force", fmt::format("'{}' is driven by another cylinder already", name),
                        "a force element of its own", ""});
    }
  }
}

// The laws of oil_properties.h over their whole range of temperatures.
void check_oil_properties(const HydraulicsDef& def, Problems& errors) {
  if (def.oil_temperature == OilTemperature::one) return;
  if (!(def.hot_viscosity < def.oil_viscosity) || def.hot_viscosity < kLeastViscosity) {
    errors.push_back({"hydraulics.hot_viscosity",
                      def.hot_viscosity == 0
                          ? std::string("the viscosity at hot_temperature is not stated")
                          : fmt::format("{:g} m2/s is not between 1 mm2/s and oil_viscosity", def.hot_viscosity),
                      "the viscosity at hot_temperature from the oil's data sheet", ""});
  }
  if (!(def.hot_temperature > def.reference_temperature)) {
    errors.push_back({"hydraulics.hot_temperature",
                      fmt::format("{:g} K is not above reference_temperature", def.hot_temperature),
                      "two temperatures at which the oil is known, the hotter one here", ""});
    return;
  }
  const auto check_end = [&](const char* key, double cold, double hot) {
    if (hot == 0) return;
    const double per_kelvin = (hot - cold) / (def.hot_temperature - def.reference_temperature);
    const auto at = [&](double T) { return cold + per_kelvin * (T - def.reference_temperature); };
    if (std::min(at(kOilTemperatureRange.min), at(kOilTemperatureRange.max)) >= kLeastShare * cold) return;
    errors.push_back({std::string("hydraulics.") + key,
                      "the line through both values falls below a tenth of the value at reference_temperature "
                      "between -40 and 150 degC",
                      "values that belong to the two temperatures", ""});
  };
  check_end("hot_density", def.oil_density, def.hot_density);
  check_end("hot_bulk_modulus", def.oil_bulk_modulus, def.hot_bulk_modulus);
}

// A tank without a stated content would never become warm.
void warn_of_held_temperatures(const HydraulicsDef& def, Problems& warnings) {
  if (def.oil_temperature == OilTemperature::one) return;
  for (const VolumeDef& volume : def.volumes) {
    if (!volume.fixed || volume.rigid_volume > 0) continue;
    warnings.push_back({volume.name + ".rigid_volume",
                        "the content of this fixed volume is not stated, so its oil keeps start_temperature",
                        "the oil in the tank", ""});
  }
}

void check_circuit_numbers(const HydraulicsDef& def, Problems& errors) {
  check_fields("hydraulics", kHydraulicsFields, &def, errors);
  check_oil_properties(def, errors);
  if (def.quasi_static_above > 0 && !takes_quasi_static(def.solver)) {
    errors.push_back({"hydraulics.quasi_static_above", no_quasi_static(def.solver),
                      "solver: rodas3 or implicit_euler, or quasi_static_above: 0", ""});
  }
  const auto above_floor = [&](const char* key, double pressure) {
    if (pressure > def.pressure_floor) return;
    errors.push_back({std::string("hydraulics.") + key, "the start pressure is below pressure_floor",
                      "an absolute pressure above pressure_floor", ""});
  };
  above_floor("start_return_pressure", def.start_return_pressure);
  above_floor("start_slew_pressure", def.start_slew_pressure);
  above_floor("start_pump_pressure", def.start_pump_pressure);
  for (const VolumeDef& volume : def.volumes) {
    if (volume.initial_pressure <= def.pressure_floor && volume.initial_pressure > 0) {
      errors.push_back({volume.name + ".initial_pressure", "the start pressure is below hydraulics.pressure_floor",
                        "an absolute pressure above pressure_floor", ""});
    }
  }
}

}  // namespace

const ComponentDef* find_chamber(const HydraulicsDef& def, const VolumeDef& volume) {
  for (const auto& component : def.components) {
    if (is_at_port(*component, volume)) return component.get();
  }
  return nullptr;
}

namespace {

// Limit of the unknowns for the solver's elimination; other solvers use dense matrices, with steps of seconds.
std::size_t most_unknowns(Solver solver) {
  constexpr std::size_t kMostDense = 1000;
  return solver == Solver::rodas3 || solver == Solver::implicit_euler ? math::PatternLu::kMostUnknowns : kMostDense;
}

void check_size(const HydraulicsDef& def, std::size_t unknowns, Problems& errors) {
  const std::size_t most = most_unknowns(def.solver);
  if (unknowns <= most) return;
  errors.push_back({"volumes",
                    fmt::format("the circuit has {} unknowns (a pressure for each volume, stroke and speed for each "
                                "cylinder, the states of components)",
                                unknowns),
                    fmt::format("at most {} with this hydraulics.solver", most), ""});
}

// Pre-condition: no errors.
std::size_t count_unknowns(const HydraulicsDef& def) {
  CircuitBuilder builder(def);
  for (const auto& component : def.components) {
    (void)find_component_type(component->type_name())->build(*component, builder);
  }
  return static_cast<std::size_t>(builder.state_count());
}

}  // namespace

void validate(const HydraulicsDef& def, Problems& errors, Problems& warnings) {
  check_size(def, def.volumes.size(), errors);
  if (!errors.empty()) return;
  check_names(def, errors);
  check_circuit_numbers(def, errors);
  for (const CurveDef& curve : def.curves) check_curve(curve, errors);
  bool are_types_known = true;
  for (const auto& component : def.components) {
    const ComponentType* type = find_component_type(component->type_name());
    if (type == nullptr) {
      are_types_known = false;
      errors.push_back({component->name + ".type",
                        fmt::format("there is no component type '{}'", component->type_name()),
                        "one of the types of hydraulic components", ""});
      continue;
    }
    check_fields(component->name, type->fields, component->address(), errors);
    check_references(def, *component, *type, component->address(), errors);
    if (type->validate != nullptr) type->validate(def, *component, errors, warnings);
    check_port_pair(*component, *type, component->address(), errors);
  }
  check_volumes(def, errors);
  check_outlets(def, errors, warnings);
  warn_of_held_temperatures(def, warnings);
  find_implausible_oil(def, warnings);
  if (!are_types_known) return;
  check_ls_chain(def, errors, warnings);
  check_forces(def, errors);
  if (errors.empty()) {
    find_unrelieved_pumps(def, warnings);
    find_unfilled_accumulators(def, warnings);
    find_idle_volumes(def, warnings);
    find_replaced_pressures(def, warnings);
  }
  if (errors.empty()) check_size(def, count_unknowns(def), errors);
}

}  // namespace slew::hydraulics
