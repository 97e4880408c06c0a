// SPDX-License-Identifier: Apache-2.0
// Address claims of J1939 on a clock of the test's own.
#include "devices/j1939_claim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/problem.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace j1939_claim_test {

constexpr std::int64_t kMs = 1'000'000;

CanFrame claim_of(int source, std::uint64_t name) {
  CanFrame frame;
  frame.id = 0x18EEFF00U | static_cast<unsigned>(source);
  frame.is_extended = true;
  frame.size = 8;
  for (unsigned i = 0; i < 8; ++i) frame.bytes[i] = static_cast<std::byte>(name >> (8 * i) & 0xFF);
  return frame;
}

CanFrame request_to(int destination) {
  CanFrame frame;
  frame.id = 0x18EA00F9U | static_cast<unsigned>(destination) << 8;
  frame.is_extended = true;
  frame.size = 3;
  frame.bytes[1] = std::byte{0xEE};
  return frame;
}

struct Unit {
  explicit Unit(const J1939UnitDef& def) : claim(def) { claim.connect(now_ns, frames); }

  void take(const CanFrame& frame) {
    claim.take(frame, now_ns, frames);
    claim.advance(now_ns, frames);
  }
  void wait_ms(int duration) {
    for (int i = 0; i < duration; ++i) {
      now_ns += kMs;
      claim.advance(now_ns, frames);
    }
  }
  // Sources of the claims since the last call; each must be one of its NAME.
  std::vector<int> sent() {
    std::vector<int> sources;
    for (const CanFrame& frame : frames) {
      EXPECT_EQ(frame.bytes, claim_of(0, claim.name()).bytes);
      EXPECT_EQ(frame.size, 8u);
      EXPECT_EQ(frame.id & 0x1FFFFF00U, 0x18EEFF00U);
      sources.push_back(static_cast<int>(frame.id & 0xFF));
    }
    frames.clear();
    return sources;
  }
  std::vector<std::string> events() {
    std::vector<std::string> texts;
    for (const ClaimEvent& event : claim.take_events()) texts.push_back(text_of(event));
    return texts;
  }

  std::int64_t now_ns = 1000 * kMs;
  std::vector<CanFrame> frames;
  J1939Claim claim;
};

const J1939UnitDef kUnit{.address = 0x27, .identity = 0x12345, .function = 0x1B};
const std::uint64_t kName = j1939_name(kUnit);

TEST(J1939Claim, ANameHasItsPartsAtTheirBits) {
  EXPECT_EQ(j1939_name({.identity = 0x1FFFFF}), 0x00000000001FFFFFULL);
  EXPECT_EQ(j1939_name({.manufacturer = 0x7FF}), 0x00000000FFE00000ULL);
  EXPECT_EQ(j1939_name({.ecu_instance = 7}), 0x0000000700000000ULL);
  EXPECT_EQ(j1939_name({.function_instance = 31}), 0x000000F800000000ULL);
  EXPECT_EQ(j1939_name({.function = 0xFF}), 0x0000FF0000000000ULL);
  EXPECT_EQ(j1939_name({.vehicle_system = 0x7F}), 0x00FE000000000000ULL);
  EXPECT_EQ(j1939_name({.vehicle_system_instance = 15}), 0x0F00000000000000ULL);
  EXPECT_EQ(j1939_name({.industry_group = 7}), 0x7000000000000000ULL);
  EXPECT_EQ(j1939_name({.has_arbitrary_address = true}), 0x8000000000000000ULL);
  // bit 48 is reserved
  EXPECT_EQ(j1939_name({.has_arbitrary_address = true,
                        .identity = 0x1FFFFF,
                        .manufacturer = 0x7FF,
                        .function = 0xFF,
                        .function_instance = 31,
                        .ecu_instance = 7,
                        .vehicle_system = 0x7F,
                        .vehicle_system_instance = 15,
                        .industry_group = 7}),
            ~0x0001000000000000ULL);
}

TEST(J1939Claim, AnUncontestedAddressIsItsOwnAfter250Milliseconds) {
  Unit unit(kUnit);
  EXPECT_EQ(unit.sent(), std::vector<int>{0x27});
  unit.wait_ms(249);
  EXPECT_EQ(unit.claim.address(), kJ1939NullAddress);
  unit.wait_ms(1);
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::claimed);
  EXPECT_EQ(unit.claim.address(), 0x27);
  EXPECT_EQ(unit.events(), std::vector<std::string>{"has claimed address 39"});
  unit.take(claim_of(0x28, 1));  // of another address
  EXPECT_EQ(unit.claim.address(), 0x27);
  EXPECT_TRUE(unit.sent().empty());
}

TEST(J1939Claim, TheSmallerNameKeepsTheAddress) {
  Unit unit(kUnit);
  static_cast<void>(unit.sent());
  unit.take(claim_of(0x27, kName + 1));
  EXPECT_EQ(unit.sent(), std::vector<int>{0x27});
  unit.wait_ms(250);
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::claimed);
  unit.take(claim_of(0x27, kName + 1));
  EXPECT_EQ(unit.sent(), std::vector<int>{0x27});
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::claimed);
  EXPECT_EQ(unit.claim.contests(), 2u);
}

TEST(J1939Claim, ALostClaimSendsNothingButCannotClaim) {
  for (const int before_ms : {10, 1000}) {
    Unit unit(kUnit);
    unit.wait_ms(before_ms);
    static_cast<void>(unit.sent());
    static_cast<void>(unit.events());
    unit.take(claim_of(0x27, kName - 1));
    EXPECT_EQ(unit.claim.phase(), ClaimPhase::lost);
    EXPECT_EQ(unit.claim.address(), kJ1939NullAddress);
    EXPECT_EQ(unit.events(), std::vector<std::string>{"the claim of address 39 is lost to the unit with the NAME "
                                                      "00001B0000012344; nothing is sent; choose another address, or "
                                                      "arbitrary_address"});
    unit.wait_ms(153);
    EXPECT_EQ(unit.sent(), std::vector<int>{0xFE});
    unit.wait_ms(1000);
    EXPECT_TRUE(unit.sent().empty());
    unit.take(request_to(0xFF));
    EXPECT_EQ(unit.sent(), std::vector<int>{0xFE});
    unit.take(request_to(0x27));  // which is the other's now
    EXPECT_TRUE(unit.sent().empty());
  }
}

TEST(J1939Claim, AnArbitraryAddressMovesToOneThatIsFree) {
  J1939UnitDef def = kUnit;
  def.has_arbitrary_address = true;
  const std::uint64_t name = j1939_name(def);
  Unit unit(def);
  unit.wait_ms(250);
  static_cast<void>(unit.sent());
  static_cast<void>(unit.events());
  unit.take(claim_of(0x27, name - 1));
  std::vector<int> claims = unit.sent();
  ASSERT_EQ(claims.size(), 1u);
  const int first = claims[0];
  EXPECT_TRUE(first >= 128 && first <= 247) << first;
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::claiming);
  EXPECT_TRUE(unit.events()[0].starts_with("address 39 belongs to the unit with the NAME "));
  // every further address is taken too, by units that all come before it
  for (int i = 2; i <= 120; ++i) {
    unit.take(claim_of(claims.back(), name - static_cast<unsigned>(i)));
    const std::vector<int> next = unit.sent();
    ASSERT_EQ(next.size(), 1u) << i;
    EXPECT_EQ(std::count(claims.begin(), claims.end(), next[0]), 0) << next[0];
    claims.push_back(next[0]);
  }
  EXPECT_EQ(claims.size(), 120u);
  unit.take(claim_of(claims.back(), name - 121));
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::lost);
}

TEST(J1939Claim, AnAddressThatAnotherUnitLeavesIsFreeAgain) {
  J1939UnitDef def = kUnit;
  def.has_arbitrary_address = true;
  const std::uint64_t name = j1939_name(def);
  Unit unit(def);
  static_cast<void>(unit.sent());
  // one unit claims all free addresses one behind the other, and has only the last one
  for (int address = 128; address <= 247; ++address) unit.take(claim_of(address, name - 5));
  unit.take(claim_of(0x27, name - 1));
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::claiming);
}

TEST(J1939Claim, AUnitWithTheSameNameIsReported) {
  Unit unit(kUnit);
  unit.wait_ms(250);
  static_cast<void>(unit.events());
  unit.take(claim_of(0x27, kName));
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::lost);
  EXPECT_TRUE(unit.events()[0].ends_with("give this device an identity of its own"));
}

TEST(J1939Claim, ARequestIsAnsweredByTheClaim) {
  Unit unit(kUnit);
  unit.wait_ms(250);
  static_cast<void>(unit.sent());
  unit.take(request_to(0xFF));
  unit.take(request_to(0x27));
  EXPECT_EQ(unit.sent(), (std::vector<int>{0x27, 0x27}));
  unit.take(request_to(0x28));
  CanFrame other = request_to(0xFF);
  other.bytes[1] = std::byte{0xF0};  // of another parameter group
  unit.take(other);
  CanFrame standard = claim_of(0x27, 0);
  standard.is_extended = false;
  unit.take(standard);
  CanFrame short_claim = claim_of(0x27, 0);
  short_claim.size = 7;
  unit.take(short_claim);
  unit.take(claim_of(0xFE, 0));  // Cannot Claim of another unit
  EXPECT_TRUE(unit.sent().empty());
  EXPECT_EQ(unit.claim.phase(), ClaimPhase::claimed);
}

TEST(J1939Claim, PartsOutOfTheirRangeAreRefused) {
  const auto problem_of = [](const J1939UnitDef& def) {
    Problems problems;
    check_fields("Unit", &def, j1939_unit_fields(), problems);
    return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
  };
  EXPECT_EQ(problem_of(kUnit), "");
  EXPECT_EQ(problem_of({.address = 255}), "Unit.address: 255 is out of range");
  EXPECT_EQ(problem_of({.identity = 1 << 21}), "Unit.identity: 2.09715e+06 is out of range");
  EXPECT_EQ(problem_of({.manufacturer = 2048}), "Unit.manufacturer: 2048 is out of range");
  EXPECT_EQ(problem_of({.function = 256}), "Unit.function: 256 is out of range");
  EXPECT_EQ(problem_of({.function_instance = 32}), "Unit.function_instance: 32 is out of range");
  EXPECT_EQ(problem_of({.ecu_instance = 8}), "Unit.ecu_instance: 8 is out of range");
  EXPECT_EQ(problem_of({.vehicle_system = 128}), "Unit.vehicle_system: 128 is out of range");
  EXPECT_EQ(problem_of({.vehicle_system_instance = 16}), "Unit.vehicle_system_instance: 16 is out of range");
  EXPECT_EQ(problem_of({.industry_group = 8}), "Unit.industry_group: 8 is out of range");
}

}  // namespace j1939_claim_test
}  // namespace slew::devices
