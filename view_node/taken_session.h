// SPDX-License-Identifier: Apache-2.0
// A live session that goes on from a place of a recording: `slewring replay REC --until T --then-live` computes the
// recorded steps again up to there and runs on from the state, with the same bits as long as the inputs are the same. A
// window of its own serves it. One at a time; it ends with the window of the recording.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "gateway/gateway.h"
#include "view_node/window_options.h"

namespace slew::view_node {

class TakenSession final : public gateway::Continuation {
 public:
  // Where a time of the recording lies in the recorded session.
  struct SessionTime {
    std::uint32_t epoch = 0;
    double time = 0;  // s, the session's own
  };
  // recorded_time: s, of the recording. Throws Failure when the recording has no step of that time.
  using SessionTimeOf = std::function<SessionTime(double recorded_time)>;

  // options: of the window of the recording. name: of the recorded session.
  TakenSession(WindowOptions options, const std::string& name, SessionTimeOf session_time_of);
  // Ends the session in order, which takes some seconds at most.
  ~TakenSession() override;

  void start(const gateway::ContinuationRequest& request, Done done) override;
  // Answers when the window of the session has its address, or when one of the two has ended before. Result: lines for
  // the user.
  [[nodiscard]] std::vector<std::string> poll();

 private:
  void end(const std::string& problem);

  WindowOptions options_;
  SessionTimeOf session_time_of_;
  std::string name_;                                // of the live session
  Done done_;                                       // empty: answered
  std::unique_ptr<ChildProcess> session_, window_;  // both or none
  std::string output_;                              // of both, from the start to the answer
};

}  // namespace slew::view_node
