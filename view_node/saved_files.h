// SPDX-License-Identifier: Apache-2.0
// Saved states of a session as files NAME.saved in a folder. `slewring control save` and `load` write and read them,
// each as a process: saving waits for all nodes, the window does not.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "gateway/gateway.h"
#include "node/session_options.h"

namespace slew::view_node {

class SavedFiles final : public gateway::SavedStates {
 public:
  static constexpr std::size_t kMostAtOnce = 4;  // processes

  SavedFiles(std::string folder, node::SessionOptions session)
      : folder_(std::move(folder)), session_(std::move(session)) {}

  void save(const std::string& name, Done done) override { start("save", name, std::move(done)); }
  void load(const std::string& name, Done done) override { start("load", name, std::move(done)); }
  // Answers for processes that have ended.
  void poll();

 private:
  struct Running {
    std::unique_ptr<ChildProcess> process;
    Done done;
    std::string output{};
  };
  void start(const char* command, const std::string& name, Done done);

  std::string folder_;
  node::SessionOptions session_;
  std::vector<Running> running_;
};

}  // namespace slew::view_node
