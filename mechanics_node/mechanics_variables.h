// SPDX-License-Identifier: Apache-2.0
// The variables that the mechanics publish: those of the model, the reactions of its joints, then per port the line
// force, its friction, its end stop, the static force and its change with the payload, then the age of the partner's
// sample (free-running only) and the mass of the payload.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/element_variable.h"
#include "core/time.h"
#include "coupling/samples.h"
#include "mechanics_node/mechanism.h"
#include "mechanics_node/payload.h"
#include "mechanics_node/row_force_laws.h"

namespace slew::mechanics_node {

class MechanicsVariables {
 public:
  // Allocates; read() does not.
  MechanicsVariables(const multibody::Model& model, const std::vector<Port>& ports, int payload, bool has_partner_age);

  [[nodiscard]] std::span<const ElementVariable> list() const noexcept { return list_; }

  // What the values are read from, at the published instant.
  struct Instant {
    const Mechanism& mechanism;  // observed
    const std::vector<Port>& ports;
    const coupling::MechanismSample& published;
    std::span<const double> row_force;
    StepIndex partner_age;
  };
  // What read() computes in.
  struct Work {
    // Allocates.
    Work(const multibody::Model& model, PayloadSensitivity sensitivity);
    PayloadSensitivity payload;  // with the mechanism's parameters
    multibody::Workspace workspace;
    std::vector<multibody::JointReaction> reactions;  // by joint of the scene
  };
  void read(const Instant& instant, Work& work, std::span<double> values) const noexcept;

 private:
  std::vector<ElementVariable> list_;
  std::size_t of_model_ = 0, of_reactions_ = 0;  // number of variables
  int payload_;                                  // body of the model, 0: none
  bool has_partner_age_;
};

}  // namespace slew::mechanics_node
