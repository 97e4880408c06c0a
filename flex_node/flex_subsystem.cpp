// SPDX-License-Identifier: Apache-2.0
#include "flex_node/flex_subsystem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/state_hash.h"
#include "coupling/saved_model.h"
#include "scene/ports.h"

namespace slew::flex_node {

using coupling::ElasticExchange;
using coupling::ElasticSample;
using coupling::ModeArray;

namespace {

constexpr std::uint32_t kLayout = 1;  // layout of a saved state

}  // namespace

FlexSubsystem::FlexSubsystem(const scene::Scene& scene)
    : levels_(scene::port_levels(scene)),
      exchange_(scene.session.flexible),
      H_(scene.session.step_duration().seconds()) {
  for (const scene::FlexibleBody& model : scene.flexible_bodies) {
    const std::size_t modes = model.reduction->body.modes();
    bodies_.push_back({model.body, model.reduction, constant_.Q.size(), modes, constant_.K.size()});
    for (std::size_t k = 0; k < modes; ++k) {
      for (ModeArray* zero : {&constant_.Q, &constant_.q_ref, &constant_.u_ref, &q_, &u_}) zero->push_back(0);
    }
    for (const double k : model.stiffness) constant_.K.push_back(k);
    for (const double d : model.damping) constant_.D.push_back(d);
    constant_.strain_energy.push_back(0);
    list_variables(bodies_.back());
  }
  constant_.is_constant = exchange_ == ElasticExchange::once;
  published_ = constant_;
  saved_model_ =
      coupling::saved_model(variables_, {scene.session.step_duration().ns, static_cast<std::int64_t>(exchange_)});
}

void FlexSubsystem::list_variables(const Body& body) {
  const auto add = [&](const std::string& quantity, Dimension dimension, bool is_detail = false) {
    variables_.push_back({body.name + "." + quantity, dimension, is_detail});
  };
  add("strain_energy", Dimension::energy);
  const std::vector<flex::StressPoint>& points = body.model->recovery.points;
  if (!points.empty()) {
    add("largest_stress", Dimension::pressure);
    add("largest_stress_element", Dimension::none);
  }
  for (const flex::ReducedNode& node : body.model->body.nodes) {
    for (const char axis : {'x', 'y', 'z'}) add(fmt::format("Node{}.deflection.{}", node.id, axis), Dimension::length);
  }
  int number = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_same_end =
        i > 0 && points[i - 1].element == points[i].element && points[i - 1].node == points[i].node;
    number = is_same_end ? number + 1 : 1;
    const std::string point = fmt::format("Element{}.Node{}.Point{}", points[i].element, points[i].node, number);
    add(point + ".normal_stress", Dimension::pressure, true);
    if (points[i].has_shear) add(point + ".shear_stress", Dimension::pressure, true);
  }
}

bool FlexSubsystem::first_sample(coupling::OwnSample& sample) noexcept {
  sample.elastic = constant_;
  return true;
}

Status FlexSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  const std::size_t modes = q_.size();
  if (partners.flexible == nullptr || partners.flexible->q.size() != modes || partners.flexible->u.size() != modes) {
    return Status::error(
        ExitCode::failed,
        fmt::format("mechanics states {} modal coordinates, the flexible bodies have {}: the nodes run "
                    "different scenes; start them with the same one",
                    partners.flexible != nullptr ? partners.flexible->q.size() : 0, modes));
  }
  q_ = partners.flexible->q;
  u_ = partners.flexible->u;
  see(*partners.flexible, sample.elastic);
  return Status::ok();
}

// Elastic forces at the coordinates of the step, (1) or (2), and the strain energy there.
void FlexSubsystem::see(const coupling::FlexibleSample& mechanics, ElasticSample& sample) noexcept {
  if (exchange_ != ElasticExchange::condensed) {
    q_ = mechanics.q;
    u_ = mechanics.u;
  }
  published_ = constant_;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    body.strain_energy = flex::strain_energy(body.model->body, modes_of(body));
    published_.strain_energy[b] = body.strain_energy;
    if (!constant_.is_constant) state_law(body);
  }
  if (!constant_.is_constant) {
    published_.q_ref = q_;
    published_.u_ref = u_;
  }
  sample = published_;
}

void FlexSubsystem::state_law(const Body& body) noexcept {
  const bool is_condensed = exchange_ == ElasticExchange::condensed;
  const double ahead = is_condensed ? 0.5 * H_ : 0.0;
  if (is_condensed) published_.M.resize(constant_.K.size());
  for (std::size_t k = 0; k < body.modes; ++k) {
    double force = 0;
    for (std::size_t l = 0; l < body.modes; ++l) {
      const std::size_t pair = body.first_pair + k * body.modes + l, mode = body.first_mode + l;
      const double K = constant_.K[pair], D = constant_.D[pair];
      force -= K * (q_[mode] + ahead * u_[mode]) + D * u_[mode];
      if (!is_condensed) continue;
      published_.M[pair] = (k == l ? 1.0 : 0.0) + ahead * D + ahead * ahead * K;
      published_.K[pair] = published_.D[pair] = 0;
    }
    published_.Q[body.first_mode + k] = force;
  }
}

StepReport FlexSubsystem::step(StepIndex, const coupling::PartnerSamples& partners, std::span<const double>,
                               coupling::OwnSample& sample) noexcept {
  StepReport report;
  if (partners.flexible->u.size() != u_.size() || partners.flexible->q.size() != q_.size()) {
    // a sample of another scene: the last values stay
    report.raise(StepFlag::clamp_active);
    sample.elastic = published_;
    return report;
  }
  if (exchange_ == ElasticExchange::condensed) {
    const ModeArray& end = partners.flexible->u;
    for (std::size_t k = 0; k < q_.size(); ++k) {
      q_[k] += 0.5 * H_ * (u_[k] + end[k]);
      u_[k] = end[k];
    }
  }
  see(*partners.flexible, sample.elastic);
  return report;
}

// no parameters of its own: damping, modes and files need a restart
bool FlexSubsystem::change_parameter(StepIndex, const coupling::ParameterChange& change) noexcept {
  return levels_.change(change.path, change.value);
}

void FlexSubsystem::reset() {
  levels_.reset();
  for (ModeArray* values : {&q_, &u_}) std::fill(values->begin(), values->end(), 0.0);
  for (Body& body : bodies_) body.strain_energy = 0;
  published_ = constant_;
}

// the published sample is the whole state, own coordinates included
std::uint64_t FlexSubsystem::state_hash() const noexcept {
  StateHash hash;
  for (const auto values :
       {published_.Q.span(), published_.q_ref.span(), published_.u_ref.span(), published_.K.span(), published_.D.span(),
        published_.M.span(), published_.strain_energy.span(), q_.span(), u_.span()}) {
    for (const double value : values) hash.add(value);
  }
  return hash.digest();
}

// ---- saved state ----------------------------------------------------------------------------------------------

Status FlexSubsystem::can_save() const {
  return Status::ok();
}

void FlexSubsystem::save(std::vector<std::byte>& state) const {
  StateWriter bytes(state, {kLayout, saved_model_});
  levels_.save(bytes);
  bytes.numbers(q_.span());
  bytes.numbers(u_.span());
  bytes.finish();
}

// The published sample follows from the coordinates.
Status FlexSubsystem::load(std::span<const std::byte> state, coupling::OwnSample& sample) {
  reset();
  StateReader bytes(state, {kLayout, saved_model_});
  levels_.load(bytes);
  bytes.numbers(q_.span());
  bytes.numbers(u_.span());
  if (Status status = bytes.finish("flexible bodies"); !status.is_ok()) {
    reset();
    return status;
  }
  sample = {};
  coupling::FlexibleSample here;
  here.q = q_;
  here.u = u_;
  see(here, sample.elastic);
  return Status::ok();
}

void FlexSubsystem::read_variables(std::span<double> values) const noexcept {
  std::size_t at = 0;
  for (const Body& body : bodies_) {
    const std::span<const double> q = modes_of(body);
    const flex::Recovery& recovery = body.model->recovery;
    const std::size_t points = recovery.points.size();
    values[at++] = body.strain_energy;
    const std::size_t of_largest = at;
    if (points > 0) at += 2;
    for (const flex::ReducedNode& node : body.model->body.nodes) {
      for (const double d : flex::deflection(node, q).array()) values[at++] = d;
    }
    // von Mises
    std::size_t worst = 0;
    double largest = 0;
    for (std::size_t i = 0; i < points; ++i) {
      const auto [normal, shear] = flex::stress_at(recovery, i, q);
      const double square = normal * normal + 3 * shear * shear;
      if (square > largest) largest = square, worst = i;
      values[at++] = normal;
      if (recovery.points[i].has_shear) values[at++] = shear;
    }
    if (points == 0) continue;
    values[of_largest] = std::sqrt(largest);
    values[of_largest + 1] = recovery.points[worst].element;
  }
}

std::string_view FlexSubsystem::offender_name(std::int32_t) const noexcept {
  return "a flexible body";
}

std::unique_ptr<coupling::Subsystem> make_flex_subsystem(const scene::Scene& scene) {
  return std::make_unique<FlexSubsystem>(scene);
}

}  // namespace slew::flex_node
