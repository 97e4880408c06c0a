// SPDX-License-Identifier: Apache-2.0
// Variables of a window's recordings as whole curves. They are read on a thread of their own, since a long recording
// takes its time and the playback must not wait.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gateway/gateway.h"
#include "recording/reader.h"
#include "view_node/request_thread.h"

namespace slew::view_node {

class RecordedCurves final : public gateway::RecordedCurves {
 public:
  static constexpr std::size_t kMostWaiting = 64;

  // The recordings with their names for the user, the one that is played first. The thread alone reads them from now
  // on.
  struct Recording {
    std::string name;
    std::unique_ptr<recording::Reader> reader;
  };
  explicit RecordedCurves(std::vector<Recording> recordings);
  [[nodiscard]] std::vector<std::string> names() const override;
  // done is called from poll(), or at once where too many requests wait.
  void read(gateway::CurvesRequest request, Done done) override;
  void poll() { thread_.poll(); }

 private:
  [[nodiscard]] Answer answer(const gateway::CurvesRequest& request) const;
  [[nodiscard]] Answer read_curves(const gateway::CurvesRequest& request) const;

  std::vector<Recording> recordings_;
  RequestThread<gateway::CurvesRequest, Answer> thread_;  // the last member: its end is that of its use of the others
};

}  // namespace slew::view_node
