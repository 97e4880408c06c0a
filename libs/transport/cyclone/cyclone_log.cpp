#include "transport/cyclone/cyclone_log.h"

#include <dds/ddsrt/log.h>

#include <cstdio>
#include <string_view>

#include "core/printable.h"
#include "core/time.h"

namespace slew::transport {
namespace {

constexpr std::int64_t kInterval = 1'000'000'000;  // ns between two lines

// Cyclone logs this for every participant that it discovers while this process has no participant yet, or none any
// more, and tries again 0.5 s later. For a participant that is really refused it has logged the mismatch before.
bool is_false_alarm(std::string_view line) {
  return line.starts_with("Remote secure participant ") && line.ends_with(" not allowed");
}

void sink(void* log, const dds_log_data_t* entry) {
  static_cast<CycloneLog*>(log)->write(entry->message, entry->size);
}

}  // namespace

CycloneLog::CycloneLog(Echo echo) : echo_(echo) {
  dds_set_log_sink(sink, this);
  dds_set_trace_sink(sink, this);
}

CycloneLog::~CycloneLog() {
  dds_set_log_sink(nullptr, nullptr);
  dds_set_trace_sink(nullptr, nullptr);
}

void CycloneLog::set_echo(Echo echo) {
  const std::lock_guard lock(mutex_);
  echo_ = echo;
}

std::string CycloneLog::last_line() const {
  const std::lock_guard lock(mutex_);
  return last_line_;
}

void CycloneLog::write(const char* message, std::size_t size) {
  const std::lock_guard lock(mutex_);
  std::string_view line(message, size);
  while (line.ends_with('\n')) line.remove_suffix(1);
  if (is_false_alarm(line)) return;
  last_line_ = line;
  if (echo_ == Echo::off) return;
  const std::int64_t now = monotonic_ns();
  if (last_printed_ns_ != 0 && now - last_printed_ns_ < kInterval) {
    ++suppressed_;
    return;
  }
  last_printed_ns_ = now;
  if (suppressed_ > 0) {
    std::fprintf(stderr, "slewring: DDS: %s (and %llu more messages)\n", printable(last_line_).c_str(),
                 static_cast<unsigned long long>(suppressed_));
  } else {
    std::fprintf(stderr, "slewring: DDS: %s\n", printable(last_line_).c_str());
  }
  suppressed_ = 0;
}

}  // namespace slew::transport
