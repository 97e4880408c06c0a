#include "node/driver.h"

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <thread>

#include "core/arithmetic_self_test.h"
#include "core/time.h"

namespace slew::node {

std::atomic<int> stop_requested{0};

namespace {

void on_signal(int signal) {
  stop_requested.store(signal == SIGINT ? 130 : 143);
}

// the loop wakes at least this often, for the stop flag and the watch over the others
constexpr std::int64_t kLongestWaitNs = 20'000'000;

class HealthThread {
 public:
  explicit HealthThread(Node& node) : node_(node), thread_([this] { run(); }) {}
  ~HealthThread() {
    {
      const std::lock_guard lock(mutex_);
      is_stopping_ = true;
    }
    condition_.notify_one();
    thread_.join();
  }

 private:
  void run() {
    std::vector<std::byte> buffer;
    std::uint64_t last_steps = 0;
    std::int64_t last_sum = 0;
    std::unique_lock lock(mutex_);
    while (!condition_.wait_for(lock, std::chrono::nanoseconds(kHealthInterval.ns), [this] { return is_stopping_; })) {
      send(buffer, last_steps, last_sum);
    }
  }

  void send(std::vector<std::byte>& buffer, std::uint64_t& last_steps, std::int64_t& last_sum) {
    HealthState& h = node_.health();
    if (!h.has_session.load(std::memory_order_acquire)) return;
    wire::Health message;
    message.header = node_.member().header(wire::Phase::running, h.step.load(), h.epoch.load());
    message.state = static_cast<wire::NodeState>(h.state.load());
    message.is_waiting = h.is_waiting.load();
    message.waiting_for = static_cast<wire::Role>(h.waiting_for.load());
    message.waiting_step = h.waiting_step.load();
    message.steps_done = h.steps_done.load();
    message.overruns = h.overruns.load();
    message.resends_asked = h.resends_asked.load();
    message.resends_answered = h.resends_answered.load();
    message.refused_messages = h.refused.load();
    message.slip_ns = h.slip_ns.load();
    const std::int64_t sum = h.step_time_sum_ns.load();
    if (message.steps_done > last_steps) {
      message.step_time_mean =
          static_cast<double>(sum - last_sum) * 1e-9 / static_cast<double>(message.steps_done - last_steps);
    }
    message.step_time_max = static_cast<double>(h.step_time_max_ns.exchange(0)) * 1e-9;
    last_steps = message.steps_done;
    last_sum = sum;
    // a lost health message needs no reaction: the next one follows
    if (!transport::encode(message, buffer)) return;
    static_cast<void>(node_.member().transport().publish(wire::Topic::health, buffer));
  }

  Node& node_;
  std::mutex mutex_;
  std::condition_variable condition_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

ExitCode run_alone(Node& node) {
  set_floating_point_mode();
  const HealthThread health(node);
  bool stop_passed_on = false;
  while (!node.is_finished()) {
    const int stop = stop_requested.load();
    if (stop != 0 && !stop_passed_on) {
      stop_passed_on = true;
      node.request_stop(static_cast<ExitCode>(stop));
    }
    std::int64_t now = monotonic_ns();
    const bool was_busy = node.poll(now);
    for (const std::string& warning : node.member().take_warnings()) {
      std::fprintf(stderr, "%s: warning: %s\n", std::string(to_text(node.member().role())).c_str(), warning.c_str());
    }
    if (was_busy) continue;
    now = monotonic_ns();
    node.member().transport().wait_until(std::min(node.next_deadline(now), now + kLongestWaitNs));
  }
  return node.member().exit_code();
}

ExitCode run_together(std::span<Node* const> nodes, const std::function<void()>& each_round) {
  set_floating_point_mode();
  bool stop_passed_on = false;
  std::int64_t next_round_ns = 0;
  while (!std::all_of(nodes.begin(), nodes.end(), [](const Node* node) { return node->is_finished(); })) {
    const std::int64_t now = monotonic_ns();
    if (now >= next_round_ns) {
      next_round_ns = now + kLongestWaitNs;
      const int stop = stop_requested.load();
      if (stop != 0 && !stop_passed_on) {
        stop_passed_on = true;
        nodes.front()->request_stop(static_cast<ExitCode>(stop));
      }
      if (each_round) each_round();
    }
    bool any = false;
    for (Node* node : nodes) {
      if (!node->is_finished()) any |= node->poll(now);
    }
    if (any) continue;
    std::int64_t deadline = now + kLongestWaitNs;
    for (const Node* node : nodes) {
      if (!node->is_finished()) deadline = std::min(deadline, node->next_deadline(now));
    }
    sleep_until_monotonic(deadline);
  }
  // the first serious code counts
  for (Node* node : nodes) {
    if (node->member().exit_code() != ExitCode::ok) return node->member().exit_code();
  }
  return ExitCode::ok;
}

}  // namespace slew::node
