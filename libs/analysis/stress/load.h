// SPDX-License-Identifier: Apache-2.0
// Other work for the machine while deadlines are measured: processes of this program under normal scheduling.
//
//   none    nothing
//   cpu     a loop of arithmetic on every processor
//   mixed   that, and one process each that copies memory (64 MiB, more than the caches hold), writes files with fsync
//           (4 MiB each) and sends datagrams of 1400 bytes to itself
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "core/status.h"

namespace slew::analysis {

enum class Load : std::uint8_t { none, cpu, mixed };

[[nodiscard]] std::string to_text(Load load);

// The load lasts as long as the object.
class LoadProcesses {
 public:
  // folder: place of the temporary files of a mixed load.
  LoadProcesses(Load load, const std::string& folder);

  // Error when one of them has ended: with its exit code and last output; later measurements lack its load. Does not
  // block.
  [[nodiscard]] Status check();

 private:
  Load load_;
  std::vector<std::unique_ptr<ChildProcess>> processes_;
};

// Main function of such a process: works until it is killed; throws Failure when it cannot. kind: cpu, memory, disk,
// network.
void work_as(const std::string& kind, const std::string& folder);

}  // namespace slew::analysis
