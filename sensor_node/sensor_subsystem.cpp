// SPDX-License-Identifier: Apache-2.0
#include "sensor_node/sensor_subsystem.h"

#include <fmt/format.h>

#include "core/state_hash.h"
#include "coupling/saved_model.h"
#include "math/rotation.h"
#include "scene/ports.h"
#include "scene/sensors.h"

namespace slew::sensor_node {
namespace {

constexpr std::uint32_t kLayout = 2;  // layout of a saved state

}  // namespace

SensorSubsystem::SensorSubsystem(const scene::Scene& scene)
    : levels_(scene::port_levels(scene)),
      def_(scene::sensors_of(scene)),
      sensors_(def_),
      frames_(def_.frames.size()),
      saved_model_(
          coupling::saved_model(sensors_.variables(), {scene.session.step_duration().ns, scene.recording.every})) {}

bool SensorSubsystem::first_sample(coupling::OwnSample&) noexcept {
  return false;
}

Status SensorSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  const std::size_t expected = coupling::kPoseNumbers * (frames_.size() - 1);
  const std::size_t found = partners.poses != nullptr ? partners.poses->frame.size() : 0;
  if (found != expected) {
    return Status::error(ExitCode::failed,
                         fmt::format("mechanics publishes {} numbers of poses, the sensors need {}: the nodes run "
                                     "different scenes; start them with the same one",
                                     found, expected));
  }
  if (observe(*partners.poses, sample)) return Status::ok();
  return Status::error(ExitCode::failed, fmt::format("{}: no distance was found at the start",
                                                     offender_name(static_cast<std::int32_t>(sensors_.failed()))));
}

bool SensorSubsystem::observe(const coupling::PoseSample& poses, coupling::OwnSample& sample) {
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    const std::span<const double> x =
        poses.frame.span().subspan(coupling::kPoseNumbers * (i - 1), coupling::kPoseNumbers);
    frames_[i] = {.p_W = {x[0], x[1], x[2]},
                  .R_W = math::rotation_of({x[3], x[4], x[5], x[6]}),
                  .v_W = {x[7], x[8], x[9]},
                  .w_W = {x[10], x[11], x[12]}};
  }
  const bool is_fine = sensors_.observe(frames_);
  published_.events.clear();
  for (const sensors::Event& event : sensors_.events()) {
    published_.events.push_back({static_cast<std::uint16_t>(event.sensor), static_cast<std::uint16_t>(event.watched),
                                 static_cast<std::uint8_t>(event.kind), event.value, event.place_W.array(),
                                 event.before});
  }
  sample.sensors = published_;
  return is_fine;
}

StepReport SensorSubsystem::step(StepIndex, const coupling::PartnerSamples& partners, std::span<const double>,
                                 coupling::OwnSample& sample) noexcept {
  StepReport report;
  if (partners.poses->frame.size() != coupling::kPoseNumbers * (frames_.size() - 1)) {
    // a sample of another scene: the last values stay
    report.raise(StepFlag::clamp_active);
    sample.sensors = published_;
  } else if (!observe(*partners.poses, sample)) {
    report.raise(StepFlag::not_converged);
    report.offender = static_cast<std::int32_t>(sensors_.failed());
  }
  return report;
}

// no parameters of its own: a change of a sensor needs a restart
bool SensorSubsystem::change_parameter(StepIndex, const coupling::ParameterChange& change) noexcept {
  return levels_.change(change.path, change.value);
}

void SensorSubsystem::reset() {
  levels_.reset();
  sensors_.reset();
  published_.events.clear();
}

std::uint64_t SensorSubsystem::state_hash() const noexcept {
  StateHash hash;
  hash.add(sensors_.state_hash());
  for (const coupling::SensorEvent& event : published_.events) {
    hash.add(static_cast<std::uint64_t>(event.sensor));
    hash.add(static_cast<std::uint64_t>(event.watched));
    hash.add(static_cast<std::uint64_t>(event.kind));
    hash.add(event.value);
    hash.add(std::span<const double>(event.place));
    hash.add(event.before);
  }
  return hash.digest();
}

// ---- saved state ----------------------------------------------------------------------------------------------

void SensorSubsystem::save(std::vector<std::byte>& state) const {
  StateWriter bytes(state, {kLayout, saved_model_});
  levels_.save(bytes);
  sensors_.save(bytes);
  std::size_t events = published_.events.size();
  bytes.count(events, coupling::kMaxSensorEvents);
  for (const coupling::SensorEvent& event : published_.events) {
    bytes.number(event.sensor);
    bytes.number(event.watched);
    bytes.number(event.kind);
    bytes.number(event.value);
    bytes.numbers(std::span<const double>(event.place));
    bytes.number(event.before);
  }
  bytes.finish();
}

Status SensorSubsystem::load(std::span<const std::byte> state, coupling::OwnSample& sample) {
  reset();
  StateReader bytes(state, {kLayout, saved_model_});
  levels_.load(bytes);
  sensors_.load(bytes);
  std::size_t events = 0;
  bytes.count(events, coupling::kMaxSensorEvents);
  published_.events.resize(events);
  for (coupling::SensorEvent& event : published_.events) {
    bytes.number(event.sensor);
    bytes.number(event.watched);
    bytes.number(event.kind);
    bytes.number(event.value);
    bytes.numbers(std::span<double>(event.place));
    bytes.number(event.before);
  }
  if (Status status = bytes.finish("sensors"); !status.is_ok()) {
    reset();
    return status;
  }
  sample = {};
  sample.sensors = published_;
  return Status::ok();
}

std::string_view SensorSubsystem::offender_name(std::int32_t index) const noexcept {
  const auto at = static_cast<std::size_t>(index);
  return index >= 0 && at < def_.sensors.size() ? std::string_view(def_.sensors[at].name) : "a sensor";
}

std::unique_ptr<coupling::Subsystem> make_sensor_subsystem(const scene::Scene& scene) {
  return std::make_unique<SensorSubsystem>(scene);
}

}  // namespace slew::sensor_node
