#include "cli/stress/machine.h"

#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/real_time_thread.h"

namespace slew::cli {
namespace {

double share(std::uint64_t part, std::uint64_t all) noexcept {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

Machine this_machine() {
  Machine machine;
  utsname name{};
  if (uname(&name) == 0) machine.kernel = std::string(name.sysname) + " " + name.release + " " + name.version;
  machine.processor = processor_name();
  machine.cpus = static_cast<int>(usable_cpus().size());
  return machine;
}

CpuTicks cpu_ticks() {
  std::ifstream file("/proc/stat");
  std::string name;
  std::uint64_t user = 0, nice = 0, system = 0, idle = 0, waiting = 0, irq = 0, soft_irq = 0, steal = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> waiting >> irq >> soft_irq >> steal)) return {};
  return {user + nice + system + idle + waiting + irq + soft_irq + steal, idle + waiting, steal};
}

double steal_between(const CpuTicks& a, const CpuTicks& b) noexcept {
  return share(b.stolen - a.stolen, b.all - a.all);
}

double busy_between(const CpuTicks& a, const CpuTicks& b) noexcept {
  return b.all == a.all ? 0 : 1 - share(b.idle - a.idle, b.all - a.all);
}

double load_average() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

}  // namespace slew::cli
