// SPDX-License-Identifier: Apache-2.0
#include "devices/stick.h"

#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <cmath>
#include <limits>

#include "core/allocation_guard.h"
#include "core/failure.h"

namespace slew::devices {
namespace stick_test {

// 24 bytes as a 64-bit kernel writes them
void add(std::vector<std::byte>& bytes, std::int64_t time_us, int type, int code, std::int32_t value) {
  const auto put = [&](std::uint64_t number, int size) {
    for (int i = 0; i < size; ++i, number >>= 8) bytes.push_back(static_cast<std::byte>(number & 0xFF));
  };
  put(static_cast<std::uint64_t>(time_us / 1'000'000), 8);
  put(static_cast<std::uint64_t>(time_us % 1'000'000), 8);
  put(static_cast<std::uint64_t>(type), 2);
  put(static_cast<std::uint64_t>(code), 2);
  put(static_cast<std::uint32_t>(value), 4);
}

StickDef two_axes() {
  return {.name = "Stick",
          .axes = {{.code = "ABS_X", .channel = 0, .lowest = 120, .centre = 512, .highest = 903},
                   {.code = "ABS_Y", .channel = 1, .lowest = 0, .centre = 0, .highest = 255, .invert = true}},
          .buttons = {{.code = "BTN_TRIGGER", .channel = 2}, {.code = "BTN_THUMB", .channel = 3, .invert = true}}};
}

struct Played {
  explicit Played(const StickDef& def = two_axes()) : stick(build_stick(def)), state(initial_state(stick)) {}
  void start() {
    connect(state);
    give_state(state, std::vector<std::int32_t>{512, 0}, std::vector<std::uint8_t>{0, 0});
  }
  bool take(std::initializer_list<std::array<int, 3>> list) {
    std::vector<std::byte> bytes;
    for (const auto& [type, code, value] : list) add(bytes, ++time, type, code, value);
    std::vector<InputEvent> events;
    EXPECT_EQ(read_events(bytes, events), bytes.size());
    const AllocationGuard guard;
    const bool has_report = take_events(stick, state, events);
    EXPECT_EQ(guard.allocations(), 0U);
    return has_report;
  }
  std::optional<double> axis(std::size_t i) { return axis_value(stick, state, i); }
  std::optional<bool> button(std::size_t i) { return button_value(stick, state, i); }
  Stick stick;
  StickState state;
  std::int64_t time = 0;
};

TEST(InputEvents, AreReadFromBytesInAnyPieces) {
  std::vector<std::byte> bytes;
  add(bytes, 1'700'000'000'123'456, EV_ABS, ABS_X, -32768);
  add(bytes, 1'700'000'000'123'457, EV_SYN, SYN_REPORT, 0);
  for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
    std::vector<InputEvent> events;
    std::vector<std::byte> kept;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      const std::size_t n = std::min(piece, bytes.size() - at);
      kept.insert(kept.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at + n));
      kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(read_events(kept, events)));
    }
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(events[0].time_us, 1'700'000'000'123'456);
    EXPECT_EQ(events[0].type, EV_ABS);
    EXPECT_EQ(events[0].code, ABS_X);
    EXPECT_EQ(events[0].value, -32768);
    EXPECT_EQ(events[1].type, EV_SYN);
  }
}

TEST(InputEvents, HaveTheNamesOfTheKernel) {
  EXPECT_EQ(axis_code("ABS_RZ"), 0x05);
  EXPECT_EQ(axis_code("ABS_THROTTLE"), 0x06);
  EXPECT_EQ(axis_code("ABS_HAT3Y"), 0x17);
  EXPECT_EQ(button_code("BTN_TRIGGER"), 0x120);
  EXPECT_EQ(button_code("BTN_SOUTH"), 0x130);
  EXPECT_EQ(button_code("BTN_TRIGGER_HAPPY1"), 0x2c0);
  EXPECT_EQ(button_code("BTN_TRIGGER_HAPPY40"), 0x2e7);
  for (const char* wrong : {"BTN_TRIGGER_HAPPY41", "BTN_TRIGGER_HAPPY0", "BTN_TRIGGER_HAPPY", "BTN_TRIGGER_HAPPY1x",
                            "BTN_TRIGGER_HAPPY-1", "btn_trigger", ""}) {
    EXPECT_FALSE(button_code(wrong).has_value()) << wrong;
  }
  EXPECT_FALSE(axis_code("BTN_TRIGGER").has_value());
}

TEST(StickAxis, ReachesItsEndsFromAnOffCentre) {
  const AxisDef axis = two_axes().axes[0];
  EXPECT_EQ(shape(axis, 512).value, 0);
  EXPECT_EQ(shape(axis, 903).value, 1);
  EXPECT_EQ(shape(axis, 120).value, -1);
  EXPECT_EQ(shape(axis, 316).value, -0.5);
  EXPECT_FALSE(shape(axis, 903).was_held);
  EXPECT_EQ(shape(axis, 904).value, 1);
  EXPECT_TRUE(shape(axis, 904).was_held);
  EXPECT_EQ(shape(axis, std::numeric_limits<std::int32_t>::min()).value, -1);
}

TEST(StickAxis, ADeadZoneAndACurveKeepEndsAndOrder) {
  AxisDef axis = {.code = "ABS_X", .lowest = -1000, .centre = 0, .highest = 1000, .dead_zone = 0.1, .expo = 0.6};
  EXPECT_EQ(shape(axis, 100).value, 0);
  EXPECT_NEAR(shape(axis, 101).value, 0.4 * (1.0 / 900), 1e-8);  // slope 1 - e, no jump
  EXPECT_EQ(shape(axis, 1000).value, 1);
  EXPECT_EQ(shape(axis, -1000).value, -1);
  const double y = (0.55 - 0.1) / 0.9;
  EXPECT_NEAR(shape(axis, 550).value, 0.4 * y + 0.6 * y * y * y, 1e-15);
  for (int raw = -1000; raw < 1000; ++raw) {
    EXPECT_LE(shape(axis, raw).value, shape(axis, raw + 1).value);
    EXPECT_EQ(shape(axis, raw).value, -shape(axis, -raw).value);
  }
  const double value = shape(axis, 550).value;
  axis.invert = true;
  EXPECT_EQ(shape(axis, 550).value, -value);
}

TEST(StickAxis, APedalHasOneSide) {
  const AxisDef low = {.code = "ABS_GAS", .lowest = 0, .centre = 0, .highest = 200};
  EXPECT_EQ(shape(low, 0).value, 0);
  EXPECT_EQ(shape(low, -5).value, 0);
  EXPECT_EQ(shape(low, 50).value, 0.25);
  const AxisDef high = {.code = "ABS_GAS", .lowest = 0, .centre = 200, .highest = 200, .invert = true};
  EXPECT_EQ(shape(high, 200).value, 0);
  EXPECT_EQ(shape(high, 0).value, 1);
}

TEST(Stick, MovesWithWholeReports) {
  Played played;
  played.start();
  EXPECT_FALSE(played.take({{EV_ABS, ABS_X, 903}, {EV_KEY, BTN_TRIGGER, 1}}));
  EXPECT_EQ(played.axis(0), 0);
  EXPECT_EQ(played.button(0), false);
  EXPECT_TRUE(played.take({{EV_MSC, MSC_SCAN, 9}, {EV_ABS, ABS_Z, 3}, {EV_SYN, SYN_REPORT, 0}}));
  EXPECT_EQ(played.axis(0), 1);
  EXPECT_EQ(played.button(0), true);
  EXPECT_EQ(played.button(1), true);  // closed at rest
  EXPECT_EQ(played.state.report_time_us, 5);
  EXPECT_TRUE(played.take({{EV_ABS, ABS_Y, 300}, {EV_KEY, BTN_TRIGGER, 2}, {EV_SYN, SYN_REPORT, 0}}));
  EXPECT_EQ(played.axis(1), -1);
  EXPECT_EQ(played.state.held, 1U);
  EXPECT_EQ(played.button(0), true);
}

TEST(Stick, HasNoValuesBeforeItsStateIsRead) {
  Played played;
  EXPECT_EQ(played.axis(0), 0);  // absent: neutral
  EXPECT_EQ(played.button(1), false);
  connect(played.state);
  EXPECT_FALSE(played.take({{EV_ABS, ABS_X, 903}, {EV_SYN, SYN_REPORT, 0}}));
  EXPECT_FALSE(played.axis(0).has_value());
  EXPECT_FALSE(played.button(0).has_value());
  give_state(played.state, std::vector<std::int32_t>{316, 255}, std::vector<std::uint8_t>{1, 1});
  EXPECT_EQ(played.axis(0), -0.5);
  EXPECT_EQ(played.axis(1), -1);
  EXPECT_EQ(played.button(0), true);
  EXPECT_EQ(played.button(1), false);
}

TEST(Stick, DropsWhatFollowsMissingEvents) {
  Played played;
  played.start();
  played.take({{EV_ABS, ABS_X, 903}, {EV_KEY, BTN_TRIGGER, 1}, {EV_SYN, SYN_REPORT, 0}});
  EXPECT_EQ(played.axis(0), 1);
  // the report after SYN_DROPPED is a torn one
  EXPECT_FALSE(played.take({{EV_ABS, ABS_X, 316},
                            {EV_SYN, SYN_DROPPED, 0},
                            {EV_ABS, ABS_Y, 255},
                            {EV_SYN, SYN_REPORT, 0},
                            {EV_ABS, ABS_X, 903},
                            {EV_SYN, SYN_REPORT, 0}}));
  EXPECT_EQ(played.state.phase, StickPhase::awaiting_state);
  EXPECT_FALSE(played.axis(0).has_value());
  EXPECT_FALSE(played.button(0).has_value());
  EXPECT_EQ(played.state.dropped, 1U);
  give_state(played.state, std::vector<std::int32_t>{512, 0}, std::vector<std::uint8_t>{0, 0});
  EXPECT_EQ(played.axis(0), 0);
  EXPECT_EQ(played.button(0), false);
  // nothing of the unfinished report from before comes back
  played.take({{EV_SYN, SYN_REPORT, 0}});
  EXPECT_EQ(played.axis(0), 0);
}

TEST(Stick, IsNeutralWhenItsDeviceLeaves) {
  Played played;
  played.start();
  played.take({{EV_ABS, ABS_X, 903}, {EV_ABS, ABS_Y, 255}, {EV_KEY, BTN_TRIGGER, 1}, {EV_SYN, SYN_REPORT, 0}});
  disconnect(played.state);
  EXPECT_EQ(played.axis(0), 0);
  EXPECT_EQ(played.axis(1), 0);
  EXPECT_EQ(played.button(0), false);
  EXPECT_EQ(played.button(1), false);  // also the one that is closed at rest
  played.take({{EV_SYN, SYN_DROPPED, 0}, {EV_ABS, ABS_X, 903}, {EV_SYN, SYN_REPORT, 0}});
  EXPECT_EQ(played.axis(0), 0);
  connect(played.state);
  EXPECT_FALSE(played.axis(0).has_value());
}

TEST(Stick, RefusesWrongDefinitions) {
  const auto with = [](auto change) {
    StickDef def = two_axes();
    change(def);
    Problems problems;
    validate(def, problems);
    return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_EQ(with([](auto& d) { d.axes[0].code = "ABS_Q"; }), "Stick.axes.ABS_Q.code: there is no axis 'ABS_Q'");
  EXPECT_EQ(with([](auto& d) { d.axes[0].centre = 1000; }), "Stick.axes.ABS_X.centre: 120, 1000, 903 are not in order");
  EXPECT_EQ(with([](auto& d) { d.axes[1].highest = 0; }), "Stick.axes.ABS_Y.centre: 0, 0, 0 are not in order");
  EXPECT_EQ(with([](auto& d) { d.axes[0].lowest = -3'000'000'000; }),
            "Stick.axes.ABS_X.lowest: -3e+09 is out of range");
  EXPECT_EQ(with([](auto& d) { d.axes[0].dead_zone = 1; }), "Stick.axes.ABS_X.dead_zone: 1 is out of range");
  EXPECT_EQ(with([](auto& d) { d.axes[0].expo = 1.1; }), "Stick.axes.ABS_X.expo: 1.1 is out of range");
  EXPECT_EQ(with([](auto& d) { d.axes[0].channel = 64; }), "Stick.axes.ABS_X.channel: 64 is out of range");
  EXPECT_EQ(with([](auto& d) { d.axes[1].channel = 0; }),
            "Stick.axes.ABS_Y: the code or the channel is used twice in the device");
  EXPECT_EQ(with([](auto& d) { d.buttons[0].channel = 1; }),
            "Stick.buttons.BTN_TRIGGER: the code or the channel is used twice in the device");
  EXPECT_EQ(with([](auto& d) { d.buttons[1].code = "BTN_TRIGER"; }),
            "Stick.buttons.BTN_TRIGER.code: there is no button 'BTN_TRIGER'");
  EXPECT_EQ(with([](auto& d) { d.buttons[1].channel = -1; }), "Stick.buttons.BTN_THUMB.channel: -1 is out of range");
  EXPECT_EQ(with([](auto& d) { d.axes.clear(), d.buttons.clear(); }), "Stick: the device has neither axes nor buttons");
  EXPECT_THROW(static_cast<void>(build_stick({.name = "Empty"})), Failure);
}

}  // namespace stick_test
}  // namespace slew::devices
