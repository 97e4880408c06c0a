// SPDX-License-Identifier: Apache-2.0
#include "session/interrupts.h"

#include <atomic>
#include <csignal>

#include "core/status.h"
#include "core/time.h"
#include "node/driver.h"

namespace slew::session {
namespace {

// a signal handler can reach statics only
std::atomic<int> signal_count{0};
std::atomic<int> first_code{0};
std::atomic<int> ctrl_c_count{0};
std::atomic<std::int64_t> first_signal_ns{0};

// several threads may be in it at once
void on_signal(int signal) {
  const ExitCode wanted = signal == SIGINT ? ExitCode::interrupted : ExitCode::terminated;
  const std::int64_t now_ns = monotonic_ns();  // clock_gettime is safe here
  std::int64_t before_ns = 0;
  const bool is_first = first_signal_ns.compare_exchange_strong(before_ns, now_ns);
  if (is_first) first_code.store(static_cast<int>(wanted));
  if (signal == SIGINT && (is_first || now_ns - before_ns >= kSecondThought.ns)) ctrl_c_count.fetch_add(1);
  signal_count.fetch_add(1);
  node::stop_requested.store(static_cast<int>(wanted));
}

}  // namespace

void count_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

int interrupts() noexcept {
  return signal_count.load();
}

int interrupt_code() noexcept {
  return first_code.load();
}

int ctrl_cs() noexcept {
  return ctrl_c_count.load();
}

}  // namespace slew::session
