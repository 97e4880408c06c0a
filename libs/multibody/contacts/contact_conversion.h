// From the scene's contact Defs to those of libs/contact. Internal to the library.
#pragma once

#include "multibody/model/defs.h"

namespace slew::multibody {

[[nodiscard]] contact::ShapeDef contact_shape(const ShapeDef& shape);

// With the friction that it names, if there is one of that name.
[[nodiscard]] contact::PairDef contact_pair(const MechanicsDef& mechanics, const ContactPairDef& pair);

}  // namespace slew::multibody
