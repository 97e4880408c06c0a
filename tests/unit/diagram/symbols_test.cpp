// SPDX-License-Identifier: Apache-2.0
// Every type of the registry of components has a symbol that shows all its connections.
#include <gtest/gtest.h>

#include <set>

#include "diagram/symbol.h"
#include "hydraulics/component_def.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentType;

// A component of a type with all references set to names of their own, and with all numbers set, so that no connection
// is left out.
std::unique_ptr<hydraulics::ComponentDef> filled(const ComponentType& type, std::set<std::string>& connections) {
  auto def = type.make_def();
  def->name = "Component";
  for (const Field& field : type.fields) {
    if (field.type == FieldType::number) *static_cast<double*>(field.member(def->address())) = 1;
    if (field.type == FieldType::boolean) *static_cast<bool*>(field.member(def->address())) = true;
    if (field.reference != "volume" && field.reference != "component") continue;
    *static_cast<std::string*>(field.member(def->address())) = "To_" + std::string(field.key);
    connections.emplace(field.key);
  }
  return def;
}

TEST(CircuitSymbols, EveryComponentTypeHasOne) {
  for (const ComponentType& type : hydraulics::component_types()) {
    EXPECT_TRUE(has_symbol(type.name)) << type.name << " has no row among the symbols of libs/diagram";
  }
  EXPECT_FALSE(has_symbol("no_component"));
}

TEST(CircuitSymbols, EveryConnectionOfATypeIsAPort) {
  for (const ComponentType& type : hydraulics::component_types()) {
    SCOPED_TRACE(type.name);
    std::set<std::string> connections, ports;
    const auto def = filled(type, connections);
    const Symbol symbol = symbol_of(*def);
    for (const Port& port : symbol.ports) {
      if (port.key.empty()) continue;
      ports.insert(port.key);
      EXPECT_EQ(port.net, "To_" + port.key);
    }
    EXPECT_EQ(ports, connections);
  }
}

TEST(CircuitSymbols, PortsAndLanesAreWithinTheSymbolAndApart) {
  constexpr double kApart = 9;  // px, more than the least distance of two lines
  for (const ComponentType& type : hydraulics::component_types()) {
    SCOPED_TRACE(type.name);
    std::set<std::string> connections;
    const auto def = filled(type, connections);
    Symbol symbol = symbol_of(*def);
    EXPECT_FALSE(symbol.drawing.empty());
    for (const bool is_turned : {false, true}) {
      if (is_turned) turn_over(symbol);
      for (const Port& port : symbol.ports) {
        SCOPED_TRACE(port.key);
        EXPECT_GE(port.lane, 0);
        EXPECT_LE(port.lane, symbol.width);
        EXPECT_GE(port.from_y, 0);
        EXPECT_LE(port.from_y, symbol.height);
        for (const Port& other : symbol.ports) {
          if (&other == &port || other.side != port.side) continue;
          EXPECT_GE(std::abs(other.lane - port.lane), kApart) << other.key;
        }
      }
    }
  }
}

TEST(CircuitSymbols, FiguresAreThoseOfTheScene) {
  const ComponentType* type = hydraulics::find_component_type("double_acting_cylinder");
  const auto def = type->make_def();
  for (const Field& field : type->fields) {
    if (field.key == "piston_diameter") *static_cast<double*>(field.member(def->address())) = 0.08;
    if (field.key == "rod_diameter") *static_cast<double*>(field.member(def->address())) = 0.045;
    if (field.key == "minimum_stroke") *static_cast<double*>(field.member(def->address())) = 0.02;
    if (field.key == "maximum_stroke") *static_cast<double*>(field.member(def->address())) = 0.74;
  }
  EXPECT_EQ(figures_of(*def), (std::vector<std::string>{"80/45 mm", "stroke 720 mm"}));
}

TEST(CircuitSymbols, FiguresOfATelescopicCylinderAreItsStages) {
  const ComponentType* type = hydraulics::find_component_type("telescopic_cylinder");
  const auto def = type->make_def();
  for (const Field& field : type->fields) {
    if (field.key == "stages") *static_cast<Table*>(field.member(def->address())) = {{0.3, 0.11}, {0.6, 0.09}};
    if (field.key == "maximum_stroke") *static_cast<double*>(field.member(def->address())) = 0.6;
  }
  EXPECT_EQ(figures_of(*def), (std::vector<std::string>{"110/90 mm", "stroke 600 mm"}));
}

}  // namespace
}  // namespace slew::diagram
