// SPDX-License-Identifier: Apache-2.0
// Runs nodes: one in this process, or several together on one thread.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>

#include "core/status.h"
#include "node/node.h"

namespace slew::node {

// Set by a signal handler: 0, or the exit code to end with.
extern std::atomic<int> stop_requested;

// SIGINT and SIGTERM set stop_requested; SIGPIPE is ignored.
void install_signal_handlers();

// Heap calls of the calling thread so far.
struct HeapCalls {
  std::uint64_t all = 0;
  std::uint64_t transport = 0;  // part of `all`, inside the transport's calls: those of the middleware
};
using HeapMeter = HeapCalls (*)() noexcept;

// Runs until the node has finished; sends its health every 100 ms from a thread of its own, and once more at the end.
// meter: counts the heap calls of this thread from the node's first step on into its timing; null: they are not
// counted.
ExitCode run_alone(Node& node, HeapMeter meter = nullptr);

// Runs all nodes in turn on this thread until every one has finished, and sends their health every 100 ms. each_round
// is called between rounds, at most every 20 ms (status line, keyboard), each_turn after every turn of the nodes: for
// one that takes their messages, and would hold many of them after 20 ms. Both may be empty.
ExitCode run_together(std::span<Node* const> nodes, const std::function<void()>& each_round,
                      const std::function<void()>& each_turn = {});

}  // namespace slew::node
