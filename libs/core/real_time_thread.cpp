#include "core/real_time_thread.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace slew {

Status make_real_time(int priority) {
  std::string refused;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
    refused = std::string("SCHED_FIFO was refused (") + std::strerror(errno) + ")";
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    refused += std::string(refused.empty() ? "" : ", ") + "locking memory was refused (" + std::strerror(errno) + ")";
  }
  if (refused.empty()) return Status::ok();
  return Status::error(ExitCode::resources,
                       refused +
                           "; the run goes on with normal scheduling; to allow it, run as root, or set 'rtprio 95' and "
                           "'memlock unlimited' for the user in /etc/security/limits.conf and log in again");
}

}  // namespace slew
