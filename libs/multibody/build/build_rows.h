// SPDX-License-Identifier: Apache-2.0
// Parts of build_model(): paths between links, and rows. Internal to the library.
#pragma once

#include <string>

#include "multibody/model/model.h"

namespace slew::multibody {

// Appends to model.paths the joints between two links: those that move link 1 with sign -1, link 2 with sign +1.
void add_path(Model& model, int link1, int link2);

// Links between a cut's bodies and Ground.
void add_supports(Model& model, Cut& cut);
void add_supports(Model& model, Gear& gear);

// Appends the row of the element or joint with this name; pre-condition: validate_rows() found nothing.
void add_row(const MechanicsDef& mechanics, const std::string& name, Model& model);

}  // namespace slew::multibody
