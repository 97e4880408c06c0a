// SPDX-License-Identifier: Apache-2.0
// The state of a circuit and of its integration as bytes.
#include <cmath>

#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics {

template <typename Self, typename Bytes>
void Circuit::visit(Self& self, Bytes& bytes) {
  for (std::size_t i = 0; i < self.parameter_value_.size(); ++i) {
    double value = self.parameter_value_[i];
    bytes.number(value);
    if constexpr (Bytes::kIsReading) {
      const bool is_set = self.set_parameter(static_cast<int>(i), value) == ParameterResult::ok;
      if (!is_set) bytes.refuse();
    }
  }
  bytes.numbers(self.control_);
  bytes.numbers(self.line_force_);
  bytes.numbers(self.ls_);
  for (auto& line : self.lines_) {
    auto& state = line.state;
    // 0: no line, 1: a line, 3: a line with room without oil or a wave that was held; 2 is of earlier programs
    const bool is_plain = state.held == 0 && state.room == 0 && !state.is_apart(self.floor_);
    auto kind = static_cast<std::uint8_t>(!line.is_line ? 0 : is_plain ? 1 : 3);
    bytes.number(kind);
    bytes.number(line.delay);
    for (auto* x : {&state.c_h, &state.c_m, &state.c_m_next, &state.Z, &state.Z_next, &state.x}) bytes.number(*x);
    if constexpr (Bytes::kIsReading) {
      if (kind == 2 || kind > 3) return bytes.refuse();
      line.is_line = kind > 0;
      state.held = state.room = 0;
      state.p = state.wave_pressure(self.floor_);
    }
    if (kind == 3) {
      bytes.number(state.held);
      bytes.number(state.room);
      bytes.number(state.p);
    }
    if constexpr (Bytes::kIsReading) {
      if (!line.is_line) continue;
      // fields of a chamber alone
      if (line.slope == 0 || self.is_fixed(line.volume)) return bytes.refuse();
      self.pieces_[line.piece].lumped = kLumpedShare;
    }
  }
}

void Circuit::save(StateWriter& bytes) const {
  visit(*this, bytes);
}

void Circuit::load(StateReader& bytes) noexcept {
  for (Piece& piece : pieces_) piece.lumped = 1;
  visit(*this, bytes);
}

// Capacities of the volumes that cavitate at y; those of the others follow from y.
void Circuit::save_vapour(StateWriter& bytes, const double* y) const {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (vapour_.is_in(i, y)) bytes.number(vapour_.capacity[i]);
  }
}

void Circuit::load_vapour(StateReader& bytes, const double* y) noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (!vapour_.is_in(i, y)) continue;
    double C = 0;
    bytes.number(C);
    if (!(C > 0 && std::isfinite(C))) return bytes.refuse();
    vapour_.capacity[i] = C;
  }
  follow_vapour(y);
}

template <typename Self, typename Bytes>
void CircuitIntegrator::visit(Self& self, Bytes& bytes) {
  bytes.numbers(self.y_);
  for (auto& a : self.published_) {
    for (auto* x : {&a.F, &a.F_dot, &a.K, &a.D, &a.stiffness, &a.lambda, &a.x, &a.v, &a.work, &a.impulse, &a.p_a,
                    &a.p_b, &a.Q_a, &a.Q_b}) {
      bytes.number(*x);
    }
  }
  bytes.flag(self.was_clamped_);
  bytes.flag(self.has_failed_);
  bytes.number(self.offender_);
  bytes.flag(self.is_consistent_);
  for (std::size_t i = 0; i < self.is_quasi_static_.size(); ++i) {
    bytes.flag(self.is_quasi_static_[i]);
    if constexpr (Bytes::kIsReading) {
      if (self.is_quasi_static_[i] > self.may_be_quasi_static_[i]) return bytes.refuse();
    }
  }
}

void CircuitIntegrator::save(StateWriter& bytes) const {
  circuit_.save(bytes);
  visit(*this, bytes);
  circuit_.save_vapour(bytes, y_.data());
  solver_->save(bytes);
  if (circuit_.has_temperatures()) circuit_.save_heat(bytes);
}

void CircuitIntegrator::load(StateReader& bytes) {
  circuit_.load(bytes);
  visit(*this, bytes);
  if (bytes.is_sound()) list_quasi_static();
  circuit_.load_vapour(bytes, y_.data());
  solver_->load(bytes);
  if (circuit_.has_temperatures()) circuit_.load_heat(bytes, y_.data());
  // no other field can be inconsistent
  if (!is_consistent_ && quasi_static_.empty()) bytes.refuse();
}

}  // namespace slew::hydraulics
