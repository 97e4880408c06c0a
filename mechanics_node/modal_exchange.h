// SPDX-License-Identifier: Apache-2.0
// The mechanics' side of flexible bodies in a session: their motion, which the flex node receives, and the elastic
// forces that it returns for their modes.
#pragma once

#include <cstddef>
#include <vector>

#include "core/state_hash.h"
#include "core/status.h"
#include "coupling/samples.h"
#include "multibody/flexible/elastic_law.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/results/observe.h"
#include "scene/scene.h"

namespace slew::mechanics_node {

// Appends position, quaternion, velocity and angular velocity of a body, in Ground.
template <typename Array>
void append_frame(const multibody::Model& model, const multibody::Workspace& ws, int body, Array& frame) noexcept {
  const multibody::BodyPose pose = multibody::body_pose(model, ws, body);
  for (const double x : pose.position) frame.push_back(x);
  for (const double e : pose.orientation) frame.push_back(e);
  for (const double v : pose.velocity) frame.push_back(v);
  for (const double w : pose.angular_velocity) frame.push_back(w);
}

class ModalExchange {
 public:
  // Pre-condition: the model is that of the scene's mechanics.
  ModalExchange(const scene::Scene& scene, const multibody::Model& model);

  [[nodiscard]] std::size_t body_count() const noexcept { return bodies_.size(); }
  [[nodiscard]] std::size_t mode_count() const noexcept { return modes_; }
  [[nodiscard]] bool is_empty() const noexcept { return bodies_.empty(); }

  // Writes modal coordinates and frames of the bodies.
  void read(const multibody::Model& model, const multibody::State& state, const multibody::Workspace& ws,
            coupling::FlexibleSample& sample) const noexcept;

  // Takes the elastic forces of a session's start. Error: they do not fit the model's bodies, or its integrator cannot
  // follow them; the model is unchanged.
  Status begin(const multibody::MechanicsDef& mechanics, const coupling::ElasticSample& sample,
               multibody::Model& model);
  // Takes the elastic forces of a step. Pre-condition: begin() took a sample. False: the sizes have changed, and the
  // model is unchanged.
  [[nodiscard]] bool apply(const coupling::ElasticSample& sample, multibody::Model& model) const noexcept;

  // Copies modal coordinates that the flex node integrates into the state; the step then moves this copy.
  void take_places(const coupling::ElasticSample& sample, const multibody::Model& model,
                   multibody::State& state) const noexcept;

  void add_to(const multibody::Model& model, StateHash& hash) const noexcept;

 private:
  struct Body {
    std::size_t part = 0;  // of the model
    std::size_t first_mode = 0, modes = 0, first_pair = 0;
  };
  [[nodiscard]] multibody::ElasticLaw law_of(const coupling::ElasticSample& sample, const Body& body) const noexcept;
  [[nodiscard]] bool has_sizes(const coupling::ElasticSample& sample) const noexcept;

  std::vector<Body> bodies_;  // in the order of the samples
  std::size_t modes_ = 0, pairs_ = 0;
};

}  // namespace slew::mechanics_node
