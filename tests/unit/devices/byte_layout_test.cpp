// SPDX-License-Identifier: Apache-2.0
#include "devices/byte_layout.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <sstream>

#include "build_paths.h"
#include "core/allocation_guard.h"
#include "core/failure.h"
#include "devices/layout_header.h"
#include "devices/packet.h"
#include "outside_program.h"
#include "support/temporary_folder.h"

namespace slew::devices {
namespace byte_layout_test {

using testing::has_program;
using testing::ProgramResult;
using testing::run_shell;

// the layout of layout_peer.py
LayoutDef peer_layout(ByteOrder order, std::int64_t packing) {
  return {.name = "Packet",
          .byte_order = order,
          .packing = packing,
          .fields = {{.name = "is_on", .type = ByteType::boolean},
                     {.name = "count", .type = ByteType::uint16, .role = FieldRole::sequence},
                     {.name = "level", .type = ByteType::int8},
                     {.name = "total", .type = ByteType::uint32},
                     {.name = "lift", .type = ByteType::float32},
                     {.name = "far", .type = ByteType::int64},
                     {.name = "small", .type = ByteType::int16, .scale = 0.25, .offset = -3, .unit = "bar"},
                     {.name = "pressure", .type = ByteType::float64},
                     {.name = "lamps", .type = ByteType::uint16},
                     {.name = "lamp_oil", .of = "lamps", .bit = 0},
                     {.name = "gear", .of = "lamps", .bit = 9, .bits = 3},
                     {.name = "check", .type = ByteType::uint32, .role = FieldRole::crc32}}};
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

std::vector<std::byte> from_hex(const std::string& text) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> numbers;
  for (double number = 0; in >> number;) numbers.push_back(number);
  return numbers;
}

std::string problem_of(const LayoutDef& def) {
  Problems problems;
  validate(def, problems);
  return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
}

std::string peer(const std::string& arguments) {
  return "python3 " SLEWRING_SOURCE_DIR "/tests/unit/devices/layout_peer.py " + arguments;
}

class LayoutPeer : public ::testing::TestWithParam<std::tuple<ByteOrder, int>> {
 protected:
  void SetUp() override {
    if (!has_program("python3")) GTEST_SKIP() << "there is no python3";
  }
  ByteOrder order = std::get<0>(GetParam());
  int packing = std::get<1>(GetParam());
  std::string names = std::string(kByteOrderNames[static_cast<std::size_t>(order)]) + " " + std::to_string(packing);
};

TEST_P(LayoutPeer, ReadsWhatIsSent) {
  const ByteLayout layout = build(peer_layout(order, packing));
  const std::vector<double> values = {1, -100, 4e9, 0.1, -9007199254740991, 47.25, 2.5e7, 1, 5};
  std::vector<std::byte> packet(layout.size);
  PacketState state;
  state.sequence = 65535;
  ASSERT_EQ(encode(layout, values, state, packet), PacketFault::none);
  EXPECT_EQ(state.counts.held, 0U);

  const ProgramResult read = run_shell(peer(names + " unpack " + hex(packet)));
  ASSERT_EQ(read.exit_code, 0) << read.output;  // the checksum too
  const std::vector<double> numbers = numbers_of(read.output);
  ASSERT_EQ(numbers.size(), 21U) << read.output;
  EXPECT_EQ(numbers[0], static_cast<double>(layout.size));
  std::size_t at = 1;
  for (const PlacedField& field : layout.fields) {
    if (field.def.of.empty()) {
      EXPECT_EQ(numbers[at++], static_cast<double>(field.byte)) << field.def.name;
    }
  }
  const std::vector<double> raw(numbers.begin() + 11, numbers.begin() + 20);
  EXPECT_EQ(raw, (std::vector<double>{1, 65535, -100, 4e9, static_cast<double>(0.1F), -9007199254740991, 201, 2.5e7,
                                      1 + (5 << 9)}));
  if (packing == 1) {
    const std::string order_name(kByteOrderNames[static_cast<std::size_t>(order)]);
    const ProgramResult by_struct = run_shell(peer("struct " + order_name + " " + hex(packet)));
    const std::vector<double> all = numbers_of(by_struct.output);
    EXPECT_EQ(std::vector<double>(all.begin(), all.begin() + 9), raw) << by_struct.output;
  }
}

TEST_P(LayoutPeer, SendsWhatIsRead) {
  const ByteLayout layout = build(peer_layout(order, packing));
  const ProgramResult sent = run_shell(peer(names + " pack 1 7 -128 4294967295 -0.5 123456789012 -32768 1e-300 2561"));
  ASSERT_EQ(sent.exit_code, 0) << sent.output;
  std::vector<double> values(layout.values.size());
  PacketState state;
  ASSERT_EQ(decode(layout, from_hex(sent.output), state, values), PacketFault::none) << sent.output;
  EXPECT_EQ(state.sequence, 7U);
  EXPECT_EQ(values, (std::vector<double>{1, -128, 4294967295, -0.5, 123456789012, -8195, 1e-300, 1, 5}));
}

INSTANTIATE_TEST_SUITE_P(OrdersAndPackings, LayoutPeer,
                         ::testing::Combine(::testing::Values(ByteOrder::little, ByteOrder::big),
                                            ::testing::Values(1, 4, 8)));

TEST(PacketChecksum, OfTheCatalogueAndOfPython) {
  std::vector<std::byte> digits;
  for (const char c : std::string("123456789")) digits.push_back(static_cast<std::byte>(c));
  const auto sum = [](Checksum kind, std::span<const std::byte> bytes) {
    return checksum_of(kind, bytes.first(bytes.size() / 3), bytes.subspan(bytes.size() / 3));
  };
  EXPECT_EQ(sum(Checksum::sum8, digits), 0xDDU);
  EXPECT_EQ(sum(Checksum::xor8, digits), 0x31U);
  EXPECT_EQ(sum(Checksum::crc16_ccitt, digits), 0x29B1U);
  EXPECT_EQ(sum(Checksum::crc32, digits), 0xCBF43926U);
  if (!has_program("python3")) GTEST_SKIP() << "there is no python3";
  std::mt19937 random(3);
  std::vector<std::byte> bytes(200);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 0xFF);
  const std::vector<double> theirs = numbers_of(run_shell(peer("sums " + hex(bytes))).output);
  EXPECT_EQ(theirs, (std::vector<double>{static_cast<double>(sum(Checksum::sum8, bytes)),
                                         static_cast<double>(sum(Checksum::xor8, bytes)),
                                         static_cast<double>(sum(Checksum::crc16_ccitt, bytes)),
                                         static_cast<double>(sum(Checksum::crc32, bytes))}));
}

// sequence, one float, sum8 behind them
LayoutDef small_layout() {
  return {.name = "Small",
          .fields = {{.name = "n", .type = ByteType::uint8, .role = FieldRole::sequence},
                     {.name = "x", .type = ByteType::float32},
                     {.name = "sum", .type = ByteType::uint8, .role = FieldRole::sum8}}};
}

std::vector<std::byte> small_packet(int n, float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  std::vector<std::byte> packet =
      bytes_of({n & 0xFF, static_cast<int>(bits & 0xFF), static_cast<int>((bits >> 8) & 0xFF),
                static_cast<int>((bits >> 16) & 0xFF), static_cast<int>(bits >> 24), 0});
  int sum = 0;
  for (const std::byte byte : packet) sum += std::to_integer<int>(byte);
  packet[5] = static_cast<std::byte>(sum & 0xFF);
  return packet;
}

struct Receiver {
  explicit Receiver(const LayoutDef& def) : layout(build(def)), values(layout.values.size(), -7) {}
  PacketFault take(const std::vector<std::byte>& packet) { return decode(layout, packet, state, values); }
  ByteLayout layout;
  PacketState state;
  std::vector<double> values;
};

TEST(Packet, IsRefusedAndCountedByItsCause) {
  Receiver receiver(small_layout());
  std::vector<std::byte> packet = small_packet(1, 2);
  packet.pop_back();
  EXPECT_EQ(receiver.take(packet), PacketFault::too_short);
  EXPECT_EQ(receiver.take({}), PacketFault::too_short);
  packet = small_packet(1, 2);
  packet.push_back(std::byte{0});
  EXPECT_EQ(receiver.take(packet), PacketFault::too_long);
  for (std::size_t byte = 0; byte < 6; ++byte) {
    packet = small_packet(1, 2);
    packet[byte] ^= std::byte{0x10};
    EXPECT_EQ(receiver.take(packet), PacketFault::bad_checksum);
  }
  EXPECT_EQ(receiver.take(small_packet(1, NAN)), PacketFault::not_finite);
  EXPECT_EQ(receiver.take(small_packet(2, INFINITY)), PacketFault::not_finite);
  EXPECT_EQ(receiver.values[0], -7);  // no refused packet leaves a trace
  EXPECT_EQ(receiver.take(small_packet(3, 2.5F)), PacketFault::none);
  EXPECT_EQ(receiver.values[0], 2.5);
  EXPECT_EQ(receiver.take(small_packet(3, 4)), PacketFault::repeated);
  EXPECT_EQ(receiver.values[0], 2.5);
  const PacketCounts& counts = receiver.state.counts;
  EXPECT_EQ(counts.used, 1U);
  EXPECT_EQ(counts.of(PacketFault::too_short), 2U);
  EXPECT_EQ(counts.of(PacketFault::too_long), 1U);
  EXPECT_EQ(counts.of(PacketFault::bad_checksum), 6U);
  EXPECT_EQ(counts.of(PacketFault::not_finite), 2U);
  EXPECT_EQ(counts.of(PacketFault::repeated), 1U);
  EXPECT_EQ(counts.of(PacketFault::out_of_sequence), 0U);
}

TEST(Packet, AfterLostOnesIsUsedUpToTheirLimit) {
  LayoutDef def = small_layout();
  def.most_lost = 2;
  Receiver receiver(def);
  EXPECT_EQ(receiver.take(small_packet(254, 0)), PacketFault::none);
  EXPECT_EQ(receiver.take(small_packet(1, 1)), PacketFault::none);  // 255 and 0 are lost
  EXPECT_EQ(receiver.state.counts.lost, 2U);
  EXPECT_EQ(receiver.take(small_packet(5, 2)), PacketFault::out_of_sequence);  // 2 to 4
  EXPECT_EQ(receiver.values[0], 1);
  EXPECT_EQ(receiver.state.counts.jumps, 0U);
  EXPECT_EQ(receiver.take(small_packet(6, 3)), PacketFault::none);  // the sequence goes on from the refused one
  EXPECT_EQ(receiver.state.counts.lost, 2U);
  EXPECT_EQ(receiver.state.counts.jumps, 1U);  // a loss without a number is stated
}

TEST(Packet, ThatIsLateIsRefusedAndASenderThatStartsAgainIsUsed) {
  Receiver receiver(small_layout());
  for (int n = 100; n < 103; ++n) EXPECT_EQ(receiver.take(small_packet(n, 0)), PacketFault::none);
  EXPECT_EQ(receiver.take(small_packet(104, 0)), PacketFault::out_of_sequence);
  EXPECT_EQ(receiver.take(small_packet(103, 0)), PacketFault::none);
  EXPECT_EQ(receiver.take(small_packet(104, 0)), PacketFault::none);
  EXPECT_EQ(receiver.take(small_packet(99, 0)), PacketFault::out_of_sequence);  // late
  EXPECT_EQ(receiver.take(small_packet(105, 0)), PacketFault::none);
  EXPECT_EQ(receiver.take(small_packet(0, 0)), PacketFault::out_of_sequence);  // a new sender
  EXPECT_EQ(receiver.take(small_packet(1, 9)), PacketFault::none);
  EXPECT_EQ(receiver.values[0], 9);
}

TEST(Packet, HoldsSentValuesAtTheirBounds) {
  const ByteLayout layout = build({.name = "Held",
                                   .fields = {{.name = "a", .type = ByteType::int8, .scale = 0.5},
                                              {.name = "b", .type = ByteType::uint64},
                                              {.name = "c", .type = ByteType::int64},
                                              {.name = "d", .type = ByteType::float32},
                                              {.name = "e", .type = ByteType::uint16, .lowest = 10, .highest = 20},
                                              {.name = "word", .type = ByteType::int16},
                                              {.name = "nibble", .of = "word", .bit = 4, .bits = 4}}});
  const auto round_trip = [&](std::vector<double> values, std::uint64_t held) {
    PacketState state, reader;
    std::vector<std::byte> packet(layout.size);
    EXPECT_EQ(encode(layout, values, state, packet), PacketFault::none);
    EXPECT_EQ(state.counts.held, held);
    EXPECT_EQ(decode(layout, packet, reader, values), PacketFault::none);
    return values;
  };
  EXPECT_EQ(round_trip({1e9, 1e30, 1e30, 1e300, 99, 99}, 6),
            (std::vector<double>{63.5, std::nextafter(0x1p64, 0), std::nextafter(0x1p63, 0), 0x1.fffffep127, 20, 7}));
  EXPECT_EQ(round_trip({-1e9, -1, -1e30, -1e300, -99, -99}, 6),
            (std::vector<double>{-64, 0, -0x1p63, -0x1.fffffep127, 10, -8}));
  EXPECT_EQ(round_trip({0.75, 2.5, -3.5, 0.5, 10.5, -1}, 0), (std::vector<double>{1, 2, -4, 0.5, 10, -1}));
}

TEST(Packet, IsNotSentWithAValueThatIsNotFinite) {
  const ByteLayout layout = build(small_layout());
  PacketState state;
  std::vector<std::byte> packet(layout.size);
  EXPECT_EQ(encode(layout, std::vector<double>{NAN}, state, packet), PacketFault::not_finite);
  EXPECT_EQ(encode(layout, std::vector<double>{-INFINITY}, state, packet), PacketFault::not_finite);
  EXPECT_EQ(state.counts.of(PacketFault::not_finite), 2U);
  EXPECT_EQ(state.sequence, 0U);  // the sequence has no gap from it
  EXPECT_EQ(encode(layout, std::vector<double>{1}, state, packet), PacketFault::none);
  EXPECT_EQ(packet, small_packet(0, 1));
}

TEST(Packet, TakesAnyBytesWithoutAllocation) {
  const ByteLayout layout = build(peer_layout(ByteOrder::big, 4));
  std::vector<double> values(layout.values.size());
  std::vector<std::byte> packet(2 * layout.size);
  PacketState state;
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    for (std::byte& byte : packet) byte = static_cast<std::byte>(random() & 0xFF);
    const std::size_t size = random() % 4 == 0 ? random() % packet.size() : layout.size;
    const std::span<std::byte> bytes(packet.data(), size);
    if (size == layout.size && i % 2 == 0) {  // past the checksum
      const std::size_t at = layout.fields[*layout.checksum].byte;
      const std::uint32_t sum = checksum_of(Checksum::crc32, bytes.first(at), bytes.subspan(at + 4));
      for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::byte>((sum >> (24 - 8 * k)) & 0xFF);
    }
    const AllocationGuard guard;
    static_cast<void>(decode(layout, bytes, state, values));
    EXPECT_EQ(guard.allocations(), 0U);
    for (const double value : values) ASSERT_TRUE(std::isfinite(value));
  }
  EXPECT_GT(state.counts.of(PacketFault::out_of_sequence), 0U);
}

TEST(Layout, TheCompilerAgreesWithTheHeader) {
  if (!has_program("cc")) GTEST_SKIP() << "there is no C compiler";
  const slew::testing::TemporaryFolder folder("layout_header");
  std::string program;
  for (const ByteOrder order : {ByteOrder::little, ByteOrder::big}) {
    for (const int packing : {1, 4, 8}) {
      LayoutDef def = peer_layout(order, packing);
      def.name = std::string("Packet_") + (order == ByteOrder::big ? "big_" : "little_") + std::to_string(packing);
      for (const int size : {0, 64}) {
        def.size = size;
        if (size != 0) def.name += "_padded";
        const ByteLayout layout = build(def);
        folder.write(def.name + ".h", c_header(layout));
        program += "#include \"" + def.name + ".h\"\n";
      }
    }
  }
  program += "int main(void) { return PACKET_BIG_8_LAMP_OIL_SHIFT + (PACKET_LITTLE_1_GEAR_MASK != 7); }\n";
  folder.write("layouts.c", program);
  const std::string path = folder.path();
  const std::string flags = " -Wall -Wextra -Werror -Wpedantic -o " + path + "/layouts ";
  const ProgramResult c = run_shell("cc -std=c11" + flags + path + "/layouts.c 2>&1 && " + path + "/layouts");
  EXPECT_EQ(c.exit_code, 0) << c.output;
  // and a wrong offset is found
  std::string wrong = folder.read("Packet_little_4.h");
  wrong.replace(wrong.find("#pragma pack(push, 4)"), 21, "#pragma pack(push, 1)");
  folder.write("Packet_little_4.h", wrong);
  EXPECT_NE(run_shell("cc -std=c11" + flags + path + "/layouts.c 2> /dev/null").exit_code, 0);
}

TEST(Layout, NotesTheBytesForSimulink) {
  const std::string note = simulink_note(build(peer_layout(ByteOrder::little, 4)));
  // 1 gap byte before count, 3 before total, and so on: the bytes of the list are those of the packet
  EXPECT_NE(note.find("| UDP Receive | data type, maximum length | uint8, 44 |"), std::string::npos) << note;
  EXPECT_NE(note.find("{'uint8','uint8','uint16','int8','uint8','uint32','single','int64','int16','uint8','double',"
                      "'uint16','uint8','uint32'}"),
            std::string::npos)
      << note;
  EXPECT_NE(note.find("{1,1,1,1,3,1,1,1,1,2,1,1,2,1}"), std::string::npos) << note;
  EXPECT_NE(note.find("- gear: bits 9 to 11"), std::string::npos) << note;
  EXPECT_EQ(note.find("reverse each signal"), std::string::npos);
  EXPECT_NE(simulink_note(build(peer_layout(ByteOrder::big, 1))).find("reverse each signal"), std::string::npos);
}

TEST(Layout, CommentsDoNotEndEarly) {
  LayoutDef def = small_layout();
  def.fields[1].unit = "*/ int x; /* \\";
  const std::string header = c_header(build(def));
  EXPECT_EQ(header.find("*/ int x"), std::string::npos) << header;
  EXPECT_EQ(header.find('\\'), std::string::npos) << header;
}

TEST(Layout, RefusesWrongDefinitions) {
  EXPECT_EQ(problem_of(small_layout()), "");
  const auto with = [](auto change) {
    LayoutDef def = small_layout();
    change(def);
    return problem_of(def);
  };
  EXPECT_EQ(with([](auto& d) { d.packing = 2; }), "Small.packing: 2 is no packing");
  EXPECT_EQ(with([](auto& d) { d.packing = 9; }), "Small.packing: 9 is out of range");
  EXPECT_EQ(with([](auto& d) { d.size = 5; }), "Small.size: the fields need 6 bytes, not 5");
  EXPECT_EQ(with([](auto& d) { d.size = 1473; }), "Small.size: 1473 is out of range");
  EXPECT_EQ(with([](auto& d) { d.most_lost = -1; }), "Small.most_lost: -1 is out of range");
  EXPECT_EQ(with([](auto& d) { d.fields.clear(); }), "Small.fields: the layout has no field");
  EXPECT_EQ(with([](auto& d) { d.fields[1].name = "n"; }), "Small.n: the name is used twice in the layout");
  EXPECT_EQ(with([](auto& d) { d.fields[1].name = "1x"; }), "Small.1x: '1x' is no name for a field");
  EXPECT_EQ(with([](auto& d) { d.fields[1].name = "float"; }), "Small.float: 'float' is no name for a field");
  // ISO C11 and C23, C++20: keywords and alternative tokens; what compilers and the header itself define
  for (const char* const word :
       {"alignof",       "and",           "and_eq",       "bitand",    "bitor",     "char8_t",
        "char16_t",      "char32_t",      "co_await",     "co_yield",  "co_return", "compl",
        "concept",       "consteval",     "constexpr",    "constinit", "decltype",  "dynamic_cast",
        "export",        "noexcept",      "not_eq",       "nullptr",   "or",        "or_eq",
        "requires",      "static_assert", "thread_local", "typeid",    "typeof",    "typeof_unqual",
        "wchar_t",       "xor",           "xor_eq",       "restrict",  "_Alignas",  "_Atomic",
        "_BitInt",       "_Bool",         "_Complex",     "_Generic",  "_Noreturn", "_Static_assert",
        "_Thread_local", "__int128",      "uint8_t",      "int64_t",   "NULL",      "linux",
        "unix"}) {
    EXPECT_EQ(with([word](auto& d) { d.fields[1].name = word; }),
              fmt::format("Small.{}: '{}' is no name for a field", word, word));
  }
  // near to them, and allowed
  for (const char* const word : {"xor8", "override", "final", "import", "module", "_x", "Float"})
    EXPECT_EQ(with([word](auto& d) { d.fields[1].name = word; }), "") << word;
  EXPECT_EQ(with([](auto& d) { d.fields[1].scale = 0; }), "Small.x.scale: 0 maps every value to one number");
  EXPECT_EQ(with([](auto& d) { d.fields[1].scale = NAN; }), "Small.x.scale: nan is out of range");
  EXPECT_EQ(with([](auto& d) { d.fields[1].offset = INFINITY; }), "Small.x.offset: inf is out of range");
  EXPECT_EQ(with([](auto& d) { d.fields[1].lowest = INFINITY; }), "Small.x.lowest: inf is out of range");
  EXPECT_EQ(with([](auto& d) { d.fields[1].highest = -INFINITY; }), "Small.x.highest: -inf is out of range");
  EXPECT_EQ(with([](auto& d) { d.fields[1].lowest = 2, d.fields[1].highest = 1; }),
            "Small.x.lowest: 2 is above highest, 1");
  EXPECT_EQ(with([](auto& d) { d.fields[0].type = ByteType::int8; }), "Small.n.as: a sequence is an unsigned integer");
  EXPECT_EQ(with([](auto& d) { d.fields[2].type = ByteType::uint16; }),
            "Small.sum.as: the type does not fit the checksum");
  EXPECT_EQ(
      with([](auto& d) { d.fields.push_back({.name = "m", .type = ByteType::uint8, .role = FieldRole::sequence}); }),
      "Small.fields: the layout has two sequences or two checksums");
  EXPECT_EQ(with([](auto& d) { d.fields.push_back({.name = "b", .of = "y"}); }), "Small.b.of: there is no field 'y'");
  EXPECT_EQ(with([](auto& d) { d.fields.push_back({.name = "b", .of = "x"}); }),
            "Small.b.of: 'x' is no integer that can be divided");
  EXPECT_EQ(with([](auto& d) { d.fields.push_back({.name = "b", .of = "n"}); }),
            "Small.b.of: 'n' is no integer that can be divided");
  const auto with_bits = [&](std::int64_t bit, std::int64_t bits) {
    return with([&](auto& d) {
      d.fields.push_back({.name = "w", .type = ByteType::uint8});
      d.fields.push_back({.name = "a", .of = "w", .bit = 2, .bits = 2});
      d.fields.push_back({.name = "b", .of = "w", .bit = bit, .bits = bits});
    });
  };
  EXPECT_EQ(with_bits(4, 4), "");
  EXPECT_EQ(with_bits(4, 5), "Small.b.bits: bits 4 to 8 are not in 'w' of 8 bits");
  EXPECT_EQ(with_bits(3, 1), "Small.b.bit: its bits overlap those of 'a'");
  EXPECT_EQ(with_bits(64, 1), "Small.b.bit: 64 is out of range");
  EXPECT_EQ(with_bits(0, 0), "Small.b.bits: 0 is out of range");
  LayoutDef large{.name = "Large"};
  for (int i = 0; i < 185; ++i) large.fields.push_back({.name = "f" + std::to_string(i)});
  EXPECT_EQ(problem_of(large), "Large.fields: the fields need 1480 bytes");
  EXPECT_THROW(static_cast<void>(build(large)), Failure);
}

}  // namespace byte_layout_test
}  // namespace slew::devices
