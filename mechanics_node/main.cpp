// SPDX-License-Identifier: Apache-2.0
// The program mechanics_node: the mechanism of a session's scene as a process of its own.
#include "mechanics_node/mechanics_subsystem.h"
#include "program/physics_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  return program::run_physics_program(
      {wire::Role::mechanics, "Mechanics of a Slewring session: bodies, joints, forces.",
       "--session truck_crane --interface eth0 --peer 192.168.1.20 --keys for_crane2",
       mechanics_node::make_mechanics_subsystem},
      argc, argv);
}
