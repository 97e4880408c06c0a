// SPDX-License-Identifier: Apache-2.0
// The values of all variables of a session in this process, in the order of DirectSession::variables().
#pragma once

#include <span>
#include <vector>

#include "session/direct_session.h"

namespace slew::analysis {

inline constexpr wire::Role kVariableRoles[] = {wire::Role::mechanics, wire::Role::hydraulics};

class VariableValues {
 public:
  // The session must outlive it.
  explicit VariableValues(const session::DirectSession& session)
      : session_(session), values_(session.variables().size()) {}

  // Values now, SI; valid until the next call.
  [[nodiscard]] std::span<const double> read() {
    std::span<double> rest = values_;
    for (const wire::Role role : kVariableRoles) {
      const coupling::Subsystem* subsystem = session_.subsystem(role);
      if (subsystem == nullptr) continue;
      const std::size_t count = subsystem->variables().size();
      subsystem->read_variables(rest.first(count));
      rest = rest.subspan(count);
    }
    return values_;
  }

  // Of the last step.
  [[nodiscard]] bool has_failed() const noexcept {
    return session_.report(wire::Role::mechanics).has_failed() || session_.report(wire::Role::hydraulics).has_failed();
  }
  [[nodiscard]] bool has_converged() const noexcept {
    return !session_.report(wire::Role::mechanics).has(StepFlag::not_converged) &&
           !session_.report(wire::Role::hydraulics).has(StepFlag::not_converged);
  }

 private:
  const session::DirectSession& session_;
  std::vector<double> values_;
};

}  // namespace slew::analysis
