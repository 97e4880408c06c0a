// SPDX-License-Identifier: Apache-2.0
// The lines that the nodes of a run print: what is for the user at once, and what is for the report at its end.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace slew::session {

class NodeOutput {
 public:
  using Report = std::function<void(const std::string&)>;

  // report: a line for the user. is_refusal_reported: the refusal of real-time scheduling has been one already.
  NodeOutput(Report report, bool is_refusal_reported)
      : report_(std::move(report)), is_refusal_reported_(is_refusal_reported) {}

  void take(const std::string& line);

  [[nodiscard]] const std::string& recording() const noexcept { return recording_; }  // path; empty: none was printed
  // Messages of nodes that have failed, and those that follow from another node's failure.
  [[nodiscard]] const std::vector<std::string>& causes() const noexcept { return causes_; }
  [[nodiscard]] const std::vector<std::string>& consequences() const noexcept { return consequences_; }
  [[nodiscard]] bool is_refusal_reported() const noexcept { return is_refusal_reported_; }

 private:
  Report report_;
  bool is_refusal_reported_;
  std::string recording_;
  std::vector<std::string> causes_, consequences_;
};

}  // namespace slew::session
