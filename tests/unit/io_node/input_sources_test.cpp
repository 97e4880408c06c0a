// SPDX-License-Identifier: Apache-2.0
// Sources of raw values and timed changes, without a node.
#include "io_node/input_sources.h"

#include <gtest/gtest.h>

#include "io_node/scene_config.h"
#include "io_node/session_inputs.h"
#include "scene/scene.h"

namespace slew::io_node {
namespace input_sources_test {

constexpr SimDuration kStep = milliseconds(1);

// Constant raw values of some channels.
class Constant final : public InputSource {
 public:
  Constant(std::vector<std::string> names, double value, std::size_t pieces = 1)
      : names_(std::move(names)), value_(value), pieces_(pieces) {}
  [[nodiscard]] std::span<const std::string> channels() const noexcept override { return names_; }
  void read(std::size_t channel, SimTime, SimTime, SignalCourse& raw) const override {
    const double value = value_ + 0.01 * static_cast<double>(channel);
    raw.assign({{1, value, value}});
  }
  [[nodiscard]] std::size_t most_pieces(SimDuration) const noexcept override { return pieces_; }

 private:
  std::vector<std::string> names_;
  double value_;
  std::size_t pieces_;
};

std::vector<ChannelConfig> levers() {
  return {{.name = "Lift"}, {.name = "Slew"}, {.name = "Boom"}, {.name = "Horn"}};
}

std::vector<std::unique_ptr<InputSource>> two_sources() {
  std::vector<std::unique_ptr<InputSource>> sources;
  sources.push_back(std::make_unique<Constant>(std::vector<std::string>{"Boom", "Lift"}, 0.5, 3));
  sources.push_back(std::make_unique<Constant>(std::vector<std::string>{"Lift", "Slew"}, -0.5));
  return sources;
}

TEST(InputSources, AChannelTakesTheFirstSourceThatDrivesIt) {
  InputSources sources(two_sources(), levers(), kStep);
  const std::span<const SignalCourse> raw = sources.read({0}, {kStep.ns});
  ASSERT_EQ(raw.size(), 4u);
  EXPECT_EQ(raw[0].at(0).begin, 0.51);
  EXPECT_EQ(raw[1].at(0).begin, -0.49);
  EXPECT_EQ(raw[2].at(0).begin, 0.5);
  EXPECT_TRUE(raw[3].empty()) << "no source drives it";
  EXPECT_EQ(sources.most_pieces(), 3u);
}

TEST(InputSources, ASourceOfAnUnknownChannelIsAnError) {
  std::vector<std::unique_ptr<InputSource>> sources;
  sources.push_back(std::make_unique<Constant>(std::vector<std::string>{"Jib"}, 0));
  EXPECT_DEATH(InputSources(std::move(sources), levers(), kStep), "does not hold");
}

TEST(TimedChanges, BelongToTheStepInWhichTheyBegin) {
  const std::vector<TimedChange> changes = {{{0}, {}}, {{kStep.ns - 1}, {}}, {{kStep.ns}, {}}, {{kStep.ns}, {}}};
  EXPECT_EQ(changes_in(changes, {0}, {kStep.ns}).size(), 2u);
  EXPECT_EQ(changes_in(changes, {kStep.ns}, {2 * kStep.ns}).size(), 2u);
  EXPECT_TRUE(changes_in(changes, {2 * kStep.ns}, {3 * kStep.ns}).empty());
}

// step and time of each change in the ticks of 0.2 s
std::vector<std::pair<StepIndex, SimDuration>> changes_of_script(const std::string& step, const std::string& change) {
  IoConfig config = make_config(scene::load_text("session: {step: " + step +
                                                     ", duration: 0.3 s}\n"
                                                     "bodies:\n  Rod: {mass: 1 kg, inertia: [1, 1, 1]}\n"
                                                     "joints:\n  Hinge: {type: revolute, body2: Rod}\n"
                                                     "script: {parameters: [{set: Rod.mass, value: 2 kg, " +
                                                     change + "}]}\n",
                                                 "test"),
                                "test", Recording::none);
  const SimDuration H = config.session.step_duration();
  SessionInputs inputs(config, {});
  std::vector<std::pair<StepIndex, SimDuration>> found;
  std::vector<wire::Command> changes;
  for (StepIndex n = 0; start_of(n, H) < SimTime{} + milliseconds(200); ++n) {
    inputs.advance(n, 0, changes);
    for (const wire::Command& command : changes) found.emplace_back(n, SimDuration{command.over_ns});
  }
  return found;
}

TEST(SessionInputs, AChangeOfTheScriptActsFromTheFirstStepOnThatDoesNotBeginBeforeIt) {
  using Changes = std::vector<std::pair<StepIndex, SimDuration>>;
  EXPECT_EQ(changes_of_script("10 ms", "at: 0.109 s, over: 0 s"), (Changes{{11, {}}}));
  EXPECT_EQ(changes_of_script("1 ms", "at: 0.1009 s, over: 0 s"), (Changes{{101, {}}}));
  EXPECT_EQ(changes_of_script("1 ms", "at: 0.100000001 s, over: 0 s"), (Changes{{101, {}}}));
  // at the begin of a step
  EXPECT_EQ(changes_of_script("10 ms", "at: 0.11 s, over: 0 s"), (Changes{{11, {}}}));
  EXPECT_EQ(changes_of_script("0.7 ms", "at: 0.1981 s, over: 0 s"), (Changes{{283, {}}}));
}

TEST(SessionInputs, AChangeTakesTheNearestNumberOfSteps) {
  using Changes = std::vector<std::pair<StepIndex, SimDuration>>;
  EXPECT_EQ(changes_of_script("10 ms", "at: 0.1 s, over: 14 ms"), (Changes{{10, milliseconds(10)}}));
  EXPECT_EQ(changes_of_script("10 ms", "at: 0.1 s, over: 15 ms"), (Changes{{10, milliseconds(20)}}));
  EXPECT_EQ(changes_of_script("10 ms", "at: 0.1 s, over: 27 ms"), (Changes{{10, milliseconds(30)}}));
  EXPECT_EQ(changes_of_script("10 ms", "at: 0.1 s, over: 1 ms"), (Changes{{10, milliseconds(10)}}));
  // the time of the parameter itself
  EXPECT_EQ(changes_of_script("15 ms", "at: 0.09 s"), (Changes{{6, milliseconds(1005)}}));
}

TEST(SessionInputs, AHolderOfAChannelGoesBeforeItsSourceWhichGoesBeforeNeutral) {
  IoConfig config;
  config.channels = levers();
  SessionInputs inputs(config, two_sources());
  std::vector<wire::Command> changes;
  ASSERT_TRUE(inputs.gate().acquire(0, "joystick", 0).is_granted);
  ASSERT_TRUE(inputs.gate().write(0, "joystick", 0.9, 0, 0));
  inputs.advance(0, 0, changes);
  EXPECT_EQ(inputs.gate().control(0), 0.9);
  EXPECT_EQ(inputs.gate().control(1), -0.49);
  EXPECT_EQ(inputs.gate().control(3), 0);
  ASSERT_TRUE(inputs.gate().release(0, "joystick").is_granted);
  inputs.advance(1, 0, changes);
  EXPECT_EQ(inputs.gate().control(0), 0.51);
}

TEST(SessionInputs, ChangesBeyondTheLimitOfATickWaitForTheNextAndAreSaved) {
  IoConfig config;
  config.parameters = {{"Bag.mass", 1000}};
  const std::size_t count = wire::kMaxCommandsPerTick + 2;
  for (std::size_t i = 0; i < count; ++i) {
    config.changes.push_back({{0}, {0, "Bag.mass", 1000.0 + static_cast<double>(i), 0}});
  }
  SessionInputs inputs(config, {});
  std::vector<wire::Command> changes;
  inputs.advance(0, 0, changes);
  EXPECT_EQ(changes.size(), wire::kMaxCommandsPerTick);
  EXPECT_EQ(inputs.parameters().value(0), 1015);
  ASSERT_EQ(inputs.waiting().size(), 2u);
  node::Checkpoint saved;
  inputs.save(1, saved);
  inputs.reset();
  EXPECT_TRUE(inputs.waiting().empty());
  EXPECT_EQ(inputs.parameters().value(0), 1000);
  ASSERT_EQ(inputs.load(saved).text, "");
  EXPECT_EQ(inputs.parameters().value(0), 1015);
  inputs.advance(1, 0, changes);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[1].value, 1017);
  EXPECT_EQ(inputs.parameters().value(0), 1017);
}

TEST(SessionInputs, AStateOfOtherChannelsChangesNothing) {
  IoConfig config, other;
  config.channels = {{.name = "Lift"}};
  other.channels = {{.name = "Slew"}};
  node::Checkpoint saved;
  SessionInputs(other, {}).save(7, saved);
  SessionInputs inputs(config, {});
  inputs.add_change({1, "Bag.mass", 3, 0});
  const std::uint64_t hash = inputs.state_hash(7);
  EXPECT_EQ(inputs.load(saved).code, ExitCode::bad_input);
  EXPECT_EQ(inputs.state_hash(7), hash);
  EXPECT_EQ(inputs.waiting().size(), 1u);
}

}  // namespace input_sources_test
}  // namespace slew::io_node
