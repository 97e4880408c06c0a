// SPDX-License-Identifier: Apache-2.0
#include "devices/can_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "build_paths.h"
#include "core/allocation_guard.h"
#include "devices/can_frame.h"
#include "devices/dbc.h"
#include "outside_program.h"
#include "support/temporary_folder.h"

namespace slew::devices {
namespace can_test {

using testing::has_program;
using testing::ProgramResult;
using testing::run_shell;

constexpr const char* kMachine = SLEWRING_SOURCE_DIR "/tests/unit/devices/machine.dbc";

CanDatabase machine() {
  Problems problems;
  CanDatabase database = load_dbc(kMachine, problems);
  EXPECT_TRUE(problems.empty()) << problems[0].path << ": " << problems[0].what;
  return database;
}

std::vector<std::byte> bytes_of(std::initializer_list<int> numbers) {
  std::vector<std::byte> bytes;
  for (const int number : numbers) bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += "0123456789abcdef"[std::to_integer<int>(byte) >> 4];
    text += "0123456789abcdef"[std::to_integer<int>(byte) & 15];
  }
  return text;
}

SignalValue value_in(const CanMessage& message, const std::vector<std::byte>& frame, const char* name,
                     ReservedCodes codes = ReservedCodes::none) {
  std::vector<SignalValue> values(message.signals.size());
  EXPECT_TRUE(decode(message, frame, codes, values));
  return values[*find_signal(message, name)];
}

// problems of a text as "line: what"
std::vector<std::string> problems_of(const std::string& text) {
  Problems problems;
  static_cast<void>(read_dbc(text, "f", problems));
  std::vector<std::string> texts;
  for (const Problem& problem : problems) texts.push_back(problem.path.substr(2) + ": " + problem.what);
  return texts;
}
std::string only_problem_of(const std::string& text) {
  const auto texts = problems_of(text);
  return texts.size() == 1 ? texts[0] : std::to_string(texts.size()) + " problems";
}

TEST(Dbc, HasMessagesSignalsAndSkippedSections) {
  const CanDatabase database = machine();
  ASSERT_EQ(database.messages.size(), 5U);
  const CanMessage* plain = find_message(database, "Plain");
  ASSERT_NE(plain, nullptr);
  EXPECT_EQ(plain->id, 100U);
  EXPECT_FALSE(plain->is_extended);
  ASSERT_EQ(plain->signals.size(), 5U);
  const CanSignal& flow = plain->signals[2];
  EXPECT_EQ(flow.name, "Motorola12");
  EXPECT_EQ(flow.start_bit, 39U);
  EXPECT_EQ(flow.bits, 12U);
  EXPECT_EQ(flow.order, ByteOrder::big);
  EXPECT_EQ(flow.scale, 0.1);
  EXPECT_EQ(flow.highest, 409.5);
  EXPECT_EQ(flow.unit, "l/min");
  EXPECT_EQ(plain->signals[3].unit, "°C");
  const CanMessage* engine = find_message(database, 0xCF004FE, true);
  ASSERT_NE(engine, nullptr);
  EXPECT_EQ(engine->name, "EEC1");
  EXPECT_EQ(find_message(database, 0xCF004FE, false), nullptr);
  EXPECT_EQ(find_message(database, "Floats")->signals[1].number, CanNumber::float64);
  EXPECT_EQ(find_message(database, "Selected")->signals[3].selected_by.size(), 2U);
  EXPECT_EQ(database.skipped, (std::map<std::string, int, std::less<>>{{"BA_", 1},
                                                                       {"BA_DEF_", 1},
                                                                       {"BO_TX_BU_", 1},
                                                                       {"CM_", 2},
                                                                       {"VAL_", 1},
                                                                       {"VAL_TABLE_", 1},
                                                                       {"VECTOR__INDEPENDENT_SIG_MSG", 1}}));
}

TEST(Dbc, TextsOfWindowsAreRead) {
  Problems problems;
  const CanDatabase database = read_dbc(
      "BO_ 1 A: 8 N\r\n SG_ T : 0|8@1+ (1,0) [0|0] \"\xB0"
      "C \x80\" N\r\n",
      "f", problems);
  ASSERT_EQ(database.messages.size(), 1U);
  EXPECT_EQ(database.messages[0].signals[0].unit, "°C €");
}

TEST(Dbc, ProblemsHaveTheirLine) {
  const std::string begin = "VERSION \"\"\nBO_ 1 A: 2 N\n";
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 9|8@1+ (1,0) [0|0] \"\" N\n"),
            "3: A.S: its bits are not within the 2 bytes of the message");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|10@0+ (1,0) [0|0] \"\" N\n"),
            "3: A.S: its bits are not within the 2 bytes of the message");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@1+ (0,0) [0|0] \"\" N\n"), "3: A.S: factor 0, offset 0");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@1+ (1,0) [5|1] \"\" N\n"), "3: A.S: range 5 to 1");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|0@1+ (1,0) [0|0] \"\" N\n"), "3: A.S: it has 0 bits");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@2+ (1,0) [0|0] \"\" N\n"), "3: byte order 2");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@1 (1,0) [0|0] \"\" N\n"), "3: no sign");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@1+ (1e999,0) [0|0] \"\" N\n"),
            "3: '1e999' is out of range or malformed");
  EXPECT_EQ(only_problem_of(begin + " SG_ S 0|8@1+ (1,0) [0|0] \"\" N\n"), "3: '0' is not expected here");
  EXPECT_EQ(only_problem_of(begin + " SG_ S X : 0|8@1+ (1,0) [0|0] \"\" N\n"), "3: 'X' is no multiplexing");
  EXPECT_EQ(only_problem_of(begin + " SG_ S m0M : 0|8@1+ (1,0) [0|0] \"\" N\n"),
            "3: 'm0M' is a multiplexer below another one");
  EXPECT_EQ(only_problem_of(begin + " SG_ S m0 : 0|8@1+ (1,0) [0|0] \"\" N\n"),
            "2: A: signals are multiplexed, but there is no multiplexer M");
  EXPECT_EQ(only_problem_of(begin + " SG_ S M : 0|8@1+ (1,0) [0|0] \"\" N\n SG_ T M : 8|8@1+ (1,0) [0|0] \"\" N\n"),
            "2: A: the message has two multiplexers");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n SG_ S : 8|8@1+ (1,0) [0|0] \"\" N\n"),
            "3: A.S: the name is used twice in the message");
  EXPECT_EQ(only_problem_of(begin + " SG_ S : 0|8@1+ (1,0) [0|0] \"\nN\n"), "3: a text without its closing quote");
  EXPECT_EQ(only_problem_of(begin + "BO_ 1 B: 2 N\n"), "3: message B: its number or its name is used twice");
  EXPECT_EQ(only_problem_of(begin + "BO_ 2048 B: 2 N\n"), "3: B: 0x800 is too large");
  EXPECT_EQ(only_problem_of(begin + "CM_ \"no end\"\nBO_ 2 B: 2 N\n"), "3: section CM_ has no end");
  EXPECT_EQ(only_problem_of(begin + "CM_ \"no end\""), "3: section CM_ has no end");
  EXPECT_EQ(only_problem_of(begin + "BO_ 2 B: 2\n"), "4: the file ends within a statement");
  EXPECT_EQ(only_problem_of("SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n"), "1: a signal without a message");
  EXPECT_EQ(only_problem_of(begin + "SIG_VALTYPE_ 1 S : 1;\n"), "3: message 1 has no signal 'S'");
  const std::string one = begin + " SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n";
  EXPECT_EQ(only_problem_of(one), "0 problems");
  EXPECT_EQ(only_problem_of(one + "SIG_VALTYPE_ 1 S : 1;\n"), "3: A.S: a float of 8 bits");
  EXPECT_EQ(only_problem_of(one + "SIG_VALTYPE_ 1 S : 3;\n"), "4: value type 3");
  EXPECT_EQ(only_problem_of(one + "SG_MUL_VAL_ 1 S S 3-1;\n"), "4: a range that ends before its begin");
  EXPECT_EQ(only_problem_of(one + "SG_MUL_VAL_ 1 S S 1-3;\n"), "4: 'S' is no multiplexer M");
  EXPECT_EQ(only_problem_of("\x01\x02"), "1: '\\x01' is not expected here");
}

TEST(Dbc, OneProblemDoesNotHideTheNextAndManyEnd) {
  const std::string text =
      "BO_ 1 A: x N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\nBO_ 2 B: 1 N\n SG_ S : 0|9@1+ (1,0) [0|0] \"\" N\n"
      "BO_ 3 C: 1 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n";
  EXPECT_EQ(problems_of(text),
            (std::vector<std::string>{"1: 'x' is not expected here",
                                      "4: B.S: its bits are not within the 1 bytes of the message"}));
  Problems problems;
  const CanDatabase database = read_dbc(text, "f", problems);
  ASSERT_EQ(database.messages.size(), 1U);
  EXPECT_EQ(database.messages[0].name, "C");
  std::string many;
  for (int i = 0; i < 50; ++i) many += "BO_ x\n";
  EXPECT_EQ(problems_of(many).size(), 20U);
}

TEST(Dbc, AnyDamageIsAProblemOrAMessage) {
  Problems problems;
  std::string bytes = slew::testing::TemporaryFolder("dbc").read(kMachine);
  ASSERT_GT(bytes.size(), 1000U);
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = bytes.substr(0, random() % 3 == 0 ? random() % bytes.size() : bytes.size());
    for (int k = 0; k < 3 && !damaged.empty(); ++k)
      damaged[random() % damaged.size()] = static_cast<char>(random() & 0xFF);
    problems.clear();
    const CanDatabase database = read_dbc(damaged, "f", problems);
    EXPECT_LE(problems.size(), 20U);
    for (const CanMessage& message : database.messages) {
      std::vector<std::byte> frame(message.bytes, std::byte{0xA5});
      std::vector<SignalValue> values(message.signals.size());
      EXPECT_TRUE(decode(message, frame, ReservedCodes::j1939, values));
    }
  }
}

TEST(Dbc, AFileThatIsNotThereIsAProblem) {
  Problems problems;
  static_cast<void>(load_dbc("/nonexistent/machine.dbc", problems));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].path, "/nonexistent/machine.dbc");
}

// frames of every message in the peer's text, and the values that both have
void compare_with_peer(const std::string& option) {
  CanDatabase database = machine();
  const slew::testing::TemporaryFolder folder("dbc_peer" + option);
  std::mt19937 random(7);
  std::string lines;
  std::vector<std::pair<const CanMessage*, std::vector<std::byte>>> frames;
  for (CanMessage& message : database.messages) {
    for (CanSignal& signal : message.signals) signal.lowest = signal.highest = 0;  // the peers have no ranges
    for (int i = 0; i < 60; ++i) {
      std::vector<std::byte> frame(message.bytes);
      for (std::byte& byte : frame) byte = static_cast<std::byte>(random() & 0xFF);
      if (message.name == "Selected") frame[0] = static_cast<std::byte>(i % 11);
      lines += std::to_string(message.is_extended ? message.id | 0x80000000U : message.id) + " " + hex(frame) + "\n";
      frames.emplace_back(&message, frame);
    }
  }
  const std::string input = folder.write("frames", lines);
  const ProgramResult peer = run_shell("python3 " SLEWRING_SOURCE_DIR "/tests/unit/devices/dbc_peer.py " +
                                       std::string(kMachine) + " " + option + " < " + input);
  if (peer.exit_code == 77) GTEST_SKIP() << "python3 has no cantools";
  ASSERT_EQ(peer.exit_code, 0);
  std::istringstream output(peer.output);
  int compared = 0;
  for (const auto& [message, frame] : frames) {
    std::string line, word;
    ASSERT_TRUE(std::getline(output, line));
    if (line == "unknown-choice") continue;
    std::map<std::string, double> theirs;
    for (std::istringstream words(line); words >> word;) {
      theirs[word.substr(0, word.find('='))] = std::strtod(word.c_str() + word.find('=') + 1, nullptr);
    }
    std::vector<SignalValue> values(message->signals.size());
    ASSERT_TRUE(decode(*message, frame, ReservedCodes::none, values));
    std::size_t present = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::string& name = message->signals[i].name;
      if (values[i].state == SignalState::not_selected) {
        EXPECT_FALSE(theirs.contains(name)) << name << " " << line;
        continue;
      }
      ++present;
      ASSERT_TRUE(theirs.contains(name)) << name << " " << line;
      if (values[i].state == SignalState::not_finite) {
        EXPECT_FALSE(std::isfinite(theirs[name]));
      } else {
        EXPECT_DOUBLE_EQ(values[i].value, theirs[name]) << name << " " << hex(frame);
        ++compared;
      }
    }
    EXPECT_EQ(present, theirs.size()) << line;
  }
  EXPECT_GT(compared, 600);
}

TEST(CanPeer, WholeNumbersOfPythonAgree) {
  if (!has_program("python3")) GTEST_SKIP() << "there is no python3";
  compare_with_peer("");
}

TEST(CanPeer, CantoolsAgrees) {
  if (!has_program("python3")) GTEST_SKIP() << "there is no python3";
  compare_with_peer("--cantools");
}

TEST(CanMessage, IsTheSameAfterEncodeAndDecode) {
  CanDatabase database = machine();
  std::mt19937 random(11);
  for (CanMessage& message : database.messages) {
    for (CanSignal& signal : message.signals) signal.lowest = signal.highest = 0;
    if (message.name == "Longs") continue;  // of 64 bits: rounded, see below
    for (int i = 0; i < 200; ++i) {
      std::vector<std::byte> frame(message.bytes), again(message.bytes);
      for (std::byte& byte : frame) byte = static_cast<std::byte>(random() & 0xFF);
      std::vector<SignalValue> values(message.signals.size()), values_again(message.signals.size());
      ASSERT_TRUE(decode(message, frame, ReservedCodes::none, values));
      std::vector<double> numbers;
      bool is_finite = true;
      for (const SignalValue& value : values) {
        numbers.push_back(value.value);
        is_finite = is_finite && value.state != SignalState::not_finite;
      }
      if (!is_finite) continue;
      const AllocationGuard guard;
      const EncodeResult result = encode(message, numbers, ReservedCodes::none, again);
      EXPECT_EQ(guard.allocations(), 0U);
      ASSERT_EQ(result.fault, EncodeFault::none) << message.name;
      EXPECT_EQ(result.held, 0U);
      ASSERT_TRUE(decode(message, again, ReservedCodes::none, values_again));
      for (std::size_t k = 0; k < values.size(); ++k) {
        EXPECT_EQ(values[k].state, values_again[k].state);
        if (values[k].state == SignalState::valid) {
          EXPECT_EQ(raw_bits(message.signals[k], frame), raw_bits(message.signals[k], again))
              << message.signals[k].name;
        }
      }
    }
  }
}

TEST(CanMessage, LeavesOtherBitsAndSignalsOfOtherChoicesAlone) {
  const CanDatabase database = machine();
  const CanMessage& selected = *find_message(database, "Selected");
  std::vector<std::byte> frame(8);
  const EncodeResult result =
      encode(selected, std::vector<double>{1, 5, -2, 3, 255}, ReservedCodes::none, frame);  // Choice 1: Torque
  EXPECT_EQ(result.fault, EncodeFault::none);
  // -2 from bit 8 down: the sign in byte 1, eight ones in byte 2, 1111110 at the top of byte 3
  EXPECT_EQ(hex(frame), "0101fffc000000ff");
}

TEST(CanMessage, HoldsValuesAtBoundsAndRefusesWhatIsNotFinite) {
  const CanMessage message = {.name = "M",
                              .bytes = 12,
                              .signals = {{.name = "a", .start_bit = 0, .bits = 8, .is_signed = true},
                                          {.name = "b", .start_bit = 8, .bits = 8, .lowest = 10, .highest = 20},
                                          {.name = "c", .start_bit = 16, .bits = 64}}};
  std::vector<std::byte> frame(12);
  EncodeResult result = encode(message, std::vector<double>{-1000, 1000, 1e30}, ReservedCodes::none, frame);
  EXPECT_EQ(result.held, 3U);
  EXPECT_EQ(hex(frame), "801400f8ffffffffffff0000");
  result = encode(message, std::vector<double>{0, NAN, 0}, ReservedCodes::none, frame);
  EXPECT_EQ(result.fault, EncodeFault::not_finite);
  EXPECT_EQ(result.signal, 1U);
  EXPECT_EQ(encode(message, std::vector<double>{0, 15, INFINITY}, ReservedCodes::j1939, frame).fault,
            EncodeFault::not_finite);
}

TEST(CanMessage, WithSharedBitsIsRefusedForSending) {
  const auto overlaps = [](const CanMessage& message) {
    Problems problems;
    check_overlaps(message.name, message, problems);
    std::vector<std::string> texts;
    for (const Problem& problem : problems) texts.push_back(problem.path + ": " + problem.what);
    return texts;
  };
  for (const CanMessage& message : machine().messages) EXPECT_TRUE(overlaps(message).empty()) << message.name;
  // an Intel one of byte 0 and 1, and a Motorola one whose last bit is bit 8
  CanMessage message = {.name = "M",
                        .signals = {{.name = "a", .start_bit = 0, .bits = 9},
                                    {.name = "b", .start_bit = 15, .bits = 8, .order = ByteOrder::big},
                                    {.name = "c", .start_bit = 23, .bits = 8, .order = ByteOrder::big}}};
  EXPECT_EQ(overlaps(message), std::vector<std::string>{"M.b: it shares bits with a"});
  message.signals[0].bits = 8;
  EXPECT_TRUE(overlaps(message).empty());
  message.signals[0].bits = 9;
  message.signals[0].selected_by = {{0, 2}};
  message.signals[1].selected_by = {{3, 4}};
  EXPECT_TRUE(overlaps(message).empty());
  message.signals[1].selected_by = {{2, 4}};
  EXPECT_EQ(overlaps(message).size(), 1U);
}

TEST(CanMessage, AValueOutOfRangeIsNone) {
  const CanMessage message = {
      .name = "M", .signals = {{.name = "a", .start_bit = 0, .bits = 8, .scale = 0.1, .lowest = 0.1, .highest = 0.3}}};
  EXPECT_EQ(value_in(message, bytes_of({3, 0, 0, 0, 0, 0, 0, 0}), "a").state,
            SignalState::valid);  // 0.30000000000000004
  EXPECT_EQ(value_in(message, bytes_of({4, 0, 0, 0, 0, 0, 0, 0}), "a").state, SignalState::out_of_range);
  EXPECT_EQ(value_in(message, bytes_of({0, 0, 0, 0, 0, 0, 0, 0}), "a").state, SignalState::out_of_range);
  EXPECT_TRUE(std::isnan(value_in(message, bytes_of({4, 0, 0, 0, 0, 0, 0, 0}), "a").value));
}

TEST(CanMessage, ShortFramesAreRefusedLongerOnesAreRead) {
  const CanDatabase database = machine();
  const CanMessage& plain = *find_message(database, "Plain");
  std::vector<SignalValue> values(plain.signals.size());
  EXPECT_FALSE(decode(plain, std::vector<std::byte>(7), ReservedCodes::none, values));
  EXPECT_TRUE(decode(plain, std::vector<std::byte>(12), ReservedCodes::none, values));
}

TEST(CanLog, LinesOfCandumpAreRead) {
  const auto logged = parse_candump("(1700000000.250000) can0 18F00400#0102FF");
  ASSERT_TRUE(logged);
  EXPECT_EQ(logged->time_us, 1'700'000'000'250'000);
  EXPECT_TRUE(logged->frame.is_extended);
  EXPECT_EQ(logged->frame.id, 0x18F00400u);
  ASSERT_EQ(logged->frame.size, 3u);
  EXPECT_EQ(logged->frame.bytes[2], std::byte{0xFF});
  EXPECT_EQ(parse_candump("(1.000000) vcan0 123##10102")->frame.size, 2u);
  EXPECT_EQ(parse_candump("(1.000000) vcan0 123#\r\n")->frame.size, 0u);
  for (const char* line :
       {"", "(1.000000) can0 123#R", "(1.000000) can0 123#0", "(1.000000) can0 1234#00", "(1.000000) can0 800#00",
        "(1.0) can0 123#00", "(1.000000) can0", "1.000000 can0 123#00", "(1.000000) can0 123#001122334455667788",
        "(1.000000) can0 123#0g", "(99999999999999.000000) can0 123#00", "(-1.000000) can0 123#00"})
    EXPECT_FALSE(parse_candump(line)) << line;
}

// remote and error frames are skipped; no other line without a frame is
TEST(CanLog, FramesWithoutDataAreNoDamagedLines) {
  EXPECT_EQ(parse_candump("(1.000000) can0 123#11 R")->frame.size, 1u);
  for (const char* line : {"(1.000000) can0 123#R", "(1.000000) can0 123#R8", "(1.000000) can0 18F00400#R",
                           "(1.000000) can0 20000004#0004000000000000", "(1.000000) can0 123#R T\r\n"}) {
    EXPECT_TRUE(is_logged_without_data(line)) << line;
    EXPECT_FALSE(parse_candump(line)) << line;
  }
  for (const char* line :
       {"(1.000000) can0 1#00", "(1.000000) can0 12#00", "(1.000000) can0 1234#00", "(1.000000) can0 1234567#00",
        "(1.000000) can0 800#00", "(1.000000) can0 123#001", "(1.000000) can0 123#001122334455667788",
        "(1.000000) can0 40000000#00", "(1.000000) can0 20000004#004", "(1.000000) can0 123#R9",
        "(1.000000) can0 800#R", "(1.000000) can0 1234#R", "", "# a comment"}) {
    EXPECT_FALSE(is_logged_without_data(line)) << line;
    EXPECT_FALSE(parse_candump(line)) << line;
  }
}

TEST(Dbc, WhatIsWrittenReadsBackToTheSame) {
  Problems problems;
  const CanDatabase machine = load_dbc(kMachine, problems);
  ASSERT_TRUE(problems.empty()) << problems[0].what;
  ASSERT_GE(machine.messages.size(), 5u);
  const CanDatabase again = read_dbc(write_dbc(machine.messages), "again", problems);
  EXPECT_TRUE(problems.empty()) << problems[0].path << ": " << problems[0].what;
  EXPECT_EQ(again.messages, machine.messages);
}

}  // namespace can_test
}  // namespace slew::devices
