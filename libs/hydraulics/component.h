// SPDX-License-Identifier: Apache-2.0
// The interface of hydraulic components: their view of the circuit and their terms in its equations.
//
// The circuit's state vector is y = [p of all volumes | x | v of all actuators | component states]. A component keeps
// the positions (StateIndex) of its connected volumes and states, adds flows into volumes [m3/s] and rates of its own
// states, and stamps their partial derivatives into the Jacobian. The circuit turns flows into pressure rates,
//   p' = sum Q / C,   C = sum over contents V_k (kappa_oil + 1/B_k),
// including the dependence of C on p and x: components never see capacities.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "core/step_report.h"
#include "hydraulics/component_def.h"
#include "math/pattern_lu.h"

namespace slew::hydraulics {

class Passages;
class PortOil;

using StateIndex = int;  // position in y; a volume's StateIndex is its number
using LsIndex = int;     // number of a load-sensing pressure

// The instant at which equations are evaluated.
struct CircuitView {
  const double* y;           // state vector
  const double* control;     // control signals
  const double* ls;          // load-sensing pressures above tank [Pa]
  const double* line_force;  // line forces of the actuators from the partner [N]; for display
  [[nodiscard]] double operator[](StateIndex i) const noexcept { return y[i]; }
};

// Sums of flows into volumes and rates of component states, by StateIndex.
class Rates {
 public:
  explicit Rates(double* f) noexcept : f_(f) {}
  void add_flow(StateIndex volume, double Q) noexcept { f_[volume] += Q; }
  // Q m3/s leaves one volume and enters the other.
  void move(StateIndex from, StateIndex to, double Q) noexcept {
    f_[from] -= Q;
    f_[to] += Q;
  }
  void set_rate(StateIndex state, double rate) noexcept { f_[state] = rate; }

 private:
  double* f_;
};

// Partial derivatives of the same sums. Rows beyond the state are those of the load-sensing pressures.
class JacobianStamp {
 public:
  JacobianStamp(double* a, int size) noexcept : a_(a), size_(size) {}
  void add(StateIndex row, StateIndex column, double d) noexcept { a_[row * size_ + column] += d; }
  // Derivative of a flow that leaves one volume and enters the other.
  void move(StateIndex from, StateIndex to, StateIndex column, double d) noexcept {
    add(from, column, -d);
    add(to, column, d);
  }
  // The same of a passage, d over the pressure of `from` and -d over that of `to`.
  void pass(StateIndex from, StateIndex to, double d) noexcept {
    move(from, to, from, d);
    move(from, to, to, -d);
  }
  // Dependence of a row on a load-sensing pressure, by the chain rule.
  void add_ls(StateIndex row, LsIndex ls, double d) noexcept {
    for (int j = 0; j < size_; ++j) a_[row * size_ + j] += d * a_[(size_ + ls) * size_ + j];
  }
  // Row number of a load-sensing pressure, for add() and add_ls().
  [[nodiscard]] StateIndex ls_row(LsIndex ls) const noexcept { return size_ + ls; }

 private:
  double* a_;
  int size_;
};

// Non-zero pattern of a component's Jacobian; the integrator plans its elimination from it.
class DependencyList {
 public:
  DependencyList(math::SparsityPattern& pattern, int size) : pattern_(pattern), size_(size) {}
  void add(StateIndex row, StateIndex column) {
    pattern_.add(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
  }
  // Both flows depend on both pressures.
  void add_restriction(StateIndex a, StateIndex b) { add(a, a), add(a, b), add(b, a), add(b, b); }
  void add_ls(StateIndex row, LsIndex ls) {
    for (int j = 0; j < size_; ++j) {
      if (pattern_.has(static_cast<std::size_t>(size_ + ls), static_cast<std::size_t>(j))) add(row, j);
    }
  }
  [[nodiscard]] StateIndex ls_row(LsIndex ls) const { return size_ + ls; }

 private:
  math::SparsityPattern& pattern_;
  int size_;
};

// Base of all components. Functions that a step reaches neither allocate nor throw.
class HydraulicComponent {
 public:
  explicit HydraulicComponent(const ComponentDef& def)
      : name_(def.name), type_(*find_component_type(def.type_name())) {}
  HydraulicComponent(const HydraulicComponent&) = delete;
  HydraulicComponent& operator=(const HydraulicComponent&) = delete;
  virtual ~HydraulicComponent() = default;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const ComponentType& type() const noexcept { return type_; }

  // False for a component that only adds content to a volume.
  [[nodiscard]] virtual bool has_equations() const noexcept { return true; }
  virtual void declare_dependencies(DependencyList& dependencies) const = 0;
  virtual void add_rates(const CircuitView& view, Rates& rates) const noexcept = 0;
  virtual void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept = 0;
  // Both at once, for laws whose flow and slopes share work; the same bits as one after the other.
  virtual void add_rates_and_jacobian(const CircuitView& view, Rates& rates, JacobianStamp& jacobian) const noexcept {
    add_rates(view, rates);
    add_jacobian(view, jacobian);
  }

  // Sets the component's states in y to those at rest under the start pressures of the volumes in y.
  virtual void start(double* /*y*/) const noexcept {}

  // Of a component with a brake on its actuator: the share of Brake::force that it holds, and the growth of its state
  // per displacement against it [1/m or 1/rad], less while it opens.
  [[nodiscard]] virtual double brake_share(const CircuitView&) const noexcept { return 0; }
  [[nodiscard]] virtual double brake_grip(const CircuitView&) const noexcept { return 0; }

  // Load-sensing pressure above tank and its derivatives, for components that have one; called in an order in which
  // every source comes before its consumers.
  [[nodiscard]] virtual std::vector<LsIndex> ls_inputs() const { return {}; }  // pressures that ls_pressure() reads
  [[nodiscard]] virtual double ls_pressure(const CircuitView&) const noexcept { return 0; }
  virtual void declare_ls_dependencies(DependencyList&) const {}
  virtual void add_ls_jacobian(const CircuitView&, JacobianStamp&) const noexcept {}

  // Flows of oil and heat between volumes, for their temperatures (passages.h): by default the oil that add_rates()
  // takes from volumes is mixed, and the mixture delivered. Power that a shaft adds to the oil [W].
  virtual void add_passages(const CircuitView& view, Passages& passages) const noexcept;
  [[nodiscard]] virtual double shaft_power(const CircuitView&) const noexcept { return 0; }
  // Takes the viscosity and density of the oil; at the start and at the end of every communication step, in circuits
  // with temperatures only.
  virtual void follow_oil(const PortOil& /*oil*/) noexcept {}

  // Raises the slopes of add_jacobian() to those of the steeper side near the switch of a unilateral element.
  virtual void raise_slopes(const CircuitView&, JacobianStamp&) const noexcept {}
  // A state of a component whose own oil is below the pressure floor, apart from the volumes at its ports; -1: none.
  [[nodiscard]] virtual StateIndex first_cavitating(const CircuitView&) const noexcept { return -1; }
  // StepFlag bits that hold now; load-sensing pressures are those of the last evaluation.
  [[nodiscard]] virtual std::uint32_t flags(const CircuitView&) const noexcept { return 0; }

  // Variables in a fixed order, names with the element's name in front; read() writes as many values and returns the
  // end.
  virtual void list_variables(std::vector<ElementVariable>& variables) const = 0;
  virtual double* read_variables(const CircuitView& view, double* values) const noexcept = 0;

  // The component's own copy of its Def (live parameters are written there), and the update after a change.
  [[nodiscard]] virtual void* def_address() noexcept = 0;
  virtual void apply_parameters() noexcept = 0;

 protected:
  [[nodiscard]] ElementVariable variable(std::string_view quantity, Dimension dimension) const {
    return {name_ + "." + std::string(quantity), dimension};
  }

 private:
  std::string name_;
  const ComponentType& type_;
};

}  // namespace slew::hydraulics
