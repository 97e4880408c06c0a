// SPDX-License-Identifier: Apache-2.0
// Address claim of SAE J1939-81: a unit sends from an address only after it has claimed it by its NAME.
//
//   claimed         no other unit has contested the address for 250 ms
//   contested       the unit with the smaller NAME keeps the address (its Address Claimed is sent again); the other
//                   one claims another address of 128 .. 247 if its NAME permits that, or sends Cannot Claim
//   cannot claim    it sends nothing but this, and its answers to requests
//
// NAME, 64 bits, least significant byte first: identity number (21), manufacturer (11), ECU instance (3), function
// instance (5), function (8), reserved (1), vehicle system (7), vehicle system instance (4), industry group (3),
// arbitrary address (1).
//
// Pure functions of frames and a clock. Not covered: commanded address, the working set, the transport protocol.
// Source: SAE J1939-81, 4.1.1 (NAME), 4.2 (messages), 4.5 (procedures); the bit layout as in the Linux kernel,
// Documentation/networking/j1939.rst.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/can_frame.h"

namespace slew::devices {

inline constexpr std::uint32_t kPgnRequest = 0xEA00;
inline constexpr std::uint32_t kPgnAddressClaimed = 0xEE00;
inline constexpr std::uint8_t kJ1939NullAddress = 0xFE;  // source of Cannot Claim

struct J1939UnitDef {
  std::int64_t address = kJ1939NullAddress;  // preferred, 0 to 253; 254: none is claimed
  bool has_arbitrary_address = false;        // may take another one
  std::int64_t identity = 0;                 // identity number, of this unit alone, 21 bits
  std::int64_t manufacturer = 0;             // 11 bits
  std::int64_t function = 0;                 // 8 bits
  std::int64_t function_instance = 0;        // 5 bits
  std::int64_t ecu_instance = 0;             // 3 bits
  std::int64_t vehicle_system = 0;           // 7 bits
  std::int64_t vehicle_system_instance = 0;  // 4 bits
  std::int64_t industry_group = 0;           // 3 bits; 3: construction equipment

  [[nodiscard]] bool claims() const noexcept { return address != kJ1939NullAddress; }
};

[[nodiscard]] std::span<const Field> j1939_unit_fields() noexcept;
// Pre-condition: fields within their ranges.
[[nodiscard]] std::uint64_t j1939_name(const J1939UnitDef& def) noexcept;

enum class ClaimPhase : std::uint8_t {
  none,      // not begun
  claiming,  // the claim was sent, the time for others to contest it has not passed
  claimed,
  lost  // cannot claim
};

struct ClaimEvent {
  enum class Kind : std::uint8_t { claimed, moved, lost, same_name };
  Kind kind{};
  std::uint8_t address = 0;       // claimed; moved: the address that was lost, as lost and same_name
  std::uint8_t next_address = 0;  // moved
  std::uint64_t other_name = 0;   // of the unit that contests it
};
// A sentence for the user.
[[nodiscard]] std::string text_of(const ClaimEvent& event);

class J1939Claim {
 public:
  // Pre-condition: def.claims().
  explicit J1939Claim(const J1939UnitDef& def);

  // The bus was opened: claims the preferred address.
  void connect(std::int64_t now_ns, std::vector<CanFrame>& frames);
  void take(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& frames);
  void advance(std::int64_t now_ns, std::vector<CanFrame>& frames);
  [[nodiscard]] std::int64_t due_ns() const noexcept { return due_ns_; }

  [[nodiscard]] ClaimPhase phase() const noexcept { return phase_; }
  // Its address; kJ1939NullAddress unless claimed.
  [[nodiscard]] std::uint8_t address() const noexcept;
  [[nodiscard]] std::uint64_t name() const noexcept { return name_; }
  [[nodiscard]] std::uint64_t contests() const noexcept { return contests_; }
  // Since the last call, in their order.
  [[nodiscard]] std::vector<ClaimEvent> take_events();

 private:
  void take_claim(std::uint8_t address, std::uint64_t name, std::int64_t now_ns, std::vector<CanFrame>& frames);
  void claim(std::uint8_t address, std::int64_t now_ns, std::vector<CanFrame>& frames);
  void lose(ClaimEvent::Kind kind, std::uint64_t other_name, std::int64_t now_ns);
  [[nodiscard]] bool find_free_address(std::uint8_t& address) const noexcept;

  std::uint64_t name_;
  std::uint8_t preferred_, address_;
  bool has_arbitrary_address_;
  ClaimPhase phase_ = ClaimPhase::none;
  std::int64_t due_ns_ = INT64_MAX;          // end of claiming, or the time of Cannot Claim
  std::array<std::uint64_t, 256> others_{};  // NAME by address that others have claimed; 0: none
  std::uint64_t contests_ = 0;
  std::vector<ClaimEvent> events_;
};

}  // namespace slew::devices
