// SPDX-License-Identifier: Apache-2.0
// Definition of bodies made of finite segments, and the data of such a body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "math/vector3.h"
#include "multibody/forces/beam.h"

namespace slew::multibody {

// A rigid lump with its mass around a point of the beam.
struct SegmentLump {
  math::Vec3 station;  // m, frame of the whole body
  double mass = 0;     // kg
  math::Vec3 centre;   // m, the same frame
  math::Mat3 inertia;  // kg m2 about the centre, axes of that frame
};

// A massless connector between two lumps; near is the one towards the root.
struct SegmentConnector {
  std::size_t near = 0, far = 0;
  math::Mat3 axes;  // columns x from near to far, y, z, undeformed; frame of the whole body
  double length = 0;
  BeamStiffness K;
};

struct SegmentNode {
  std::int64_t id = 0;
  math::Vec3 position;  // m, undeformed, frame of the whole body
  std::size_t lump = 0;
};

struct SegmentChain {
  std::string source{};                      // for messages
  std::vector<SegmentLump> lumps{};          // from one end of the beam to the other
  std::vector<SegmentConnector> connectors;  // each after the one that carries its near lump
  std::size_t root = 0;                      // lump that represents the scene's body
  std::vector<SegmentNode> nodes{};          // nodes of the source; the last is the tip
  double first_frequency = 0;                // omega_1 of the source [rad/s]
};

// straight, for one body: all segmented bodies of the mechanism start so.
enum class SegmentStart : int { at_rest, straight };

// Makes a body of the scene a chain of lumps: the root lump is the body itself, with its frame; the others are bodies
// "Boom.Segment2", counted from the beam's end, each with its frame at its station. Attachment points of the body ride
// on the nearest lump, nodes ("Boom.Node20") on the lump that holds them.
struct SegmentedBodyDef {
  std::string body{};                           // name of the scene's body
  std::shared_ptr<const SegmentChain> chain{};  // from its files
  double relative_damping = 0;                  // zeta of the first mode: beta = 2 zeta/omega_1
  SegmentStart start = SegmentStart::at_rest;
};

struct BodyDef;

// Mass, centre of mass and inertia of all lumps, undeformed.
void take_mass(const SegmentChain& chain, BodyDef& body) noexcept;

}  // namespace slew::multibody
