// SPDX-License-Identifier: Apache-2.0
// The program hydraulics_node: the hydraulic circuit of a session's scene as a process of its own.
#include "hydraulics_node/hydraulics_subsystem.h"
#include "program/physics_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  return program::run_physics_program(
      {wire::Role::hydraulics, "Hydraulics of a Slewring session: valves, pump, cylinders, hoses.",
       "--session truck_crane --interface eth0 --peer 192.168.1.20 --keys for_crane2",
       hydraulics_node::make_hydraulics_subsystem},
      argc, argv);
}
