// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/modal_exchange.h"

#include <fmt/format.h>

#include <algorithm>

namespace slew::mechanics_node {

using coupling::ElasticSample;
using multibody::FlexiblePart;
using multibody::Model;

ModalExchange::ModalExchange(const scene::Scene& scene, const Model& model) {
  for (const scene::FlexibleBody& flexible : scene.flexible_bodies) {
    const auto part = std::find_if(model.parts.begin(), model.parts.end(),
                                   [&](const FlexiblePart& candidate) { return candidate.name == flexible.body; });
    const std::size_t modes = part->modes;
    bodies_.push_back({static_cast<std::size_t>(part - model.parts.begin()), modes_, modes, pairs_});
    modes_ += modes;
    pairs_ += modes * modes;
  }
}

void ModalExchange::read(const Model& model, const multibody::State& state, const multibody::Workspace& ws,
                         coupling::FlexibleSample& sample) const noexcept {
  sample.q.clear();
  sample.u.clear();
  sample.frame.clear();
  for (const Body& body : bodies_) {
    const FlexiblePart& part = model.parts[body.part];
    for (std::size_t k = 0; k < body.modes; ++k) {
      sample.q.push_back(state.q[static_cast<std::size_t>(part.q) + k]);
      sample.u.push_back(state.u[static_cast<std::size_t>(part.u) + k]);
    }
    append_frame(model, ws, part.body, sample.frame);
  }
}

bool ModalExchange::has_sizes(const ElasticSample& sample) const noexcept {
  return sample.Q.size() == modes_ && sample.q_ref.size() == modes_ && sample.u_ref.size() == modes_ &&
         sample.K.size() == pairs_ && sample.D.size() == pairs_ && (sample.M.empty() || sample.M.size() == pairs_);
}

multibody::ElasticLaw ModalExchange::law_of(const ElasticSample& sample, const Body& body) const noexcept {
  const auto modes = [&](const coupling::ModeArray& values) {
    return values.span().subspan(body.first_mode, body.modes);
  };
  const auto pairs = [&](const coupling::ModePairs& values) {
    return values.span().subspan(body.first_pair, body.modes * body.modes);
  };
  multibody::ElasticLaw law{modes(sample.Q), modes(sample.q_ref), modes(sample.u_ref),
                            pairs(sample.K), pairs(sample.D),     {}};
  if (!sample.M.empty()) law.M = pairs(sample.M);
  return law;
}

Status ModalExchange::begin(const multibody::MechanicsDef& mechanics, const ElasticSample& sample, Model& model) {
  if (!has_sizes(sample)) {
    return Status::error(
        ExitCode::failed,
        fmt::format("the flex node publishes {} modes, mechanics has {}: the nodes run different scenes; "
                    "start them with the same one",
                    sample.Q.size(), modes_));
  }
  Model with = model;
  bool is_own = true;
  for (const Body& body : bodies_) {
    const multibody::ElasticLaw law = law_of(sample, body);
    if (Status status = multibody::check_elastic_law(model, body.part, law); !status.is_ok()) return status;
    const FlexiblePart& part = model.parts[body.part];
    is_own = is_own && std::equal(law.K.begin(), law.K.end(), part.stiffness.begin()) &&
             std::equal(law.D.begin(), law.D.end(), part.damping.begin());
    multibody::set_elastic_law(with, body.part, law);
  }
  // the elastic forces of the files were checked with the scene
  Problems problems;
  if (!is_own) multibody::check_mode_speeds(mechanics, with, problems);
  if (!problems.empty()) {
    return Status::error(ExitCode::bad_input, "elastic forces that the flex node states: " + problems.front().what +
                                                  "; expected " + problems.front().expected);
  }
  static_cast<void>(apply(sample, model));
  return Status::ok();
}

bool ModalExchange::apply(const ElasticSample& sample, Model& model) const noexcept {
  if (!has_sizes(sample)) return false;
  for (const Body& body : bodies_) multibody::set_elastic_law(model, body.part, law_of(sample, body));
  return true;
}

void ModalExchange::take_places(const ElasticSample& sample, const Model& model,
                                multibody::State& state) const noexcept {
  if (sample.M.empty()) return;
  for (const Body& body : bodies_) {
    const FlexiblePart& part = model.parts[body.part];
    for (std::size_t k = 0; k < body.modes; ++k) {
      state.q[static_cast<std::size_t>(part.q) + k] = sample.q_ref[body.first_mode + k];
      state.u[static_cast<std::size_t>(part.u) + k] = sample.u_ref[body.first_mode + k];
    }
  }
}

void ModalExchange::add_to(const Model& model, StateHash& hash) const noexcept {
  for (const Body& body : bodies_) {
    const FlexiblePart& part = model.parts[body.part];
    hash.add(part.stiffness);
    hash.add(part.damping);
    hash.add(part.preload);
    hash.add(part.mass_matrix);
  }
}

}  // namespace slew::mechanics_node
