// SPDX-License-Identifier: Apache-2.0
// `slewring doctor`: checks whether this machine is fit for a session, with a remedy for each problem.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/arithmetic_self_test.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/installation.h"
#include "core/json.h"
#include "core/node_names.h"
#include "core/report_table.h"
#include "node/identity.h"
#include "node/open_transport.h"
#include "program/add_session_options.h"
#include "transport/network.h"

namespace slew::cli {
namespace {

enum class Verdict { good, warning, bad };

struct Finding {
  std::string what;
  Verdict verdict = Verdict::good;
  std::string text;  // finding and remedy
};

struct DoctorOptions {
  node::SessionOptions network;
  bool is_json = false;
};

constexpr double kEnoughDisk = 1e9;             // bytes, about an hour of the crane
constexpr long kEnoughReceiveBuffer = 1 << 20;  // bytes of a socket's receive buffer

std::string first_line(const char* path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

Finding check_processor() {
  const char* missing = nullptr;
  if (!processor_fits(missing)) {
    return {"processor", Verdict::bad,
            fmt::format("lacks {}; build with -DSLEWRING_MARCH=x86-64-v2 on all machines of a session", missing)};
  }
  return {"processor", Verdict::good,
          fmt::format("{}, arithmetic {:016x}", counted(std::thread::hardware_concurrency(), "core", "cores"),
                      arithmetic_self_test())};
}

Finding check_programs() {
  std::string missing;
  for (const std::string_view role : kNodeNames) {
    const std::string name = std::string(role) + "_node";
    if (access(sibling_program(name).c_str(), X_OK) != 0) missing += (missing.empty() ? "" : ", ") + name;
  }
  if (missing.empty()) return {"programs", Verdict::good, "all nodes are beside this program"};
  return {"programs", Verdict::bad, missing + " not beside this program; build or install all of them together"};
}

Finding check_pidfd() {
  const long fd = syscall(SYS_pidfd_open, getpid(), 0);
  if (fd < 0) {
    return {"process watch", Verdict::warning,
            "no pidfd in this kernel; a lost node is noticed after session.give_up_after instead of at once; use Linux "
            "5.3 or "
            "newer"};
  }
  close(static_cast<int>(fd));
  return {"process watch", Verdict::good, "a lost node on this machine is noticed at once"};
}

Finding check_network(node::SessionOptions options) {
  // a look at the network sends no data that keys would have to protect
  const bool lacks_keys = options.keys.empty() && transport::leaves_machine(options.interface);
  options.is_insecure_lan = lacks_keys;
  try {
    static_cast<void>(node::open_survey(options));
    const std::string text = fmt::format("interface {}, domain {}", options.interface, options.domain);
    if (!lacks_keys) return {"network", Verdict::good, text};
    return {"network", Verdict::warning, text + "; sessions on it need --keys (slewring keys) or --insecure-lan"};
  } catch (const Failure& failure) {
    return {"network", Verdict::bad, failure.what()};
  }
}

Finding check_receive_buffer() {
  const std::string text = first_line("/proc/sys/net/core/rmem_max");
  const long bytes = text.empty() ? 0 : std::stol(text);
  if (bytes >= kEnoughReceiveBuffer || text.empty()) return {"receive buffer", Verdict::good, text + " bytes at most"};
  return {"receive buffer", Verdict::warning,
          fmt::format("{} bytes at most; a node that is held up may lose messages and request them again; as root: "
                      "sysctl -w net.core.rmem_max={}",
                      bytes, kEnoughReceiveBuffer)};
}

Finding check_real_time() {
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  if (geteuid() == 0 || limit.rlim_cur > 0) return {"real time (--rt)", Verdict::good, "SCHED_FIFO is allowed"};
  return {"real time (--rt)", Verdict::warning,
          "SCHED_FIFO is refused: --rt would run with normal scheduling; set 'rtprio 95' and 'memlock unlimited' for "
          "the user in /etc/security/limits.conf and log in again"};
}

Finding check_governor() {
  const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (governor.empty() || governor == "performance") {
    return {"clock rate", Verdict::good, governor.empty() ? "not managed here" : "governor performance"};
  }
  return {"clock rate", Verdict::warning,
          "governor " + governor + "; deadlines are met better with: cpupower frequency-set -g performance"};
}

Finding check_disk() {
  struct statvfs disk {};
  if (statvfs(".", &disk) != 0) return {"disk", Verdict::warning, "the free space here is unknown"};
  const double free_bytes = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  const std::string text = fmt::format("{:.1f} GB free here", free_bytes * 1e-9);
  if (free_bytes >= kEnoughDisk) return {"disk", Verdict::good, text};
  return {"disk", Verdict::warning, text + "; name another place for the recordings with --out"};
}

ExitCode examine(const DoctorOptions& options) {
  const std::vector<Finding> findings = {
      check_processor(),      check_programs(),  check_pidfd(),    check_network(options.network),
      check_receive_buffer(), check_real_time(), check_governor(), check_disk()};
  bool is_fit = true;
  constexpr std::size_t kNaming = 2;  // verdict, what
  ReportTable table({{.text = "", .json = "verdict"}, {.text = "", .json = "what"}, {.text = "", .json = "text"}},
                    kNaming);
  for (const Finding& finding : findings) {
    const char* verdict = finding.verdict == Verdict::good      ? "ok"
                          : finding.verdict == Verdict::warning ? "warning"
                                                                : "BAD";
    is_fit = is_fit && finding.verdict != Verdict::bad;
    table.add({verdict, finding.what, finding.text});
  }
  if (options.is_json) {
    fmt::print("{}\n", Json({{"fit", is_fit}, {"build", node::build_id()}, {"findings", table.json()}}).dump(2));
  } else {
    print_table(table);
  }
  return is_fit ? ExitCode::ok : ExitCode::resources;
}

}  // namespace

void add_doctor(options::Command& program) {
  options::Command verb = program.command("doctor", "is this machine fit for a session?");
  const auto options = std::make_shared<DoctorOptions>();  // lives as long as the command line's callbacks
  program::add_network_options(verb, options->network);
  verb.flag("--json", options->is_json, "for machines");
  verb.footer("Exit code 7 when a session cannot run here.\n\nExample:\n  slewring doctor --interface eth0");
  verb.action([options] { return examine(*options); });
}

}  // namespace slew::cli
