// SPDX-License-Identifier: Apache-2.0
// `start:` of a scene: its pose by joint coordinates (multibody/build/put_joints.h), and `payload:`, the bodies that it
// lifts.
#pragma once

#include "core/problem.h"
#include "scene/field_reader.h"
#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

//   start: {Boom_Hinge: 40 deg, Telescope: 1.2 m, Cardan: [10 deg, 5 deg]}
// Changes the poses of the bodies. Pre-condition: bodies and joints are read, and their references hold.
void read_start(const Node& start, Scene& scene, const ReadContext& context, Problems& problems);

//   payload: Bag     payload: [Bag, Pallet]
void read_payload(const Node& payload, Scene& scene, const ReadContext& context);

// Rules for the bodies beside the first, whose rules multibody has: rigid, movable, each named once. Pre-condition: the
// mechanics is sound.
void check_payloads(const Scene& scene, Problems& problems);

}  // namespace slew::scene
