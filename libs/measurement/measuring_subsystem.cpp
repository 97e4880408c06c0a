// SPDX-License-Identifier: Apache-2.0
#include "measurement/measuring_subsystem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/failure.h"
#include "core/state_hash.h"
#include "core/suggestion.h"
#include "coupling/saved_model.h"
#include "math/rotation.h"

namespace slew::measurement {
namespace {

constexpr std::uint32_t kLayout = 1;   // layout of a saved state
constexpr std::size_t kImuReads = 13;  // position, orientation, velocity, angular velocity of a body
constexpr std::string_view kImuVariables[kImuReads] = {
    ".position.x",         ".position.y",         ".position.z",        ".orientation.w", ".orientation.x",
    ".orientation.y",      ".orientation.z",      ".velocity.x",        ".velocity.y",    ".velocity.z",
    ".angular_velocity.x", ".angular_velocity.y", ".angular_velocity.z"};

std::uint64_t key_of(const InstrumentDef& def, int channel) noexcept {
  StateHash hash;
  hash.add_bytes(def.name.data(), def.name.size());
  hash.add(def.sampling.seed);
  hash.add(channel);
  return hash.digest();
}

StepIndex steps_of(double time, SimDuration step) noexcept {
  return std::llround(time / step.seconds());
}

// Index of a variable of the physics; throws Failure.
std::size_t find_variable(std::span<const ElementVariable> variables, const std::string& name,
                          const InstrumentDef& def) {
  const auto found = std::find_if(variables.begin(), variables.end(),
                                  [&](const ElementVariable& variable) { return variable.name == name; });
  if (found != variables.end()) return static_cast<std::size_t>(found - variables.begin());
  std::vector<std::string_view> names;
  for (const ElementVariable& variable : variables) names.push_back(variable.name);
  const std::string meant = closest(name, names);
  throw Failure(ExitCode::bad_input,
                fmt::format("{}: {}: there is no variable '{}' in the node that computes its element; `slewring "
                            "variables SCENE` lists all{}",
                            def.place.empty() ? "sensors" : def.place, def.name, name,
                            meant.empty() ? "" : "; did you mean '" + meant + "'?"));
}

math::Vec3 in_axes_of(const math::Mat3& R, math::Vec3 a_W) noexcept {
  return {math::dot(R.c[0], a_W), math::dot(R.c[1], a_W), math::dot(R.c[2], a_W)};
}

}  // namespace

MeasuringSubsystem::MeasuringSubsystem(std::unique_ptr<coupling::Subsystem> physics,
                                       std::vector<InstrumentDef> instruments, SimDuration step, Gravity gravity)
    : physics_(std::move(physics)), H_(step), gravity_(std::move(gravity)) {
  const std::span<const ElementVariable> measured = physics_->variables();
  variables_.assign(measured.begin(), measured.end());
  values_.resize(measured.size());
  instruments_.reserve(instruments.size());
  for (InstrumentDef& def : instruments) add_instrument(std::move(def), step);
  list_parameters();
  saved_model_ = coupling::saved_model(variables_, {step.ns});
}

void MeasuringSubsystem::add_instrument(InstrumentDef def, SimDuration step) {
  const std::span<const ElementVariable> measured = physics_->variables();
  const bool is_imu = def.type == InstrumentType::imu;
  Instrument instrument;
  instrument.fate = ChannelNoise(key_of(def, -1));
  instrument.every = std::max<StepIndex>(1, steps_of(def.sampling.sample_time, step));
  instrument.delay = steps_of(def.sampling.delay, step);
  if (is_imu) {
    for (const std::string_view variable : kImuVariables) {
      instrument.reads.push_back(find_variable(measured, def.body + std::string(variable), def));
    }
  } else {
    const std::size_t i = find_variable(measured, def.variable, def);
    const Dimension wanted = instrument_types()[static_cast<std::size_t>(def.type)].dimension;
    if (measured[i].dimension != wanted) {
      throw Failure(ExitCode::bad_input,
                    fmt::format("sensors: {}: '{}' is in {}, its type measures {}; give it the type of this quantity",
                                def.name, def.variable, info(measured[i].dimension).si_unit, info(wanted).si_unit));
    }
    instrument.reads.push_back(i);
  }
  const auto kept = static_cast<std::size_t>((instrument.delay + instrument.every - 1) / instrument.every);
  for (int channel = 0; channel < (is_imu ? 6 : 1); ++channel) {
    instrument.channels.emplace_back(key_of(def, channel), kept);
  }
  for (ElementVariable& variable : variables_of(def)) variables_.push_back(std::move(variable));
  instrument.def = std::move(def);
  instruments_.push_back(std::move(instrument));
}

void MeasuringSubsystem::list_parameters() {
  for (Instrument& instrument : instruments_) {
    for (const Field& field : instrument_types()[static_cast<std::size_t>(instrument.def.type)].fields) {
      if (field.change != Change::live) continue;
      const std::string path = instrument.def.name + "." + std::string(field.key);
      void* const member = field.member(&instrument.def);
      if (field.type == FieldType::number) {
        double* const value = static_cast<double*>(member);
        parameters_.push_back({path, value, *value});
        continue;
      }
      Triple& triple = *static_cast<Triple*>(member);
      for (std::size_t i = 0; i < 3; ++i) {
        parameters_.push_back({path + std::string{'.', "xyz"[i]}, &triple[i], triple[i]});
      }
    }
  }
  ramps_ = coupling::ParameterRamps(parameters_.size());
}

// ---- a step ---------------------------------------------------------------------------------------------------

bool MeasuringSubsystem::first_sample(coupling::OwnSample& sample) noexcept {
  return physics_->first_sample(sample);
}

Status MeasuringSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  Status status = physics_->start(partners, sample);
  if (status.is_ok()) observe(0);
  return status;
}

StepReport MeasuringSubsystem::step(StepIndex n, const coupling::PartnerSamples& partners,
                                    std::span<const double> controls, coupling::OwnSample& sample) noexcept {
  const StepReport report = physics_->step(n, partners, controls, sample);
  ramps_.apply(n, [this](int handle, double value) { *parameters_[static_cast<std::size_t>(handle)].value = value; });
  observe(n + 1);
  return report;
}

bool MeasuringSubsystem::is_read_at(const Instrument& instrument, StepIndex n) const noexcept {
  if (n % instrument.every == 0) return true;
  return instrument.def.type == InstrumentType::imu && (n + 1) % instrument.every == 0;
}

void MeasuringSubsystem::observe(StepIndex n) noexcept {
  now_ = n;
  const bool is_read = std::any_of(instruments_.begin(), instruments_.end(),
                                   [&](const Instrument& instrument) { return is_read_at(instrument, n); });
  if (!is_read) return;
  physics_->read_variables(values_);
  for (Instrument& instrument : instruments_) {
    if (!is_read_at(instrument, n)) continue;
    const StepIndex k = n / instrument.every;
    const SampleFate fate = fate_of(instrument.def.sampling, instrument.fate, k);
    if (instrument.def.type == InstrumentType::imu) {
      observe_imu(instrument, n, fate);
    } else {
      const double T = H_.seconds() * static_cast<double>(instrument.every);
      instrument.channels[0].observe(k, values_[instrument.reads[0]], fate, instrument.def.value, T);
    }
  }
}

// equations (1) to (3) of instruments.h
void MeasuringSubsystem::observe_imu(Instrument& imu, StepIndex n, SampleFate fate) noexcept {
  double x[kImuReads];
  for (std::size_t i = 0; i < kImuReads; ++i) x[i] = values_[imu.reads[i]];
  const math::Mat3 R_W = math::rotation_of({x[3], x[4], x[5], x[6]});
  const math::Vec3 w_W(x[10], x[11], x[12]);
  const math::Vec3 v_P = math::Vec3(x[7], x[8], x[9]) + math::cross(w_W, R_W * math::Vec3(imu.def.point));
  const math::Vec3 a_P = n > 0 ? (v_P - imu.v_P) * (1 / H_.seconds()) : math::Vec3();
  imu.v_P = v_P;
  if (n % imu.every != 0) return;
  const math::Vec3 f_B = in_axes_of(R_W, a_P - gravity_()), w_B = in_axes_of(R_W, w_W);
  const StepIndex k = n / imu.every;
  const double T = H_.seconds() * static_cast<double>(imu.every);
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    ChannelParameters force = imu.def.value, rate = imu.def.rate;
    force.lowest = -force.highest, rate.lowest = -rate.highest, rate.drift_time = force.drift_time;
    force.offset = imu.def.acceleration_offset[i], rate.offset = imu.def.rate_offset[i];
    imu.channels[i].observe(k, f_B[axis], fate, force, T);
    imu.channels[3 + i].observe(k, w_B[axis], fate, rate, T);
  }
}

void MeasuringSubsystem::read_variables(std::span<double> values) const noexcept {
  physics_->read_variables(values.first(values_.size()));
  std::size_t i = values_.size();
  for (const Instrument& instrument : instruments_) {
    // the last sample that has arrived
    const StepIndex arrived = now_ - instrument.delay;
    const StepIndex k = arrived < 0 ? 0 : arrived / instrument.every;
    for (const Channel& channel : instrument.channels) values[i++] = channel.value(k);
    values[i++] = instrument.channels[0].is_valid(k) ? 1 : 0;
  }
}

bool MeasuringSubsystem::change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept {
  if (physics_->change_parameter(n, change)) return true;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (parameters_[i].path != change.path) continue;
    ramps_.begin(static_cast<int>(i), *parameters_[i].value, change.value, n, change.over, H_);
    return true;
  }
  return false;
}

void MeasuringSubsystem::reset() {
  physics_->reset();
  ramps_.clear();
  for (const LiveParameter& parameter : parameters_) *parameter.value = parameter.initial;
  for (Instrument& instrument : instruments_) {
    for (Channel& channel : instrument.channels) channel.reset();
    instrument.v_P = {};
  }
  now_ = 0;
}

// ---- saved state: that of the physics, the own one, the size of the own one -------------------------------------

template <typename Bytes, typename Self>
void MeasuringSubsystem::visit(Bytes& bytes, Self& self) {
  bytes.count(self.now_, kLastStep);
  for (const LiveParameter& parameter : self.parameters_) bytes.number(*parameter.value);
  for (auto& instrument : self.instruments_) {
    visit_vector(bytes, instrument.v_P);
    for (auto& channel : instrument.channels) Channel::visit(bytes, channel);
  }
}

void MeasuringSubsystem::save(std::vector<std::byte>& state) const {
  const std::size_t before = state.size();
  physics_->save(state);
  if (state.size() == before) return;  // it cannot be saved
  const std::size_t begin = state.size();
  StateWriter bytes(state, {kLayout, saved_model_});
  visit(bytes, *this);
  ramps_.save(bytes);
  bytes.finish();
  const std::uint64_t size = state.size() - begin;
  const auto* const first = reinterpret_cast<const std::byte*>(&size);
  state.insert(state.end(), first, first + sizeof size);
}

Status MeasuringSubsystem::load(std::span<const std::byte> state, coupling::OwnSample& sample) {
  reset();
  std::uint64_t size = 0;
  if (state.size() < sizeof size) return physics_->load(state, sample);
  std::memcpy(&size, state.data() + (state.size() - sizeof size), sizeof size);
  state = state.first(state.size() - sizeof size);
  const std::size_t own = size > state.size() ? 0 : static_cast<std::size_t>(size);
  if (Status status = physics_->load(state.first(state.size() - own), sample); !status.is_ok()) {
    reset();
    return status;
  }
  StateReader bytes(state.last(own), {kLayout, saved_model_});
  visit(bytes, *this);
  ramps_.load(bytes, [this](int handle) { return handle >= 0 && handle < static_cast<int>(parameters_.size()); });
  Status status = bytes.finish("measuring instruments");
  if (!status.is_ok()) reset();
  return status;
}

std::unique_ptr<coupling::Subsystem> with_instruments(std::unique_ptr<coupling::Subsystem> physics,
                                                      std::vector<InstrumentDef> instruments, SimDuration step,
                                                      Gravity gravity) {
  if (instruments.empty()) return physics;
  return std::make_unique<MeasuringSubsystem>(std::move(physics), std::move(instruments), step, std::move(gravity));
}

}  // namespace slew::measurement
