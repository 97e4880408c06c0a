// SPDX-License-Identifier: Apache-2.0
// Reader of CAN databases in the DBC format.
//
// Read: BO_ messages with SG_ signals (Intel and Motorola, signed, factor and offset, range, unit, multiplexers M and
// m0), SIG_VALTYPE_ (floats), SG_MUL_VAL_ (several numbers of one multiplexer). All other sections (comments, value
// texts, attributes, environment variables) are skipped and counted by name: none of them changes a number. Refused:
// multiplexers below multiplexers (m0M).
//
// Text that is no UTF-8 is taken as Windows-1252, which is what most tools write.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/problem.h"
#include "devices/can_message.h"

namespace slew::devices {

inline constexpr std::size_t kMaxDbcBytes = 32'000'000;

struct CanDatabase {
  std::vector<CanMessage> messages;
  std::map<std::string, int, std::less<>> skipped;  // sections, as "CM_"
};

// name: of the file, for problems, whose path is "machine.dbc:12". At most 20 problems are reported; messages with one
// are not in the result.
[[nodiscard]] CanDatabase read_dbc(std::string_view text, std::string_view name, Problems& problems);

// The same for a file. A file that cannot be read is a problem.
[[nodiscard]] CanDatabase load_dbc(const std::filesystem::path& path, Problems& problems);

// The messages as a DBC text, which reads back to the same.
[[nodiscard]] std::string write_dbc(std::span<const CanMessage> messages);

[[nodiscard]] const CanMessage* find_message(const CanDatabase& database, std::string_view name) noexcept;
[[nodiscard]] const CanMessage* find_message(const CanDatabase& database, std::uint32_t id, bool is_extended) noexcept;

}  // namespace slew::devices
