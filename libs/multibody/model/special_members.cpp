// SPDX-License-Identifier: Apache-2.0
// Long functions that the compiler writes: compiled once, and apart from the kernels, whose inlining depends on the
// size of their unit.
#include "multibody/model/defs.h"
#include "multibody/model/model.h"
#include "multibody/model/state.h"

namespace slew::multibody {

Model::Model() = default;
Model::~Model() = default;
Model::Model(const Model&) = default;
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(const Model&) = default;
Model& Model::operator=(Model&&) noexcept = default;

MechanicsDef::MechanicsDef() = default;
MechanicsDef::~MechanicsDef() = default;
MechanicsDef::MechanicsDef(const MechanicsDef&) = default;
MechanicsDef::MechanicsDef(MechanicsDef&&) noexcept = default;
MechanicsDef& MechanicsDef::operator=(const MechanicsDef&) = default;
MechanicsDef& MechanicsDef::operator=(MechanicsDef&&) noexcept = default;

Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

}  // namespace slew::multibody
