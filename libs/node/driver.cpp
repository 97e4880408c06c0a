// SPDX-License-Identifier: Apache-2.0
#include "node/driver.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/arithmetic_self_test.h"
#include "core/printable.h"
#include "core/time.h"
#include "node/health_report.h"

namespace slew::node {

std::atomic<int> stop_requested{0};

namespace {

void on_signal(int signal) {
  stop_requested.store(signal == SIGINT ? 130 : 143);
}

// the loop wakes at least this often, for the stop flag and the watch over the other nodes
constexpr std::int64_t kLongestWaitNs = 20'000'000;
constexpr int kHealthsPerMisfitCheck = 10;  // one second: an endpoint that does not fit is named within two

class HealthThread {
 public:
  explicit HealthThread(Node& node) : node_(node), report_(node), loop_(node.health()), thread_([this] { run(); }) {
    // in a real-time process: below every loop, above everything else
    int policy = SCHED_OTHER;
    sched_param parameters{};
    if (pthread_getschedparam(thread_.native_handle(), &policy, &parameters) != 0 || policy != SCHED_FIFO) return;
    parameters.sched_priority = 1;
    pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &parameters);
  }
  ~HealthThread() {
    {
      const std::lock_guard lock(mutex_);
      is_stopping_ = true;
    }
    condition_.notify_one();
    thread_.join();
    report_.send();  // the final state
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    int sent = 0;
    while (!condition_.wait_for(lock, std::chrono::nanoseconds(kHealthInterval.ns), [this] { return is_stopping_; })) {
      if (is_loop_standing()) continue;
      report_.send();
      if (++sent % kHealthsPerMisfitCheck == 0) name_misfits();
    }
  }

  // A node whose loop stands still publishes no health: the other nodes find it silent.
  bool is_loop_standing() {
    const SimDuration before = loop_.stood_for();
    const bool stands = loop_.poll();
    if (stands == std::exchange(is_standing_, stands)) return stands;
    std::string text = stands ? "the loop of this node has stood still for " + seconds_text(loop_.stood_for())
                              : "the loop of this node goes on; it had stood still for " + seconds_text(before);
    text += " at step " + std::to_string(node_.health().step.load());
    if (stands) {
      text += "; it is silent from now on, and given up after " + node_.member().give_up_text() +
              "; look for a deadlock, a computation without an end, or a debugger";
    }
    print_warning(text);
    return stands;
  }

  void print_warning(const std::string& text) {
    std::fprintf(stderr, "%s: warning: %s\n", std::string(to_text(node_.member().role())).c_str(),
                 printable(text).c_str());
  }

  // names each misfit once
  void name_misfits() {
    for (const std::string& misfit : node_.member().transport().misfits()) {
      if (named_.insert(misfit).second) print_warning(misfit);
    }
  }

  Node& node_;
  HealthReport report_;
  LoopWatch loop_;
  bool is_standing_ = false;
  std::set<std::string> named_;
  std::mutex mutex_;
  std::condition_variable condition_;
  bool is_stopping_ = false;
  std::thread thread_;
};

void print_warnings(Node& node) {
  for (const std::string& warning : node.member().take_warnings()) {
    std::fprintf(stderr, "%s: warning: %s\n", std::string(to_text(node.member().role())).c_str(),
                 printable(warning).c_str());
  }
}

// Heap calls of the loop's thread, counted once all nodes were READY and this one has done its first step: the first
// message of each kind allocates the memory for those that follow.
class LoopHeap {
 public:
  LoopHeap(Node& node, HeapMeter meter) : node_(node), meter_(meter) {}
  void after_poll() noexcept {
    if (meter_ == nullptr) return;
    const HeapCalls now = meter_();
    if (!is_running_) {
      is_running_ = node_.member().state() >= wire::NodeState::running;
      before_ = now;
      return;
    }
    const std::uint64_t of_transport = now.transport - before_.transport;
    node_.timing().allocations = static_cast<std::int64_t>(now.all - before_.all - of_transport);
    node_.timing().carrier_allocations = static_cast<std::int64_t>(of_transport);
  }

 private:
  Node& node_;
  HeapMeter meter_;
  HeapCalls before_;
  bool is_running_ = false;
};

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

ExitCode run_alone(Node& node, HeapMeter meter) {
  set_floating_point_mode();
  const HealthThread health(node);
  LoopHeap heap(node, meter);
  bool stop_passed_on = false;
  while (!node.is_finished()) {
    const int stop = stop_requested.load();
    if (stop != 0 && !stop_passed_on) {
      stop_passed_on = true;
      node.request_stop(static_cast<ExitCode>(stop));
    }
    std::int64_t now = monotonic_ns();
    node.health().turn();
    const bool was_busy = node.poll(now);
    heap.after_poll();
    print_warnings(node);
    if (was_busy) continue;
    now = monotonic_ns();
    node.member().transport().wait_until(std::min(node.next_deadline(now), now + kLongestWaitNs));
  }
  return node.member().exit_code();
}

ExitCode run_together(std::span<Node* const> nodes, const std::function<void()>& each_round,
                      const std::function<void()>& each_turn) {
  set_floating_point_mode();
  bool stop_passed_on = false;
  std::int64_t next_round_ns = 0;
  std::int64_t next_health_ns = 0;
  std::vector<HealthReport> reports;
  for (Node* node : nodes) reports.emplace_back(*node);
  while (!std::all_of(nodes.begin(), nodes.end(), [](const Node* node) { return node->is_finished(); })) {
    const std::int64_t now = monotonic_ns();
    if (now >= next_round_ns) {
      next_round_ns = now + kLongestWaitNs;
      const int stop = stop_requested.load();
      if (stop != 0 && !stop_passed_on) {
        stop_passed_on = true;
        nodes.front()->request_stop(static_cast<ExitCode>(stop));
      }
      if (now >= next_health_ns) {
        next_health_ns = now + kHealthInterval.ns;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          if (!nodes[i]->is_finished()) reports[i].send();
        }
      }
      for (Node* node : nodes) print_warnings(*node);
      if (each_round) each_round();
    }
    bool any = false;
    for (Node* node : nodes) {
      if (!node->is_finished()) any |= node->poll(now);
    }
    if (each_turn) each_turn();
    if (any) continue;
    std::int64_t deadline = now + kLongestWaitNs;
    for (const Node* node : nodes) {
      if (!node->is_finished()) deadline = std::min(deadline, node->next_deadline(now));
    }
    sleep_until_monotonic(deadline);
  }
  for (HealthReport& report : reports) report.send();
  // the first code that is not ok counts
  for (Node* node : nodes) {
    if (node->member().exit_code() != ExitCode::ok) return node->member().exit_code();
  }
  return ExitCode::ok;
}

}  // namespace slew::node
