// Where Cyclone's messages go: one line on stderr at a time, at most one per second, the others counted.
//
// A broken link makes a thousand lines a second otherwise. Cyclone has one sink per process: the last one installed is
// in force; its destructor restores Cyclone's own.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace slew::transport {

class CycloneLog {
 public:
  enum class Echo { on, off };

  explicit CycloneLog(Echo echo = Echo::on);
  ~CycloneLog();
  CycloneLog(const CycloneLog&) = delete;
  CycloneLog& operator=(const CycloneLog&) = delete;

  // While off, messages are only remembered: for errors that the caller reports.
  void set_echo(Echo echo);
  [[nodiscard]] std::string last_line() const;

  void write(const char* message, std::size_t size);

 private:
  mutable std::mutex mutex_;
  Echo echo_;
  std::string last_line_;
  std::int64_t last_printed_ns_ = 0;
  std::uint64_t suppressed_ = 0;
};

}  // namespace slew::transport
