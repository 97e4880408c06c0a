#include "cli/interrupts.h"

#include <atomic>
#include <csignal>

#include "core/status.h"
#include "node/driver.h"

namespace slew::cli {
namespace {

// a signal handler can reach nothing else than statics
std::atomic<int> count{0};
std::atomic<int> code{0};

void on_signal(int signal) {
  const ExitCode wanted = signal == SIGINT ? ExitCode::interrupted : ExitCode::terminated;
  if (count.fetch_add(1) == 0) code.store(static_cast<int>(wanted));
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
  return count.load();
}

int interrupt_code() noexcept {
  return code.load();
}

}  // namespace slew::cli
