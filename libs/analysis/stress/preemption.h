// Who may interrupt the kernel: what decides how long a thread with real-time scheduling waits for others' system
// calls.
#pragma once

#include <filesystem>
#include <string>

namespace slew::analysis {

// The model that this machine's kernel runs with: "none", "voluntary", "full", "lazy", "rt" or, when nothing says so,
// "unknown". release: the kernel's, "6.1.0-18-amd64"; version: "#1 SMP PREEMPT_DYNAMIC ...", as uname() has them.
//
// In this order: PREEMPT_RT in the version; /sys/kernel/debug/sched/preempt, which root alone may read; `preempt=` of
// /proc/cmdline; what it was built with, from /proc/config.gz or /boot/config-<release>.
// root: where these folders are, "/" but for a test.
[[nodiscard]] std::string preemption_model(const std::string& release, const std::string& version,
                                           const std::filesystem::path& root = "/");

}  // namespace slew::analysis
