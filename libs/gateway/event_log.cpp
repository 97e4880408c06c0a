// SPDX-License-Identifier: Apache-2.0
#include "gateway/event_log.h"

#include "gateway/server_messages.h"

namespace slew::gateway {
const LogEvent& EventLog::add(std::uint64_t time_ns, LogLevel level, const std::string& source,
                              const std::string& text) {
  const Json json = {{"timestamp", time_json(time_ns)},
                     {"level", static_cast<unsigned>(level)},
                     {"message", text},
                     {"name", source},
                     {"file", ""},
                     {"line", 0}};
  if (kept_.size() == kKept) kept_.pop_front();
  kept_.push_back({time_ns, std::make_shared<const std::string>(json.dump())});
  return kept_.back();
}

}  // namespace slew::gateway
