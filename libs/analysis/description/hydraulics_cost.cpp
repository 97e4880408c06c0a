// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/hydraulics_cost.h"

#include "analysis/description/timed_call.h"
#include "hydraulics/circuit.h"

namespace slew::analysis {
namespace {

// a component takes a few nanoseconds, less than the clock's own reading: so many calls are timed as one
constexpr int kCallsAtOnce = 64;

template <typename Call>
double of_one(const Call& call) {
  return fastest_of([&] {
           for (int i = 0; i < kCallsAtOnce; ++i) call();
         }) /
         kCallsAtOnce;
}

}  // namespace

CircuitCalls time_circuit(const scene::Scene& scene, std::span<const CircuitSample> samples) {
  hydraulics::Circuit circuit(scene.hydraulics);
  std::vector<double> f(static_cast<std::size_t>(circuit.state_count()));
  CircuitCalls calls;
  for (const auto& component : scene.hydraulics.components) {
    calls.components.push_back({.name = component->name, .type = std::string(component->type_name())});
  }
  const double part = samples.empty() ? 0 : 1.0 / static_cast<double>(samples.size());
  for (const CircuitSample& one : samples) {
    for (std::size_t i = 0; i < std::min(one.controls.size(), scene.inputs.size()); ++i) {
      const int control = circuit.find_control(scene.inputs[i].primitive);
      if (control >= 0) circuit.set_control(control, one.controls[i]);
    }
    const double* y = one.y.data();
    calls.rates += part * of_one([&] { circuit.rates(y, f.data()); });
    calls.slopes += part * of_one([&] { static_cast<void>(circuit.jacobian(y, f.data())); });
    for (std::size_t i = 0; i < calls.components.size(); ++i) {
      calls.components[i].rates += part * of_one([&] { circuit.add_rates_of(i, y, f.data()); });
      calls.components[i].slopes += part * of_one([&] { circuit.add_slopes_of(i, y); });
    }
  }
  return calls;
}

}  // namespace slew::analysis
