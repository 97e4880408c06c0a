// SPDX-License-Identifier: Apache-2.0
// Ends a session whose circuit is no longer solved, or no longer that of the scene, while its pressures are still
// finite.
//
// Four rules, checked after every step:
//   - The excess of steps accepted with their error over sound ones reaches kMostUnsolved: steps that are not
//     converged, and steps over the sub-step budget whose error exceeded the tolerance. The count decreases by one with
//     each sound step, down to zero, so that single steps of small errors never add up to an end. A step counts the
//     more the larger its errors are (math::StiffReport::accepted_error), and ends the run alone where they add up to
//     kMostError: a volume that is closed afterwards keeps them.
//   - No sub-step keeps the oil of a volume, or has less than a gross error (math::StiffReport::is_impossible).
//   - No chamber of level tlm hardens within a step by more than its waves can follow (Circuit::beyond_waves()).
//   - No piston is out of its barrel (Circuit::first_out_of_barrel()), also in a step that another integrator computes.
// Not covered: pressures that are converged and wrong.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "core/state_hash.h"
#include "core/step_report.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics/hydraulics_def.h"
#include "math/stiff_system.h"

namespace slew::hydraulics_node {

// As of the mechanics (mechanics_node/divergence.h): more than a jump of a command takes in a sound run.
inline constexpr int kMostUnsolved = 20;  // steps
// Of a state's size, which is 10 bar + p of a pressure: the error with which no single sub-step is accepted.
inline constexpr double kMostError = math::kGrossShare;

class ConvergenceWatch {
 public:
  explicit ConvergenceWatch(hydraulics::Solver solver) noexcept : solver_(solver) {}

  void reset() noexcept { unsolved_ = 0, text_length_ = 0; }
  // Counts a step. True: the run ends; text() names the offender and the reason. beyond_waves: name of the volume of
  // the third rule. Does not allocate.
  [[nodiscard]] bool ends_run(const StepReport& report, const hydraulics::CircuitIntegrator& integrator,
                              std::string_view offender, std::string_view beyond_waves) noexcept;
  // The part of the first rule that holds whatever computes a step: a volume has more room without oil than it has
  // room.
  [[nodiscard]] bool ends_followed_run(bool is_overdrawn, std::string_view volume) noexcept;
  // The last rule, for the state of the circuit; name: that of each actuator's cylinder.
  template <typename NameOf>
  [[nodiscard]] bool ends_out_of_barrel(const hydraulics::Circuit& circuit, const double* y, NameOf&& name) noexcept {
    const int j = circuit.first_out_of_barrel(y);
    if (j < 0) return false;
    write_out_of_barrel(name(j), circuit.actuators()[static_cast<std::size_t>(j)].barrel, y[circuit.position(j)]);
    return true;
  }
  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), text_length_}; }

  // Adds nothing while all recent steps are sound: the hash of a sound run is that of its circuit.
  void add_to(StateHash& hash) const noexcept {
    if (unsolved_ != 0) hash.add(unsolved_);
  }
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes) {
    bytes.count(self.unsolved_, kMostUnsolved);
    bytes.count(self.text_length_, self.text_.size());
    bytes.numbers(std::span(self.text_).first(self.text_length_));
  }

 private:
  [[nodiscard]] bool count(int weight) noexcept;
  void write_out_of_barrel(std::string_view cylinder, const hydraulics::Barrel& barrel, double stroke) noexcept;
  template <typename... Values>
  void write(const char* form, const Values&... values) noexcept;

  hydraulics::Solver solver_;
  int unsolved_ = 0;  // excess, at most kMostUnsolved
  std::array<char, 512> text_{};
  std::size_t text_length_ = 0;
};

}  // namespace slew::hydraulics_node
