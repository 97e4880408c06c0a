// SPDX-License-Identifier: Apache-2.0
// The loop of a node's process, its main thread, held as by a debugger: the other threads go on.
#pragma once

#include <sys/types.h>

namespace slew::testing {

class HeldLoop {
 public:
  // Holds it from now on; is_held() is false when this machine lets no process trace another one.
  explicit HeldLoop(pid_t process);
  ~HeldLoop() { let_go(); }
  HeldLoop(const HeldLoop&) = delete;
  HeldLoop& operator=(const HeldLoop&) = delete;

  [[nodiscard]] bool is_held() const noexcept { return is_held_; }
  void let_go();

 private:
  pid_t tracer_ = -1;  // a process of its own, so that no other process has to wait for the node's end
  bool is_held_ = false;
};

}  // namespace slew::testing
