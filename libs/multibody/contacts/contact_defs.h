// SPDX-License-Identifier: Apache-2.0
// Definition of contact: shapes on bodies, the pairs of shapes that are tested, and named sets of friction.
//
// A shape has a pose in its body's frame; its own axes are those of contact/contact_def.h (a plane is solid below its
// z, cylinders and capsules lie along z, a height field rises along z). Only declared pairs are tested.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "contact/contact_def.h"

namespace slew::multibody {

// One struct for every shape; each type's field table lists the members that it has.
struct ShapeDef {
  std::string name{};
  contact::ShapeType type = contact::ShapeType::sphere;
  std::string body = "Ground";
  Triple position{};     // m, in the body's frame
  Triple orientation{};  // rad, Euler z-x'-z''
  double radius = 0;     // m, > 0
  double length = 0;     // m, > 0
  Triple size{};         // m, > 0: edges of a box
  std::string file{};    // mesh file, which the scene reads into vertices and triangles
  double file_unit = std::numeric_limits<double>::infinity();  // m, > 0: one unit of the file; infinite: not given
  std::string file_up{};            // "y" or "z": the axis of the file that becomes y of the shape
  std::vector<double> vertices{};   // m, x y z of one vertex after the other
  std::vector<double> triangles{};  // indices of vertices, three a triangle, counter-clockwise seen from outside
  std::int64_t columns = 0;         // points of a height field along x, >= 2
  std::int64_t rows = 0;            // along y, >= 2
  double spacing_x = 0;             // m, > 0
  double spacing_y = 0;             // m, > 0
  std::vector<double> heights{};    // m, row by row
};

// A pair as in table 11. The laws come first, so that their own field tables bind to these structs.
struct ContactPairDef {
  contact::NormalLawDef normal{};
  std::string name{};
  std::string shape_a{}, shape_b{};
  std::string friction{};            // name of a FrictionDef; empty: frictionless
  std::int64_t point_variables = 4;  // contact points that are variables, 0 .. contact::kMaxPointsPerPair
  bool tested = true;                // false: named in the scene, never searched
};

// A named friction as in table 12.
struct FrictionDef {
  contact::FrictionLawDef law{};
  std::string name{};
};

}  // namespace slew::multibody
