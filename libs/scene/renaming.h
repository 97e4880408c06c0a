// SPDX-License-Identifier: Apache-2.0
// Names of the elements of an instance: a prefix on each, and on every reference to them from inside of it.
#pragma once

#include <string>

#include "scene/yaml_tree.h"

namespace slew::scene {

// Puts the prefix before the names of all elements in the tree's sections, and before every text that names one of
// them: fields with a reference, variables and conditions ("Cyl.force"), named points ("Boom.tip"), joints of `start`,
// bodies of `payload`. A text from a level outside of `level` (Node::level) names elements outside of the tree and
// stays.
void put_prefix(Node& tree, const std::string& prefix, int level);

}  // namespace slew::scene
