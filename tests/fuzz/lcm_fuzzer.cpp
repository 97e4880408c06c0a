// SPDX-License-Identifier: Apache-2.0
// What comes from LCM: any bytes are a message, or refused by cause; any bytes are an event log, up to the first
// damage. What is accepted is a finite value of a channel of the scene in the name of an accepted controller, and a
// log's table has times that do not fall and values from -1 to 1.
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "lcm_log/event_log.h"
#include "lcm_log/input_filter.h"
#include "lcm_log/input_table.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;

void take_messages(std::span<const std::byte> bytes) {
  lcm_log::InputFilter filter({{"I", false, false}, {"K", true, false}, {"L", false, true}}, {"c"});
  lcm_log::ParameterRequest request;
  static_cast<void>(decode(bytes, request));
  std::uint64_t messages = 0, accepted = 0;
  // the whole, then its parts behind one another, as one sender's messages
  for (std::size_t size = bytes.size(); size > 0; size /= 2) {
    ++messages;
    const auto input = filter.take(bytes.first(size), static_cast<std::int64_t>(messages) * 1'000'000, 1000);
    if (!input) continue;
    ++accepted;
    fuzz::require(std::isfinite(input->value) && input->based_on_step <= 1000 && input->sequence >= 0);
    fuzz::require(input->controller == "c" && (input->channel == "I" || input->channel == "K"));
  }
  std::uint64_t refused = 0;
  for (const std::uint64_t number : filter.counts().refused) refused += number;
  fuzz::require(accepted + refused == messages);
}

void take_log(std::string_view log) {
  lcm_log::EventLogReader reader(log);
  std::string again;
  lcm_log::EventLogWriter writer;
  for (lcm_log::Event event; reader.next(event);) writer.add(event, again);
  // but for their numbers the events are the bytes of the log
  fuzz::require(again.size() <= log.size() && (!reader.damage().empty() || again.size() == log.size()));

  const lcm_log::TableChannel channels[] = {{"I", false}, {"K", true}};
  const lcm_log::InputTable table = input_table(log, channels, milliseconds(1), milliseconds(200));
  fuzz::require(table.csv.empty() != table.problem.empty());
  double time = -1;
  std::size_t line = 0;
  for (std::size_t begin = 0; begin < table.csv.size(); ++line) {
    const std::size_t end = table.csv.find('\n', begin);
    const std::string row = table.csv.substr(begin, end - begin);
    begin = end + 1;
    if (line == 0) continue;
    const double now = std::strtod(row.c_str(), nullptr);
    fuzz::require(std::isfinite(now) && now >= time && now >= 0);
    time = now;
    for (std::size_t cell = row.find(','); cell != std::string::npos; cell = row.find(',', cell + 1)) {
      const double value = std::strtod(row.c_str() + cell + 1, nullptr);
      fuzz::require(value >= -1 && value <= 1);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view content(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] % 2 == 0) {
    take_messages(std::as_bytes(std::span(content.data(), content.size())));
  } else {
    take_log(content);
  }
  return 0;
}
