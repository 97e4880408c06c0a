// SPDX-License-Identifier: Apache-2.0
// The program sensor_node: the sensors of a session's scene as a process of its own.
#include "program/physics_program.h"
#include "sensor_node/sensor_subsystem.h"

int main(int argc, char** argv) {
  using namespace slew;
  return program::run_physics_program(
      {wire::Role::sensor,
       "Sensors of a Slewring session: clearance of bodies, zones, collision events, from the poses of the mechanics.",
       "--session truck_crane --interface eth0 --peer 192.168.1.20 --keys for_crane2",
       sensor_node::make_sensor_subsystem},
      argc, argv);
}
