// SPDX-License-Identifier: Apache-2.0
#include "transport/cyclone/cyclone_log.h"

#include <dds/ddsrt/log.h>

#include <string_view>

namespace slew::transport {
namespace {

// Cyclone logs this for every participant that it discovers while this process has no participant yet, or none any
// more, and tries again 0.5 s later. For a participant that is really refused it has logged the mismatch before.
bool is_false_alarm(std::string_view line) {
  while (line.ends_with('\n')) line.remove_suffix(1);
  return line.starts_with("Remote secure participant ") && line.ends_with(" not allowed");
}

void sink(void* log, const dds_log_data_t* entry) {
  static_cast<CycloneLog*>(log)->write({entry->message, entry->size});
}

}  // namespace

CycloneLog::CycloneLog() {
  dds_set_log_sink(sink, this);
  dds_set_trace_sink(sink, this);
}

CycloneLog::~CycloneLog() {
  dds_set_log_sink(nullptr, nullptr);
  dds_set_trace_sink(nullptr, nullptr);
}

void CycloneLog::write(std::string_view line) {
  if (!is_false_alarm(line)) MiddlewareLog::write(line);
}

}  // namespace slew::transport
