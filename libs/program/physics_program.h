// SPDX-License-Identifier: Apache-2.0
// The program of a physics node: mechanics_node, hydraulics_node and flex_node differ in their subsystem and their
// help.
#pragma once

#include <string>

#include "node/subsystem_factory.h"
#include "transport/wire.h"

namespace slew::program {

struct PhysicsProgram {
  wire::Role role = wire::Role::mechanics;
  std::string description;  // text of --help
  std::string example;      // options of the command in --help
  node::MakeSubsystem make;
};

// The whole of main(); returns the exit code.
[[nodiscard]] int run_physics_program(const PhysicsProgram& program, int argc, const char* const* argv) noexcept;

}  // namespace slew::program
