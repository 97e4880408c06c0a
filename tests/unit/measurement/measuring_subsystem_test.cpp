// SPDX-License-Identifier: Apache-2.0
// Sampling, delay, live faults and saved state of instruments over a physics whose variable is the number of its step.
#include "measurement/measuring_subsystem.h"

#include <gtest/gtest.h>

#include "core/allocation_guard.h"
#include "core/failure.h"

namespace slew::measurement {
namespace measuring_subsystem_test {

// "Tank.pressure" is the number of the step whose sample is published.
class Counter final : public coupling::Subsystem {
 public:
  bool first_sample(coupling::OwnSample&) noexcept override { return true; }
  Status start(const coupling::PartnerSamples&, coupling::OwnSample&) override { return Status::ok(); }
  StepReport step(StepIndex n, const coupling::PartnerSamples&, std::span<const double>,
                  coupling::OwnSample&) noexcept override {
    n_ = n + 1;
    return {};
  }
  bool change_parameter(StepIndex, const coupling::ParameterChange&) noexcept override { return false; }
  void reset() override { n_ = 0; }
  [[nodiscard]] std::uint64_t state_hash() const noexcept override { return static_cast<std::uint64_t>(n_); }
  [[nodiscard]] Status can_save() const override { return Status::ok(); }
  void save(std::vector<std::byte>& state) const override {
    StateWriter bytes(state, {1, 1});
    bytes.number(n_);
    bytes.finish();
  }
  Status load(std::span<const std::byte> state, coupling::OwnSample&) override {
    StateReader bytes(state, {1, 1});
    bytes.number(n_);
    return bytes.finish("counter");
  }
  [[nodiscard]] coupling::Level level() const noexcept override { return {}; }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override { values[0] = static_cast<double>(n_); }
  [[nodiscard]] std::string_view offender_name(std::int32_t) const noexcept override { return {}; }

 private:
  StepIndex n_ = 0;
  std::vector<ElementVariable> variables_{{"Tank.pressure", Dimension::pressure}};
};

InstrumentDef transducer() {
  InstrumentDef def;
  def.name = "Sensor", def.variable = "Tank.pressure";
  def.value.lowest = -1e9, def.value.highest = 1e9;
  return def;
}

class MeasuredRun {
 public:
  explicit MeasuredRun(const InstrumentDef& def) : subsystem(std::make_unique<Counter>(), {def}, milliseconds(1), {}) {
    EXPECT_TRUE(subsystem.start({}, sample_).is_ok());
  }
  void to(StepIndex n) {
    while (n_ < n) subsystem.step(n_++, {}, {}, sample_);
  }
  // value and is_valid of the instrument
  [[nodiscard]] std::pair<double, bool> shown() const {
    std::array<double, 3> values{};
    subsystem.read_variables(values);
    return {values[1], values[2] == 1};
  }
  [[nodiscard]] double value() const { return shown().first; }
  void set(const char* path, double value) { ASSERT_TRUE(subsystem.change_parameter(n_, {path, value, {}})) << path; }
  void go_on_from(const MeasuredRun& other) {
    std::vector<std::byte> state;
    other.subsystem.save(state);
    ASSERT_TRUE(subsystem.load(state, sample_).is_ok());
    n_ = other.n_;
  }
  MeasuringSubsystem subsystem;

 private:
  coupling::OwnSample sample_;
  StepIndex n_ = 0;
};

TEST(MeasuringSubsystem, shows_the_physics_and_its_instruments_after_it) {
  MeasuredRun run(transducer());
  run.to(7);
  ASSERT_EQ(run.subsystem.variables().size(), 3U);
  EXPECT_EQ(run.subsystem.variables()[0].name, "Tank.pressure");
  EXPECT_EQ(run.subsystem.variables()[1].name, "Sensor.value");
  EXPECT_EQ(run.subsystem.variables()[2].name, "Sensor.is_valid");
  EXPECT_EQ(run.subsystem.variables()[1].dimension, Dimension::pressure);
  EXPECT_EQ(run.shown(), (std::pair{7.0, true}));
  EXPECT_EQ(run.subsystem.state_hash(), 7U);  // that of the physics
}

// Samples at 0, 4, 8, ... ms, each shown 6 ms later; the first one before.
TEST(MeasuringSubsystem, samples_at_its_interval_and_shows_after_its_delay) {
  InstrumentDef def = transducer();
  def.sampling.sample_time = 4e-3, def.sampling.delay = 6e-3;
  MeasuredRun run(def);
  for (StepIndex n = 0; n < 60; ++n) {
    run.to(n);
    const double sampled = n < 6 ? 0 : static_cast<double>((n - 6) / 4 * 4);
    EXPECT_EQ(run.value(), sampled) << n;
  }
}

TEST(MeasuringSubsystem, takes_faults_as_live_parameters) {
  MeasuredRun run(transducer());
  run.to(10);
  run.set("Sensor.offset", 100);
  run.to(11);
  EXPECT_EQ(run.value(), 111);
  run.set("Sensor.offset", 0);
  run.set("Sensor.frozen", 1);
  run.to(30);
  EXPECT_EQ(run.shown(), (std::pair{111.0, true}));
  run.set("Sensor.frozen", 0);
  run.set("Sensor.dropout", 1);
  run.to(40);
  EXPECT_EQ(run.shown(), (std::pair{111.0, false}));
  run.set("Sensor.dropout", 0);
  run.to(41);
  EXPECT_EQ(run.shown(), (std::pair{41.0, true}));
  run.set("Sensor.drift", 3600);  // in an hour: 1 in a second
  run.to(141);
  EXPECT_NEAR(run.value(), 141.1, 1e-9);
  EXPECT_FALSE(run.subsystem.change_parameter(141, {"Sensor.resolution", 1, {}}));
}

InstrumentDef noisy() {
  InstrumentDef def = transducer();
  def.value.noise = 3, def.value.drift = 50, def.value.drift_time = 1;
  def.sampling = {.sample_time = 3e-3, .delay = 7e-3, .seed = 4, .frozen = 0.2, .dropout = 0.2};
  return def;
}

TEST(MeasuringSubsystem, goes_on_from_a_saved_state_with_the_same_bits) {
  for (const StepIndex at : {0, 1, 50, 200}) {
    MeasuredRun run(noisy()), other(noisy());
    run.to(at / 2);
    ASSERT_TRUE(run.subsystem.change_parameter(at / 2, {"Sensor.gain", 2, milliseconds(400)}));
    run.to(at);
    other.to(33);
    ASSERT_NO_FATAL_FAILURE(other.go_on_from(run));
    for (StepIndex n = at; n < at + 300; ++n) {
      ASSERT_EQ(run.shown(), other.shown()) << n;
      run.to(n + 1), other.to(n + 1);
    }
  }
}

TEST(MeasuringSubsystem, refuses_a_saved_state_with_any_bit_changed) {
  MeasuredRun run(noisy());
  run.to(20);
  std::vector<std::byte> state;
  run.subsystem.save(state);
  coupling::OwnSample sample;
  MeasuredRun fresh(noisy());
  for (std::size_t i = 0; i < state.size(); ++i) {
    std::vector<std::byte> damaged = state;
    damaged[i] ^= std::byte{1};
    ASSERT_FALSE(fresh.subsystem.load(damaged, sample).is_ok()) << i;
    damaged.resize(i);
    ASSERT_FALSE(fresh.subsystem.load(damaged, sample).is_ok()) << i;
  }
  EXPECT_TRUE(fresh.subsystem.load(state, sample).is_ok());
}

TEST(MeasuringSubsystem, begins_again_after_a_reset) {
  MeasuredRun run(noisy());
  std::vector<std::pair<double, bool>> first;
  for (StepIndex n = 1; n <= 50; ++n) run.to(n), first.push_back(run.shown());
  run.set("Sensor.offset", 7);
  run.to(60);
  run.subsystem.reset();
  coupling::OwnSample sample;
  ASSERT_TRUE(run.subsystem.start({}, sample).is_ok());
  for (StepIndex n = 1; n <= 50; ++n) {
    run.subsystem.step(n - 1, {}, {}, sample);
    ASSERT_EQ(run.shown(), first[static_cast<std::size_t>(n - 1)]) << n;
  }
}

TEST(MeasuringSubsystem, of_other_names_or_seeds_has_other_noise) {
  InstrumentDef def = transducer(), renamed = def, reseeded = def;
  for (InstrumentDef* one : {&def, &renamed, &reseeded}) one->value.noise = 1;
  renamed.name = "Other", reseeded.sampling.seed = 1;
  MeasuredRun run(def), other(renamed), third(reseeded);
  for (MeasuredRun* one : {&run, &other, &third}) one->to(5);
  EXPECT_NE(run.value(), other.value());
  EXPECT_NE(run.value(), third.value());
}

TEST(MeasuringSubsystem, steps_without_allocation) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  MeasuredRun run(noisy());
  run.to(10);
  const AllocationGuard guard;
  run.to(50);
  EXPECT_EQ(guard.allocations(), 0U);
}

void expect_refused(const InstrumentDef& def, const std::string& part) {
  try {
    const MeasuredRun run(def);
    FAIL() << "accepted";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(failure.what()).find(part), std::string::npos) << failure.what();
  }
}

TEST(MeasuringSubsystem, refuses_a_variable_that_is_missing_or_of_another_dimension) {
  InstrumentDef def = transducer();
  def.variable = "Tank.presure";
  expect_refused(def, "did you mean 'Tank.pressure'?");
  def = transducer();
  def.type = InstrumentType::force;
  expect_refused(def, "'Tank.pressure' is in Pa, its type measures N");
}

TEST(Instruments, with_a_range_or_times_that_do_not_fit_are_refused) {
  InstrumentDef def = transducer();
  def.value.highest = def.value.lowest;
  def.sampling.sample_time = 2.5e-3, def.sampling.delay = 1e-4;
  Problems problems;
  validate(std::span(&def, 1), milliseconds(1), problems);
  ASSERT_EQ(problems.size(), 3U);
  EXPECT_EQ(problems[0].path, "Sensor.sample_time");
  EXPECT_EQ(problems[1].path, "Sensor.delay");
  EXPECT_EQ(problems[2].path, "Sensor.highest");
}

}  // namespace measuring_subsystem_test
}  // namespace slew::measurement
