// SPDX-License-Identifier: Apache-2.0
#include "session/node_output.h"

#include <algorithm>
#include <string_view>

namespace slew::session {

void NodeOutput::take(const std::string& line) {
  constexpr std::string_view kPath = "recording: ";
  if (line.starts_with(kPath)) {
    recording_ = line.substr(kPath.size());
    return;
  }
  // every node is refused alike: once is enough
  constexpr std::string_view kRefused = "; to allow it, run as root, or set 'rtprio 95'";
  if (line.find(kRefused) != std::string::npos) {
    if (is_refusal_reported_) return;
    is_refusal_reported_ = true;
  }
  // messages that follow from another node's failure are kept apart from the cause
  const bool is_consequence = line.find("io ended the session") != std::string::npos ||
                              line.find("because of a fault elsewhere") != std::string::npos;
  const bool is_warning = line.find("warning") != std::string::npos;
  if (is_warning || line.find("_node: ") == std::string::npos) return report_(line);
  std::vector<std::string>& kept = is_consequence ? consequences_ : causes_;
  if (std::find(kept.begin(), kept.end(), line) == kept.end()) kept.push_back(line);
}

}  // namespace slew::session
