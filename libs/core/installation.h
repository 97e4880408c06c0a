// SPDX-License-Identifier: Apache-2.0
// Where the parts of an installation lie, found from the running program: build tree, prefix and package may be moved.
//
//   build tree     bin/slewring, bin/mechanics_node, ...
//   installation   bin/slewring, lib/slewring/mechanics_node, ..., share/slewring/scenes
#pragma once

#include <string>

namespace slew {

// Path of a program or library of ours: beside this one, or in the other folder of the installation. If it is in
// neither, the path beside this program, for the message of the caller.
[[nodiscard]] std::string sibling_program(const std::string& name);

// Folder with the scenes of the installation; empty: this program is not installed.
[[nodiscard]] std::string installed_scenes();

}  // namespace slew
