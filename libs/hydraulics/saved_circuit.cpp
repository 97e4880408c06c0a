// The state of a circuit and of its integration as bytes.
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
    bytes.flag(line.is_line);
    bytes.number(line.delay);
    auto& state = line.state;
    for (auto* x : {&state.c_h, &state.c_m, &state.c_m_next, &state.Z, &state.Z_next, &state.x}) bytes.number(*x);
    if constexpr (Bytes::kIsReading) {
      if (!line.is_line) continue;
      // of a chamber alone
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
  solver_->save(bytes);
}

void CircuitIntegrator::load(StateReader& bytes) {
  circuit_.load(bytes);
  visit(*this, bytes);
  solver_->load(bytes);
  if (bytes.is_sound()) list_quasi_static();
  // nothing else can be inconsistent
  if (!is_consistent_ && quasi_static_.empty()) bytes.refuse();
}

}  // namespace slew::hydraulics
