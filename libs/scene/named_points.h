// SPDX-License-Identifier: Apache-2.0
// Named points of bodies, written out where a point is wanted.
//
//   bodies: {Boom: {points: {tip: [-2.6 m, 0, 0], eye: {position: [0, 0.2 m, 0], orientation: [0, 90 deg, 0]}}}}
//   joints: {Tip: {type: revolute, point1: Boom.tip, body2: Jib}}        body1 is Boom as well
//           {Eye: {type: revolute, frame1: Boom.eye, body2: Link}}       body1, point1 and orientation1
//
// A point may stand in every list of three lengths with a body beside it: point, point1, point2; position with
// relative_to or body; an entry of points with bodies. A body that is given must be the point's. The orientation of a
// point is that of a joint's frame. `Ground` may have points too, and nothing else.
#pragma once

#include <string>
#include <vector>

#include "scene/diagnostic.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

struct NamedPoint {
  std::string name;  // "Boom.tip"
  std::string body;
  Node position;     // list of three lengths in the body's frame
  Node orientation;  // list of three angles, or empty
};

// Replaces all names of points in the tree, and removes `points` from its bodies. Problems go to the report. Returns
// the points in the order of their names.
std::vector<NamedPoint> place_named_points(Node& root, Report& report);

}  // namespace slew::scene
