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
  // payload: with the mechanism's parameters.
  void read(const Instant& instant, PayloadSensitivity& payload, std::span<double> values) noexcept;

 private:
  std::vector<ElementVariable> list_;
  std::size_t of_model_ = 0, of_reactions_ = 0;  // number of variables
  int payload_;                                  // body of the model, 0: none
  bool has_partner_age_;
  multibody::Workspace workspace_;                   // scratch
  std::vector<multibody::JointReaction> reactions_;  // scratch, by joint of the scene
};

}  // namespace slew::mechanics_node
