// SPDX-License-Identifier: Apache-2.0
// The program flex_node: the flexible bodies of a session's scene as a process of its own.
#include "flex_node/flex_subsystem.h"
#include "program/physics_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  return program::run_physics_program(
      {wire::Role::flex,
       "Flexible bodies of a Slewring session: elastic forces, deflection of every node, stress, strain energy; their "
       "files from --assets.",
       "--session truck_crane_flexible --assets scenes --interface eth0 --peer 192.168.1.20 --keys for_crane2",
       flex_node::make_flex_subsystem},
      argc, argv);
}
