// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "devices/dbc.h"

namespace slew::devices {
namespace {

constexpr std::uint32_t kExtendedId = 0x80000000;

std::uint32_t number_of(const CanMessage& message) {
  return message.id | (message.is_extended ? kExtendedId : 0);
}

// " M", " m3"; of several numbers the first, and all in SG_MUL_VAL_
std::string multiplexing_text(const CanSignal& signal) {
  if (signal.is_selector) return " M";
  return signal.selected_by.empty() ? "" : fmt::format(" m{}", signal.selected_by.front().first);
}

bool has_one_number(const CanSignal& signal) {
  return signal.selected_by.size() == 1 && signal.selected_by[0].first == signal.selected_by[0].last;
}

}  // namespace

std::string write_dbc(std::span<const CanMessage> messages) {
  std::string text, types;
  for (const CanMessage& message : messages) {
    text += fmt::format("BO_ {} {}: {} Vector__XXX\n", number_of(message), message.name, message.bytes);
    std::string selector;
    for (const CanSignal& signal : message.signals) {
      if (signal.is_selector) selector = signal.name;
    }
    for (const CanSignal& signal : message.signals) {
      text += fmt::format(" SG_ {}{} : {}|{}@{}{} ({},{}) [{}|{}] \"{}\" Vector__XXX\n", signal.name,
                          multiplexing_text(signal), signal.start_bit, signal.bits,
                          signal.order == ByteOrder::little ? 1 : 0, signal.is_signed ? '-' : '+', signal.scale,
                          signal.offset, signal.lowest, signal.highest, signal.unit);
      if (signal.number != CanNumber::integer) {
        types +=
            fmt::format("SIG_VALTYPE_ {} {} : {};\n", number_of(message), signal.name, static_cast<int>(signal.number));
      }
      if (signal.selected_by.empty() || has_one_number(signal)) continue;
      types += fmt::format("SG_MUL_VAL_ {} {} {} ", number_of(message), signal.name, selector);
      for (std::size_t i = 0; i < signal.selected_by.size(); ++i) {
        types += fmt::format("{}{}-{}", i > 0 ? ", " : "", signal.selected_by[i].first, signal.selected_by[i].last);
      }
      types += ";\n";
    }
  }
  return text + types;
}

}  // namespace slew::devices
