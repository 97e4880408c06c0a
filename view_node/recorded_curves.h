// SPDX-License-Identifier: Apache-2.0
// Variables of a window's recordings as whole curves. They are read on a thread of their own, since a long recording
// takes its time and the playback must not wait.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "gateway/gateway.h"
#include "recording/reader.h"

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
  // Waits for the curves that are being read; others get no answer.
  ~RecordedCurves() override;

  [[nodiscard]] std::vector<std::string> names() const override;
  // done is called from poll(), or at once where too many requests wait.
  void read(gateway::CurvesRequest request, Done done) override;
  void poll();

 private:
  struct Job {
    gateway::CurvesRequest request;
    Done done;
    Answer answer{};
  };
  void work();
  [[nodiscard]] Answer answer(const gateway::CurvesRequest& request) const;

  std::vector<Recording> recordings_;
  std::mutex mutex_;  // of all below
  std::condition_variable has_changed_;
  std::deque<Job> waiting_, answered_;
  bool is_closing_ = false;
  std::thread thread_;
};

}  // namespace slew::view_node
