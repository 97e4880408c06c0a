// SPDX-License-Identifier: Apache-2.0
#include "devices/j1939_claim.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "devices/j1939.h"

namespace slew::devices {
namespace {

constexpr std::int64_t kContestNs = 250'000'000;  // J1939-81, 4.2.2.3
// Cannot Claim follows after 0 to 153 ms, so that several losers do not send at once (J1939-81, 4.4.4.3)
constexpr std::int64_t kCannotClaimStepNs = 600'000;
constexpr unsigned kPriority = 6;
constexpr unsigned kFirstFreeAddress = 128, kLastFreeAddress = 247;  // self-configurable units
constexpr std::size_t kNameBytes = 8, kRequestBytes = 3;

constexpr FieldOptions number_below(double bound, std::string_view doc) {
  return {.range = {.min = 0, .max = bound - 1, .min_is_open = false, .max_is_open = false}, .doc = doc};
}

constexpr Field kUnitFields[] = {
    field<&J1939UnitDef::address>(
        "address", number_below(255, "j1939: address that the device claims, 0 to 253; 254: it claims none")),
    field<&J1939UnitDef::has_arbitrary_address>(
        "arbitrary_address", {.doc = "j1939: a device that loses its address claims another one of 128 to 247"}),
    field<&J1939UnitDef::identity>("identity",
                                   number_below(1 << 21, "j1939: identity number of the NAME, of this device alone")),
    field<&J1939UnitDef::manufacturer>("manufacturer", number_below(1 << 11, "j1939: part of the NAME")),
    field<&J1939UnitDef::function>("function", number_below(1 << 8, "j1939: part of the NAME")),
    field<&J1939UnitDef::function_instance>("function_instance", number_below(1 << 5, "j1939: part of the NAME")),
    field<&J1939UnitDef::ecu_instance>("ecu_instance", number_below(1 << 3, "j1939: part of the NAME")),
    field<&J1939UnitDef::vehicle_system>("vehicle_system", number_below(1 << 7, "j1939: part of the NAME")),
    field<&J1939UnitDef::vehicle_system_instance>("vehicle_system_instance",
                                                  number_below(1 << 4, "j1939: part of the NAME")),
    field<&J1939UnitDef::industry_group>("industry_group",
                                         number_below(1 << 3, "j1939: part of the NAME; 3: construction equipment")),
};

CanFrame claim_frame(std::uint8_t source, std::uint64_t name) {
  CanFrame frame;
  frame.is_extended = true;
  const auto id = join_j1939({.priority = kPriority, .pgn = kPgnAddressClaimed, .source = source});
  SLEW_CHECK(id.has_value());
  frame.id = *id;
  frame.size = kNameBytes;
  for (std::size_t i = 0; i < kNameBytes; ++i) frame.bytes[i] = static_cast<std::byte>((name >> (8 * i)) & 0xFF);
  return frame;
}

std::uint64_t number_in(std::span<const std::byte> bytes) noexcept {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) number = number << 8 | std::to_integer<std::uint64_t>(bytes[i - 1]);
  return number;
}

}  // namespace

std::span<const Field> j1939_unit_fields() noexcept {
  return kUnitFields;
}

std::uint64_t j1939_name(const J1939UnitDef& def) noexcept {
  const auto part = [](std::int64_t number, unsigned first_bit) {
    return static_cast<std::uint64_t>(number) << first_bit;
  };
  return part(def.identity, 0) | part(def.manufacturer, 21) | part(def.ecu_instance, 32) |
         part(def.function_instance, 35) | part(def.function, 40) | part(def.vehicle_system, 49) |
         part(def.vehicle_system_instance, 56) | part(def.industry_group, 60) |
         part(def.has_arbitrary_address ? 1 : 0, 63);
}

std::string text_of(const ClaimEvent& event) {
  switch (event.kind) {
    case ClaimEvent::Kind::claimed:
      return fmt::format("has claimed address {}", event.address);
    case ClaimEvent::Kind::moved:
      return fmt::format("address {} belongs to the unit with the NAME {:016X}; claims address {}", event.address,
                         event.other_name, event.next_address);
    case ClaimEvent::Kind::same_name:
      return fmt::format(
          "another unit has claimed address {} with the same NAME, {:016X}; nothing is sent; give this "
          "device an identity of its own",
          event.address, event.other_name);
    case ClaimEvent::Kind::lost:
      break;
  }
  return fmt::format(
      "the claim of address {} is lost to the unit with the NAME {:016X}; nothing is sent; choose another "
      "address, or arbitrary_address",
      event.address, event.other_name);
}

J1939Claim::J1939Claim(const J1939UnitDef& def)
    : name_(j1939_name(def)),
      preferred_(static_cast<std::uint8_t>(def.address)),
      address_(preferred_),
      has_arbitrary_address_(def.has_arbitrary_address) {
  SLEW_CHECK(def.claims());
}

std::uint8_t J1939Claim::address() const noexcept {
  return phase_ == ClaimPhase::claimed ? address_ : kJ1939NullAddress;
}

void J1939Claim::claim(std::uint8_t address, std::int64_t now_ns, std::vector<CanFrame>& frames) {
  address_ = address;
  phase_ = ClaimPhase::claiming;
  due_ns_ = now_ns + kContestNs;
  frames.push_back(claim_frame(address_, name_));
}

void J1939Claim::connect(std::int64_t now_ns, std::vector<CanFrame>& frames) {
  others_.fill(0);
  claim(preferred_, now_ns, frames);
}

void J1939Claim::take(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& frames) {
  if (!frame.is_extended || phase_ == ClaimPhase::none) return;
  const J1939Id id = split_j1939(frame.id);
  if (id.pgn == kPgnAddressClaimed && frame.size == kNameBytes) {
    take_claim(id.source, number_in(frame.data()), now_ns, frames);
  } else if (id.pgn == kPgnRequest && frame.size == kRequestBytes && number_in(frame.data()) == kPgnAddressClaimed) {
    const bool is_for_us = id.destination == kJ1939ToAll || (phase_ != ClaimPhase::lost && id.destination == address_);
    if (!is_for_us) return;
    frames.push_back(claim_frame(phase_ == ClaimPhase::lost ? kJ1939NullAddress : address_, name_));
  }
}

void J1939Claim::take_claim(std::uint8_t address, std::uint64_t name, std::int64_t now_ns,
                            std::vector<CanFrame>& frames) {
  if (address >= kJ1939NullAddress) return;
  // a unit that has moved has left its former address
  std::replace(others_.begin(), others_.end(), name, std::uint64_t{0});
  others_[address] = name;
  if (address != address_ || phase_ == ClaimPhase::lost) return;
  ++contests_;
  if (name == name_) return lose(ClaimEvent::Kind::same_name, name, now_ns);
  if (name > name_) {
    // the smaller NAME keeps the address
    others_[address] = 0;
    frames.push_back(claim_frame(address_, name_));
    return;
  }
  std::uint8_t next = 0;
  if (!has_arbitrary_address_ || !find_free_address(next)) return lose(ClaimEvent::Kind::lost, name, now_ns);
  events_.push_back({ClaimEvent::Kind::moved, address, next, name});
  claim(next, now_ns, frames);
}

// Result: false if all are taken. Two units that look at the same time begin at different places.
bool J1939Claim::find_free_address(std::uint8_t& address) const noexcept {
  constexpr unsigned kAddresses = kLastFreeAddress - kFirstFreeAddress + 1;
  for (unsigned i = 0; i < kAddresses; ++i) {
    const unsigned candidate = kFirstFreeAddress + static_cast<unsigned>((name_ + i) % kAddresses);
    if (candidate == address_ || others_[candidate] != 0) continue;
    address = static_cast<std::uint8_t>(candidate);
    return true;
  }
  return false;
}

void J1939Claim::lose(ClaimEvent::Kind kind, std::uint64_t other_name, std::int64_t now_ns) {
  phase_ = ClaimPhase::lost;
  due_ns_ = now_ns + static_cast<std::int64_t>(name_ & 0xFF) * kCannotClaimStepNs;
  events_.push_back({kind, address_, 0, other_name});
}

void J1939Claim::advance(std::int64_t now_ns, std::vector<CanFrame>& frames) {
  if (now_ns < due_ns_) return;
  due_ns_ = INT64_MAX;
  if (phase_ == ClaimPhase::claiming) {
    phase_ = ClaimPhase::claimed;
    events_.push_back({ClaimEvent::Kind::claimed, address_, 0, 0});
  } else if (phase_ == ClaimPhase::lost) {
    frames.push_back(claim_frame(kJ1939NullAddress, name_));
  }
}

std::vector<ClaimEvent> J1939Claim::take_events() {
  return std::exchange(events_, {});
}

}  // namespace slew::devices
