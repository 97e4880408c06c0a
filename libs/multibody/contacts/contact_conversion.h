// SPDX-License-Identifier: Apache-2.0
// From the scene's contact Defs to those of libs/contact.
#pragma once

#include "multibody/model/defs.h"

namespace slew::multibody {

[[nodiscard]] contact::ShapeDef contact_shape(const ShapeDef& shape);

// A pair with its named friction, if that exists.
[[nodiscard]] contact::PairDef contact_pair(const MechanicsDef& mechanics, const ContactPairDef& pair);

}  // namespace slew::multibody
