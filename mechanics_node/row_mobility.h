// SPDX-License-Identifier: Apache-2.0
// Free acceleration and mobility of the mechanism's rows, at the evaluated instant or over an interval.
//
// Over an interval the springs and dampers behind the rows take part (multibody/formulations/step_rows.h). Rows over an
// interval are used where they differ from those of the instant by more than kSignificantChange, which is decided once
// at the start of the scene, and while a contact is active: a contact force lasts for a fraction of the interval and is
// no free acceleration of all of it. Where their matrix is singular, the rows of the instant are used; `kind` shows it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "coupling/samples.h"
#include "mechanics_node/mechanism.h"
#include "multibody/formulations/step_rows.h"

namespace slew::mechanics_node {

// Free acceleration and mobility of all rows, on their own coordinates; W is row-major.
struct Rows {
  std::span<const double> a_free, W;
  coupling::MobilityKind kind = coupling::MobilityKind::instant;
};

class RowMobility {
 public:
  // The ports are the first rows. Intervals [s]: from one exchange to the next, and a sub-step. Evaluates the
  // mechanism. Allocates; nothing else does. mechanism outlives this.
  RowMobility(Mechanism& mechanism, std::size_t ports, double exchange_interval, double substep);

  // Pre-condition of both: the mechanism is evaluated. The result is valid until the next call or evaluation.
  [[nodiscard]] Rows over_exchange() noexcept;
  [[nodiscard]] Rows over_substep(double h) noexcept;
  // Modes, or springs that change the rows over a sub-step, behind the rows of rk4.
  [[nodiscard]] bool springs_answer_within_substep() const noexcept { return springs_answer_; }

 private:
  [[nodiscard]] Rows at_instant() const noexcept;
  [[nodiscard]] Rows over(double h, multibody::StepShares shares) noexcept;
  [[nodiscard]] bool differs(std::size_t count, double change, std::span<const double> W_h) const noexcept;

  Mechanism& mechanism_;
  double exchange_interval_;
  multibody::StepShares substep_shares_;            // how the integrator answers a held force
  std::unique_ptr<multibody::StepRows> step_rows_;  // null: the rows of the instant hold over any interval
  bool varies_over_exchange_ = false;               // even without active contacts
  bool varies_over_substep_ = false;                // the same for long sub-steps and all rows
  bool springs_answer_ = false;
};

}  // namespace slew::mechanics_node
