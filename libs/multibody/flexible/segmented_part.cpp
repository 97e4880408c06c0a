// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/segmented_part.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/model/topology.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

struct Frame {
  Mat3 R;
  Vec3 p;
};

Frame frame_of(const Model& model, int body, const Workspace& ws) noexcept {
  const Body& b = model.bodies[at(body)];
  const LinkMotion& m = ws.motion[at(b.link)];
  return {m.R * b.R_LB, m.p + m.R * b.p_LB};
}

// the place of a lump's frame in the frame of the whole body
Vec3 origin_of(const SegmentChain& chain, std::size_t lump) noexcept {
  return lump == chain.root ? Vec3() : chain.lumps[lump].station;
}

Vec3 deflection(const Model& model, const SegmentedPart& part, const Workspace& ws, std::size_t lump,
                Vec3 place) noexcept {
  const SegmentChain& chain = *part.source;
  const Frame root = frame_of(model, part.bodies[chain.root], ws), own = frame_of(model, part.bodies[lump], ws);
  const Vec3 there = own.p + own.R * (place - origin_of(chain, lump));
  return transpose_multiply(root.R, there - root.p) - place;
}

FramePair frames_of(const Model& model, const SegmentedPart& part, const SegmentConnector& connector) {
  const SegmentChain& chain = *part.source;
  const Vec3 joint = chain.lumps[connector.near].station + connector.axes.c[0] * connector.length;
  const auto [body1, body2] = std::pair(part.bodies[connector.near], part.bodies[connector.far]);
  const Body &b1 = model.bodies[at(body1)], &b2 = model.bodies[at(body2)];
  return {.link1 = b1.link,
          .link2 = b2.link,
          .body1 = body1,
          .body2 = body2,
          .R_L1 = b1.R_LB * connector.axes,
          .R_L2 = b2.R_LB * connector.axes,
          .p_L1 = b1.p_LB + b1.R_LB * (chain.lumps[connector.near].station - origin_of(chain, connector.near)),
          .p_L2 = b2.p_LB + b2.R_LB * (joint - origin_of(chain, connector.far)),
          .rest = Vec3(connector.length, 0, 0)};
}

// no lump but the root moves on a joint of the scene
bool is_free(const Model& model, const SegmentedPart& part) {
  for (std::size_t i = 0; i < part.bodies.size(); ++i) {
    const Body& body = model.bodies[at(part.bodies[i])];
    const bool is_own = body.joint >= 0 && model.joints[at(body.joint)].name == body.name;
    if (i != part.source->root && !is_own) return false;
  }
  return true;
}

}  // namespace

void add_segments(const MechanicsDef& mechanics, Model& model) {
  for (const SegmentedBodyDef& def : mechanics.segmented_bodies) {
    const SegmentChain& chain = *def.chain;
    SegmentedPart part{
        .name = def.body, .first_beam = model.elements.beams.size(), .start = def.start, .source = def.chain};
    for (std::size_t i = 0; i < chain.lumps.size(); ++i) {
      part.bodies.push_back(find_body(mechanics, lump_name(def, i)));
    }
    const double beta = chain.first_frequency > 0 ? 2 * def.relative_damping / chain.first_frequency : 0;
    for (std::size_t k = 0; k < chain.connectors.size(); ++k) {
      model.elements.beams.push_back({.name = def.body + ".Connector" + std::to_string(k + 1),
                                      .frames = frames_of(model, part, chain.connectors[k]),
                                      .K = chain.connectors[k].K,
                                      .damping_time = beta});
    }
    for (const SegmentConnector& connector : chain.connectors) part.length += connector.length;
    part.is_free = is_free(model, part);
    model.segmented.push_back(std::move(part));
  }
}

Vec3 tip_deflection(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept {
  const SegmentNode& tip = part.source->nodes.back();
  return deflection(model, part, ws, tip.lump, tip.position);
}

LargestDeflection largest_deflection(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept {
  LargestDeflection largest;
  for (const SegmentNode& node : part.source->nodes) {
    const double size = norm(deflection(model, part, ws, node.lump, node.position));
    if (size > largest.size) largest = {node.id, size};
  }
  return largest;
}

double strain_energy(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept {
  double sum = 0;
  for (std::size_t k = 0; k < part.source->connectors.size(); ++k) {
    const Beam& beam = model.elements.beams[part.first_beam + k];
    sum += stored_energy(
        beam, deflection_of(beam.frames, ws.motion[at(beam.frames.link1)], ws.motion[at(beam.frames.link2)]));
  }
  return sum;
}

LargestBend largest_bend(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept {
  LargestBend largest;
  for (std::size_t k = 0; k < part.source->connectors.size(); ++k) {
    const FramePair& frames = model.elements.beams[part.first_beam + k].frames;
    const Deflection d = deflection_of(frames, ws.motion[at(frames.link1)], ws.motion[at(frames.link2)]);
    if (norm(d.theta) > largest.angle) largest = {k, norm(d.theta)};
  }
  return largest;
}

}  // namespace slew::multibody
