// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "devices/analog_output.h"
#include "devices/enable_chain.h"
#include "devices/output_condition.h"

namespace slew::devices {
namespace outputs_test {

constexpr double kStep = 0.01;

std::string problem_of(auto def) {
  Problems problems;
  validate(def, problems);
  return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
}

TEST(Condition, HasThreeParts) {
  Problems problems;
  const auto text = parse_condition("Lamp.when", " Vol_MainPump.pressure>=250 bar ", problems);
  ASSERT_TRUE(text.has_value());
  EXPECT_EQ(text->variable, "Vol_MainPump.pressure");
  EXPECT_EQ(text->comparison, Comparison::at_least);
  EXPECT_EQ(text->quantity, "250 bar");
  EXPECT_EQ(parse_condition("", "a < -1e3", problems)->comparison, Comparison::below);
  EXPECT_EQ(parse_condition("", "a <= 1", problems)->comparison, Comparison::at_most);
  EXPECT_EQ(parse_condition("", "a > 1", problems)->comparison, Comparison::above);
  EXPECT_TRUE(problems.empty());
  for (const char* wrong : {"", "a", "a >", "> 1", "a b > 1", "a == 1", "a > 1 > 2", "a != 1", "a >> 1", "a = 1"}) {
    problems.clear();
    EXPECT_FALSE(parse_condition("Lamp.when", wrong, problems).has_value()) << wrong;
    ASSERT_EQ(problems.size(), 1U) << wrong;
    EXPECT_EQ(problems[0].what, "'" + std::string(wrong) + "' is no condition");
  }
}

// states of the output over a course of values
std::string lamp(const SwitchedOutputDef& def, const std::vector<double>& values, bool lit = false) {
  SwitchedOutputState state;
  std::string text;
  bool was_on = false;
  for (const double value : values) {
    const bool has_changed = step(def, value, kStep, state);
    EXPECT_EQ(has_changed, state.is_on != was_on);
    was_on = state.is_on;
    text += (lit ? state.is_lit : state.is_on) ? '1' : '0';
  }
  return text;
}

TEST(SwitchedOutput, HasAHysteresis) {
  const std::vector<double> values = {9, 10, 10.5, 10, 9.5, 9, 8.9, 9.5, 10, 10.1};
  EXPECT_EQ(lamp({.name = "L", .comparison = Comparison::above, .threshold = 10, .hysteresis = 1}, values),
            "0011110001");
  EXPECT_EQ(lamp({.name = "L", .comparison = Comparison::at_least, .threshold = 10, .hysteresis = 1}, values),
            "0111110011");
  EXPECT_EQ(lamp({.name = "L", .comparison = Comparison::above, .threshold = 10}, values), "0010000001");
  std::vector<double> mirrored;
  for (const double value : values) mirrored.push_back(20 - value);
  EXPECT_EQ(lamp({.name = "L", .comparison = Comparison::below, .threshold = 10, .hysteresis = 1}, mirrored),
            "0011110001");
  EXPECT_EQ(lamp({.name = "L", .comparison = Comparison::at_most, .threshold = 10, .hysteresis = 1}, mirrored),
            "0111110011");
}

TEST(SwitchedOutput, StaysOnForItsLeastTimeAndGoesOnAfterItsDelay) {
  const std::vector<double> peak = {0, 2, 0, 0, 0, 0, 0};
  EXPECT_EQ(lamp({.name = "L", .threshold = 1, .least_on = 0.035}, peak), "0111100");
  EXPECT_EQ(lamp({.name = "L", .threshold = 1, .delay = 0.025}, {2, 2, 0, 2, 2, 2, 2, 0}), "00000010");
}

// sums of 0.01 s miss 0.06 s and others by their rounding
TEST(SwitchedOutput, TimesOfWholeStepsAreExact) {
  const std::vector<double> on(64, 2), peak = [] {
    std::vector<double> values(64);
    values[0] = 2;
    return values;
  }();
  for (int steps = 0; steps < 60; ++steps) {
    const auto n = static_cast<std::size_t>(steps);
    const double time = steps * kStep;
    EXPECT_EQ(lamp({.name = "L", .threshold = 1, .delay = time}, on).find('1'), n);
    if (steps > 0) {
      EXPECT_EQ(lamp({.name = "L", .threshold = 1, .least_on = time}, peak).find('0'), n);
      EXPECT_EQ(lamp({.name = "L", .threshold = 1, .pulse_on = time, .pulse_off = 1}, on, true).find('0'), n);
    }
  }
}

TEST(SwitchedOutput, Pulses) {
  const SwitchedOutputDef def = {.name = "L", .threshold = 1, .pulse_on = 0.02, .pulse_off = 0.03};
  EXPECT_EQ(lamp(def, {0, 2, 2, 2, 2, 2, 2, 2, 2, 0}, true), "0110001100");
  EXPECT_EQ(lamp(def, {0, 2, 2, 2, 2, 2, 2, 2, 2, 0}), "0111111110");
}

TEST(SwitchedOutput, AnUnknownValueChangesNothing) {
  const SwitchedOutputDef def = {.name = "L", .threshold = 1};
  SwitchedOutputState state;
  step(def, 2, kStep, state);
  EXPECT_TRUE(state.is_on);
  EXPECT_TRUE(state.is_known);
  step(def, NAN, kStep, state);
  EXPECT_TRUE(state.is_on);
  EXPECT_FALSE(state.is_known);
  step(def, 0, kStep, state);
  EXPECT_FALSE(state.is_on);
  step(def, INFINITY, kStep, state);
  EXPECT_FALSE(state.is_on);
  EXPECT_EQ(state.changes, 2U);
}

TEST(SwitchedOutput, RefusesWrongDefinitions) {
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L"}), "");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .threshold = NAN}), "L.threshold: nan is no threshold");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .hysteresis = -1}), "L.hysteresis: -1 is out of range");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .delay = -1}), "L.delay: -1 is out of range");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .least_on = 3601}), "L.least_on: 3601 is out of range");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .pulse_on = 1}), "L.pulse_on: a pulse with one part only");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .pulse_on = -1, .pulse_off = 1}),
            "L.pulse_on: -1 is out of range");
  EXPECT_EQ(problem_of(SwitchedOutputDef{.name = "L", .pulse_on = 1, .pulse_off = -1}),
            "L.pulse_off: -1 is out of range");
}

TEST(AnalogOutput, ScalesAndHoldsAtItsEnds) {
  const AnalogOutputDef def = {.name = "G", .low = 0, .high = 25e6, .low_output = 4, .high_output = 20};  // mA
  AnalogOutputState state;
  EXPECT_EQ(step(def, 12.5e6, kStep, state), 12);
  EXPECT_EQ(step(def, 30e6, kStep, state), 20);
  EXPECT_EQ(step(def, -1, kStep, state), 4);
  EXPECT_EQ(state.held, 2U);
  EXPECT_EQ(step(def, NAN, kStep, state), 4);
  EXPECT_FALSE(state.is_known);
  AnalogOutputState fresh;
  EXPECT_EQ(step(def, NAN, kStep, fresh), 4);  // nothing known yet: the low end
  const AnalogOutputDef falling = {.name = "G", .low = 10, .high = 0, .low_output = -5, .high_output = 5};
  EXPECT_EQ(step(falling, 2.5, kStep, fresh), 2.5);
}

TEST(AnalogOutput, FollowsAStepAsAnExponential) {
  const AnalogOutputDef def = {.name = "G", .low = 0, .high = 1, .low_output = 0, .high_output = 10, .smoothing = 0.3};
  for (const double h : {0.001, 0.01, 0.5}) {
    AnalogOutputState state;
    EXPECT_EQ(step(def, 0, h, state), 0);
    for (int n = 1; n < 100; ++n) EXPECT_NEAR(step(def, 1, h, state), 10 * (1 - std::exp(-n * h / 0.3)), 1e-12);
  }
}

TEST(AnalogOutput, RefusesWrongDefinitions) {
  EXPECT_EQ(problem_of(AnalogOutputDef{.name = "G"}), "");
  EXPECT_EQ(problem_of(AnalogOutputDef{.name = "G", .low = 1}), "G.high: low 1 and high 1 span no range");
  EXPECT_EQ(problem_of(AnalogOutputDef{.name = "G", .low = NAN}), "G.high: low nan and high 1 span no range");
  EXPECT_EQ(problem_of(AnalogOutputDef{.name = "G", .low_output = NAN}), "G.low_output: nan is out of range");
  EXPECT_EQ(problem_of(AnalogOutputDef{.name = "G", .high_output = NAN}), "G.high_output: nan is out of range");
  EXPECT_EQ(problem_of(AnalogOutputDef{.name = "G", .smoothing = -1}), "G.smoothing: -1 is out of range");
}

struct Chain {
  EnableChainDef def = {.name = "Chain",
                        .dead_man = "Stick.BTN_TRIGGER",
                        .devices = {"Stick", "Platform"},
                        .conditions = {"Platform is parked"}};
  std::array<double, 2> ages{};
  std::array<std::optional<bool>, 1> conditions{true};
  double axis = 0;
  EnableState state;

  EnablePhase take(std::optional<bool> dead_man) {
    static_cast<void>(
        step(def, {.dead_man = dead_man, .device_ages = ages, .conditions = conditions, .farthest_axis = axis}, state));
    return state.phase;
  }
  std::string text() { return text_of(def, state); }
};

TEST(EnableChain, EnablesOnANewPressAlone) {
  Chain chain;
  EXPECT_EQ(chain.take(true), EnablePhase::blocked);  // held since before
  EXPECT_EQ(chain.text(), "release Stick.BTN_TRIGGER, then press it");
  EXPECT_EQ(chain.take(false), EnablePhase::ready);
  EXPECT_EQ(chain.text(), "press Stick.BTN_TRIGGER");
  EXPECT_EQ(chain.take(true), EnablePhase::enabled);
  EXPECT_TRUE(chain.state.is_enabled());
  EXPECT_EQ(chain.text(), "enabled");
  EXPECT_EQ(chain.take(true), EnablePhase::enabled);
  EXPECT_EQ(chain.take(false), EnablePhase::blocked);
  EXPECT_EQ(chain.state.losses, 1U);
}

// Enabled, then one step with a loss: it enables after a release and a new press alone.
void lose(const std::function<void(Chain&)>& loss, std::optional<bool> dead_man, const std::string& text) {
  Chain chain;
  chain.take(false);
  ASSERT_EQ(chain.take(true), EnablePhase::enabled);
  loss(chain);
  EXPECT_EQ(chain.take(dead_man), EnablePhase::blocked) << text;
  EXPECT_EQ(chain.text(), text);
  EXPECT_EQ(chain.state.losses, 1U);
}

TEST(EnableChain, AnyLossBlocks) {
  const auto none = [](Chain&) {};
  lose([](Chain& c) { c.ages[1] = 0.21; }, true, "device Platform is silent for more than 0.2 s");
  lose([](Chain& c) { c.ages[0] = NAN; }, true, "device Stick is silent for more than 0.2 s");
  lose([](Chain& c) { c.conditions[0] = false; }, true, "not met: Platform is parked");
  lose([](Chain& c) { c.conditions[0].reset(); }, true, "not met: Platform is parked");
  lose(none, false, "press Stick.BTN_TRIGGER");
  lose(none, std::optional<bool>(), "press Stick.BTN_TRIGGER");
}

TEST(EnableChain, ALossIsOverAfterAReleaseAndANewPressAlone) {
  Chain chain;
  chain.take(false);
  ASSERT_EQ(chain.take(true), EnablePhase::enabled);
  chain.ages[0] = 1;
  EXPECT_EQ(chain.take(true), EnablePhase::blocked);
  chain.ages[0] = 0.2;
  EXPECT_EQ(chain.take(true), EnablePhase::blocked);
  EXPECT_EQ(chain.take(true), EnablePhase::blocked);
  EXPECT_EQ(chain.take(false), EnablePhase::ready);
  EXPECT_EQ(chain.take(true), EnablePhase::enabled);
}

TEST(EnableChain, WaitsForNeutralSticks) {
  for (const double axis : {0.06, 1.0, static_cast<double>(NAN)}) {
    Chain chain;
    chain.take(false);
    chain.axis = axis;
    EXPECT_EQ(chain.take(true), EnablePhase::ready);
    EXPECT_EQ(chain.text(), "an axis is not at neutral");
    chain.axis = 0.05;
    EXPECT_EQ(chain.take(true), EnablePhase::enabled);
    chain.axis = 1;  // once enabled the stick moves
    EXPECT_EQ(chain.take(true), EnablePhase::enabled);
  }
}

TEST(EnableChain, RefusesWrongDefinitions) {
  EXPECT_EQ(problem_of(Chain().def), "");
  EXPECT_EQ(problem_of(EnableChainDef{.name = "C"}), "C.dead_man: the text is missing");
  EXPECT_EQ(problem_of(EnableChainDef{.name = "C", .dead_man = "a", .device_timeout = 0}),
            "C.device_timeout: 0 is out of range");
  EXPECT_EQ(problem_of(EnableChainDef{.name = "C", .dead_man = "a", .neutral_band = 1}),
            "C.neutral_band: 1 is out of range");
}

}  // namespace outputs_test
}  // namespace slew::devices
