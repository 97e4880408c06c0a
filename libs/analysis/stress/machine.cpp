// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/machine.h"

#include <sys/utsname.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "analysis/stress/preemption.h"
#include "core/real_time_thread.h"

namespace slew::analysis {
namespace {

double share(std::uint64_t part, std::uint64_t all) noexcept {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

constexpr std::int64_t kLookNs = 100'000'000;

// "0.42 0.31 0.30 3/210 5328": 3 of 210 threads run or are ready to, including the reader of this
std::int64_t runnable_threads() {
  std::ifstream file("/proc/loadavg");
  double of_1 = 0, of_5 = 0, of_15 = 0;
  std::int64_t threads = 0;
  return file >> of_1 >> of_5 >> of_15 >> threads ? threads : 0;
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
  machine.preemption = preemption_model(name.release, name.version);
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

void ActivityWatch::begin() {
  is_under_way_ = true;
  begin_ = cpu_ticks();
}

void ActivityWatch::look(std::int64_t now_ns) {
  if (!is_under_way_) begin();
  if (now_ns - looked_ns_ < kLookNs) return;
  looked_ns_ = now_ns;
  runnable_ += std::max<std::int64_t>(0, runnable_threads() - 1);
  ++looks_;
}

void ActivityWatch::end() {
  if (!is_under_way_) return;
  is_under_way_ = false;
  const CpuTicks end = cpu_ticks();
  sum_.all += end.all - begin_.all;
  sum_.idle += end.idle - begin_.idle;
  sum_.stolen += end.stolen - begin_.stolen;
}

MachineActivity ActivityWatch::result() const noexcept {
  MachineActivity around;
  if (looks_ > 0) around.runnable = static_cast<double>(runnable_) / static_cast<double>(looks_);
  around.steal = share(sum_.stolen, sum_.all);
  if (sum_.all > 0) around.busy = 1 - share(sum_.idle, sum_.all);
  return around;
}

}  // namespace slew::analysis
