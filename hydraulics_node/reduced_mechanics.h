// SPDX-License-Identifier: Apache-2.0
// The mechanics' reduced model as the circuit's piston motion.
//
//   v_i^h' = (a_free + W F_line)_i  of a port of level two,   v_i^h' = 0  of any other                (1)
//
// F_line_j is that of F, x^h, v^h of port j whatever its level, since a held port's force moves the others too; of
// level tlm F is the force of the lines on the piston (hydraulics/line_chambers.h), as in the mechanics.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "coupling/level.h"
#include "coupling/line_force.h"
#include "coupling/samples.h"
#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics_node {

class ReducedMechanics final : public hydraulics::PistonMotion {
 public:
  explicit ReducedMechanics(std::vector<coupling::LineForceLaw> laws) : laws_(std::move(laws)), ports_(laws_.size()) {}
  void set_sample(const coupling::MechanismSample& sample) noexcept {
    W_ = sample.W;
    a_free_ = sample.a_free;
  }
  void add_to(StateHash& hash) const noexcept {
    hash.add(std::span<const double>(W_.span()));
    hash.add(std::span<const double>(a_free_.span()));
  }
  // The sample and the ports as bytes.
  void save(StateWriter& bytes) const { visit(*this, bytes); }
  void load(StateReader& bytes) noexcept { visit(*this, bytes); }
  void set_level(std::size_t port, coupling::Level level) noexcept { ports_[port].level = level; }
  // Force of a port of level tlm, for the coming step [N].
  void set_thrust(std::size_t port, double F) noexcept { ports_[port].thrust = F; }
  [[nodiscard]] bool has_sample() const noexcept { return a_free_.size() == laws_.size(); }
  // m/s2 per N of port i by the force of port j.
  [[nodiscard]] double W(std::size_t i, std::size_t j) const noexcept { return W_[i * laws_.size() + j]; }
  // (1) of all ports, as if all were of level two.
  void free_accelerations(const double* F, const double* x, const double* v, double* a) const noexcept;
  void accelerations(const double* F, const double* x, const double* v, double* a) const noexcept override;
  void slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override;
  [[nodiscard]] double time_to_rest(const double* v, const double* a, const double* j) const noexcept override;
  [[nodiscard]] const coupling::LineForceLaw& law(std::size_t port) const noexcept { return laws_[port]; }

 private:
  struct Port {
    coupling::Level level = coupling::Level::two;
    double thrust = 0;  // N
  };
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes) {
    visit_sized(bytes, self.W_, self.ports_.size() * self.ports_.size());
    visit_sized(bytes, self.a_free_, self.ports_.size());
    for (auto& port : self.ports_) {
      bytes.choice(port.level, coupling::Level::tlm);
      bytes.number(port.thrust);
    }
  }
  [[nodiscard]] coupling::LineForce line_force(std::size_t port, double F, double x, double v) const noexcept;

  std::vector<coupling::LineForceLaw> laws_;
  std::vector<Port> ports_;
  coupling::PortMatrix W_;
  coupling::PortArray a_free_;
};

}  // namespace slew::hydraulics_node
