// SPDX-License-Identifier: Apache-2.0
// A physics subsystem with the instruments that measure its variables: the same samples and the same state hash as
// without, further variables, and the instruments' live parameters (docs/models/measurement.md).
//
// An instrument reads the variables of the published instant after each step. Its state (samples on their way, drift)
// is saved with the physics, and is no part of the hash: no force follows from it.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coupling/parameter_ramps.h"
#include "coupling/subsystem.h"
#include "math/vector3.h"
#include "measurement/instruments.h"

namespace slew::measurement {

// Present gravity of the physics [m/s2], Ground axes; called in a step.
using Gravity = std::function<math::Vec3()>;

class MeasuringSubsystem final : public coupling::Subsystem {
 public:
  // Throws Failure (bad_input): an instrument measures a variable that the physics does not have, or one of another
  // dimension than its type's. Pre-condition: validate() found nothing.
  MeasuringSubsystem(std::unique_ptr<coupling::Subsystem> physics, std::vector<InstrumentDef> instruments,
                     SimDuration step, Gravity gravity);

  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override { return physics_->state_hash(); }
  [[nodiscard]] Status can_save() const override { return physics_->can_save(); }
  void save(std::vector<std::byte>& state) const override;
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override;
  [[nodiscard]] coupling::Level level() const noexcept override { return physics_->level(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override;
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override {
    return physics_->offender_name(index);
  }
  [[nodiscard]] std::string_view failure_text() const noexcept override { return physics_->failure_text(); }
  [[nodiscard]] const coupling::Subsystem& physics() const noexcept override { return physics_->physics(); }

 private:
  struct Instrument {
    InstrumentDef def;
    StepIndex every = 1, delay = 0;  // steps
    std::vector<std::size_t> reads;  // variables of the physics
    ChannelNoise fate;               // of frozen and lost samples
    std::vector<Channel> channels;   // one, or specific force x, y, z and rates x, y, z
    math::Vec3 v_P{};                // imu: velocity of its point at the last instant read
  };
  struct LiveParameter {
    std::string path;
    double* value;
    double initial;
  };

  void add_instrument(InstrumentDef def, SimDuration step);
  void list_parameters();
  // Samples that are due at the instant of step n.
  void observe(StepIndex n) noexcept;
  void observe_imu(Instrument& imu, StepIndex n, SampleFate fate) noexcept;
  [[nodiscard]] bool is_read_at(const Instrument& instrument, StepIndex n) const noexcept;
  template <typename Bytes, typename Self>
  static void visit(Bytes& bytes, Self& self);

  std::unique_ptr<coupling::Subsystem> physics_;
  SimDuration H_;
  Gravity gravity_;
  std::vector<Instrument> instruments_;
  std::vector<LiveParameter> parameters_;
  coupling::ParameterRamps ramps_{0};
  std::vector<ElementVariable> variables_;  // those of the physics first
  std::vector<double> values_;              // of the physics, scratch
  StepIndex now_ = 0;                       // instant of the last samples
  std::uint64_t saved_model_ = 0;
};

// The physics with its instruments; the physics itself if there are none. As the constructor.
[[nodiscard]] std::unique_ptr<coupling::Subsystem> with_instruments(std::unique_ptr<coupling::Subsystem> physics,
                                                                    std::vector<InstrumentDef> instruments,
                                                                    SimDuration step, Gravity gravity);

}  // namespace slew::measurement
