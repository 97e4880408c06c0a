// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/payload.h"

#include <algorithm>
#include <deque>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "coupling/static_forces.h"
#include "multibody/model/parameters.h"

namespace slew::mechanics_node {

namespace {

using Names = std::map<std::string_view, std::vector<const multibody::JointDef*>>;

// "Boom" of "Boom.Node20", which a joint may name as its body
std::string_view body_of(std::string_view name, const Names& joints) {
  return joints.count(name) > 0 ? name : name.substr(0, name.find('.'));
}

// Number of moving joints between each body and Ground, on the shortest path over the scene's joints.
std::map<std::string_view, int> distances(const Names& joints) {
  std::map<std::string_view, int> found = {{multibody::kGroundName, 0}};
  std::deque<std::string_view> next = {multibody::kGroundName};
  while (!next.empty()) {
    const std::string_view here = next.front();
    next.pop_front();
    for (const multibody::JointDef* joint : joints.at(here)) {
      const std::string_view body1 = body_of(joint->body1, joints), body2 = body_of(joint->body2, joints);
      const std::string_view there = body1 == here ? body2 : body1;
      const bool moves = joint->type != multibody::JointType::fixed;
      const int distance = found.at(here) + (moves ? 1 : 0);
      const auto known = found.find(there);
      if (known != found.end() && known->second <= distance) continue;
      found[there] = distance;
      if (moves) {
        next.push_back(there);
      } else {
        next.push_front(there);
      }
    }
  }
  return found;
}

}  // namespace

int payload_of(const multibody::MechanicsDef& mechanics, const multibody::Model& model) {
  if (!mechanics.payload.empty()) return multibody::find_body(model, mechanics.payload);
  Names joints = {{multibody::kGroundName, {}}};
  for (const multibody::BodyDef& body : mechanics.bodies) joints[body.name];
  for (const multibody::JointDef& joint : mechanics.joints) {
    joints[body_of(joint.body1, joints)].push_back(&joint);
    joints[body_of(joint.body2, joints)].push_back(&joint);
  }
  const std::map<std::string_view, int> distance = distances(joints);
  std::string_view payload;
  int longest = 0;
  for (const multibody::BodyDef& body : mechanics.bodies) {
    const auto found = distance.find(body.name);
    if (body.type != multibody::BodyType::rigid || found == distance.end() || found->second == 0) continue;
    const int length = joints.at(body.name).size() == 1 ? found->second : 0;  // other bodies carry, or close a loop
    if (length < longest) continue;
    longest = length;
    payload = body.name;
  }
  return payload.empty() ? 0 : multibody::find_body(model, payload);
}

double mass_of(const multibody::Model& model, int body) noexcept {
  const int lumped = model.bodies[static_cast<std::size_t>(body)].lumped;
  return model.lumped[static_cast<std::size_t>(lumped)].mass;
}

bool static_line_forces(multibody::Model& model, const multibody::State& state, multibody::Workspace& ws,
                        std::span<const double> ratio, int payload, double mass, std::span<double> F) noexcept {
  const std::size_t m = ratio.size();
  const std::size_t rows = model.rows.size();
  multibody::set_body_mass(model, payload, mass);
  multibody::evaluate(model, state, ws);
  coupling::PortMatrix W;
  coupling::PortArray a_free;
  W.resize(m * m);
  a_free.resize(m);
  for (std::size_t i = 0; i < m; ++i) {
    a_free[i] = ratio[i] * ws.row_a_free[i];
    for (std::size_t j = 0; j < m; ++j) W[i * m + j] = ratio[i] * ws.row_W[i * rows + j] * ratio[j];
  }
  return coupling::static_forces(W.span(), a_free.span(), F);
}

std::vector<double> port_mobility(const multibody::Model& model, const multibody::Workspace& ws,
                                  std::span<const double> ratio) {
  const std::size_t m = ratio.size(), rows = model.rows.size();
  std::vector<double> W(m * m);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) W[i * m + j] = ratio[i] * ws.row_W[i * rows + j] * ratio[j];
  }
  return W;
}

void payload_slopes(multibody::Model& model, const multibody::State& state, multibody::Workspace& ws,
                    std::span<const double> ratio, int payload, double mass, std::span<double> slopes) noexcept {
  const std::size_t m = ratio.size();
  std::fill(slopes.begin(), slopes.end(), 0.0);
  if (m == 0 || payload == 0) return;
  coupling::PortArray now, more;
  now.resize(m);
  more.resize(m);
  if (!static_line_forces(model, state, ws, ratio, payload, mass, now.span()) ||
      !static_line_forces(model, state, ws, ratio, payload, mass + 1, more.span()))
    return;
  for (std::size_t i = 0; i < m; ++i) slopes[i] = more[i] - now[i];
}

PayloadSensitivity::PayloadSensitivity(const multibody::Model& model, int payload, std::vector<double> ratio)
    : model_(model), payload_(payload), ratio_(std::move(ratio)) {}

void PayloadSensitivity::copy_signals(const multibody::Model& model) noexcept {
  auto& loads = model_.elements.loads;
  for (std::size_t i = 0; i < loads.size(); ++i) loads[i].signal = model.elements.loads[i].signal;
}

void PayloadSensitivity::read(const multibody::State& state, double mass, multibody::Workspace& ws,
                              std::span<double> slopes) noexcept {
  payload_slopes(model_, state, ws, ratio_, payload_, mass, slopes);
}

}  // namespace slew::mechanics_node
